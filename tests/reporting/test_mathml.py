"""Formulas of every model become well-formed MathML; what cannot be read is printed as it stands."""

import xml.etree.ElementTree as ET

import pytest

from seatrial.core.equations.latex import latex_equations
from seatrial.physics.models import MODELS, model_named
from seatrial.reporting.mathml import inline, pieces


@pytest.mark.parametrize("name", sorted(MODELS))
def test_every_equation_of_every_model_is_read_to_its_end(name: str) -> None:
    for equation in latex_equations(model_named(name)):
        whole = "".join(pieces(equation.latex))
        assert "<code>" not in whole and "\\" not in whole, equation.latex
        ET.fromstring(f"<p>{whole}</p>")


def test_a_long_sum_may_break_at_its_signs() -> None:
    assert len(pieces(r"Y = q \left(a v + b r - c v r\right)")) == 3


def test_a_leading_minus_is_no_place_to_break() -> None:
    assert len(pieces(r"y = - a x")) == 1


def test_primes_stand_at_the_base_and_indices_below() -> None:
    made = inline(r"Y'_{vv}")
    assert made.index("′") < made.index("<mi>v</mi>")
    assert "<msub>" in made


def test_cases_become_a_table() -> None:
    made = inline(r"\begin{cases} a & \text{for}\: x > 0 \\ b & \text{otherwise} \end{cases}")
    assert made.count("<mtr>") == 2 and "otherwise" in made


@pytest.mark.parametrize("latex", [r"\frac{a", r"\left(", r"x^", "{<b>"])
def test_unreadable_latex_is_printed_escaped(latex: str) -> None:
    made = inline(latex)
    assert made.startswith("<code>") and "<b>" not in made
