"""One expression in every language of the printers."""

import pytest
import sympy as sp

from seatrial.core.equations import Model
from seatrial.core.equations.generate import (
    Assignment,
    CasadiDialect,
    CDialect,
    CodeBlock,
    Dialect,
    MatlabDialect,
    function_assignments,
    live_assignments,
    tangent_assignments,
)
from seatrial.core.equations.latex import rates_function
from seatrial.physics.models.published import kvlcc2

v, r = sp.symbols("v r", real=True)
EXPRESSION = sp.Piecewise((sp.Abs(v) * v**2, r > 0), (sp.sqrt(v) + sp.sign(r) + sp.pi + v**r, True))


@pytest.mark.parametrize(
    ("dialect", "pieces"),
    [
        (Dialect(), ("abs(v_)", "math.sqrt(v_)", "math.copysign(1.0, r_)", " if (r_ > 0", "(v_)**(r_)")),
        (CDialect(), ("fabs(v_)", "sqrt(v_)", "copysign(1.0, r_)", "(r_ > 0.0 ? ", "pow(v_, r_)", "3.14159")),
        (MatlabDialect(), ("abs(v_)", "sign_of(r_)", "choose(r_ > 0", "(v_)^(r_)")),
        (CasadiDialect(), ("ca.fabs(v_)", "ca.sqrt(v_)", "ca.if_else((r_ > 0", "(v_)**(r_)", "3.14159")),
    ],
    ids=lambda d: type(d).__name__ if isinstance(d, Dialect) else "",
)
def test_each_language_has_its_words(dialect: Dialect, pieces: tuple[str, ...]) -> None:
    text = CodeBlock(dialect).expression(EXPRESSION)
    assert [piece for piece in pieces if piece not in text] == []


@pytest.mark.parametrize("dialect", [CDialect(), MatlabDialect(), CasadiDialect()])
def test_every_local_name_is_used(model: Model, dialect: Dialect) -> None:
    rates = model.equations.rates
    for body in (
        function_assignments(model.equations, rates, dialect),
        tangent_assignments(model.equations, rates, dialect)[0],
    ):
        kept = live_assignments(body)
        for k, assignment in enumerate(kept):
            if assignment.target.isidentifier():
                assert any(assignment.target in later.text for later in kept[k + 1 :])


def test_what_nothing_rests_on_is_left_out() -> None:
    lines = [Assignment("a", "1.0"), Assignment("b", "a"), Assignment("c", "a"), Assignment("out[0]", "c")]
    assert [line.target for line in live_assignments(lines)] == ["a", "c", "out[0]"]


def test_a_modulus_and_a_condition_are_those_of_the_equations() -> None:
    text = rates_function(kvlcc2())
    assert "Math.abs(" in text and "?" in text
    assert text.startswith("(x, u, p, out) => {") and "out[5] = " in text
