"""What a coefficient can be used for follows from its interval, its prior and what it is tied to."""

import math
from dataclasses import replace

import pytest

from seatrial.core.results import Coefficient, Consequence, Fit, Identifiability, Symmetry
from seatrial.core.results.fit import Collinearity, Sensitivity
from seatrial.reporting.coefficients_chapter import Partner, Use, coefficient_uses, meaning_sentences

PLAIN = Coefficient("a", "1", 2.0, 0.05, 1.9, 2.1, False)


def content(inflation: float = 1.5, **parts: tuple) -> Identifiability:
    collinear = (Collinearity("a", inflation, "b", -0.9),)
    return Identifiability(**({"structural": (), "directions": ()} | parts), effective_parameters=1.0, condition=1.0,
                           collinearity=collinear, sensitivities=(Sensitivity("a", 3.2, {}),))  # fmt: skip


@pytest.mark.parametrize(
    ("coefficient", "inflation", "use"),
    [
        (PLAIN, 9.9, Use.BY_ITSELF),
        (replace(PLAIN, standard_error=0.19), 9.9, Use.BY_ITSELF),
        (replace(PLAIN, standard_error=0.21), 9.9, Use.VAGUELY),
        (PLAIN, math.inf, Use.BY_ITSELF),
        (replace(PLAIN, standard_error=0.21), 10.0, Use.AS_A_SET),
        (replace(PLAIN, prior_mean=2.0, prior_standard_deviation=0.05), 1.5, Use.FROM_PRIOR),
        (replace(PLAIN, prior_mean=2.0, prior_standard_deviation=0.5), 1.5, Use.BY_ITSELF),
        (replace(PLAIN, lower=-0.1, upper=4.1), 50.0, Use.SIGN_OPEN),
        (replace(PLAIN, lower=None, upper=None, standard_error=None), 1.5, Use.NO_INTERVAL),
    ],
)
def test_the_use_is_the_least_that_anything_allows(coefficient: Coefficient, inflation: float, use: Use) -> None:
    (row,) = coefficient_uses([coefficient, replace(PLAIN, name="held", fixed=True)], content(inflation))
    assert row.use is use and row.name == "a"


def test_a_strong_correlation_of_the_intervals_ties_a_coefficient_whatever_its_inflation() -> None:
    wide = replace(PLAIN, standard_error=0.21)
    (row,) = coefficient_uses([wide], content(1.5), {"a": Partner("c", -0.97)})
    assert row.use is Use.AS_A_SET and row.partner == "c −0.97"


def test_a_row_shows_half_width_effect_and_partner() -> None:
    (row,) = coefficient_uses([PLAIN], content(1234.0))
    assert (row.half_width, row.effect, row.variance_inflation, row.partner) == (
        "± 5.0",
        "3.2",
        "1\u202f200",
        "b −0.90",
    )
    (bare,) = coefficient_uses([replace(PLAIN, name="c", estimate=0.0)], content())
    assert (bare.half_width, bare.effect, bare.variance_inflation, bare.partner) == ("–", "–", "–", "")


def test_what_can_be_used_by_itself_comes_first_and_the_widest_last() -> None:
    vague, wide = replace(PLAIN, name="v", lower=-9.0, upper=9.0), replace(PLAIN, name="w", lower=1.0, upper=3.0)
    rows = coefficient_uses([vague, wide, PLAIN], Identifiability((), (), 1.0, 1.0))
    assert [row.name for row in rows] == ["a", "w", "v"]


def test_the_lines_name_what_is_used_how_and_the_assumption_that_matters_most(fit: Fit) -> None:
    vague = replace(PLAIN, name="v", lower=-9.0, upper=9.0)
    held = replace(PLAIN, name="m", fixed=True, standard_error=None, lower=None, upper=None)
    slight, strong = (
        Consequence(name, 0.1, {"a": move, "v": 0.5 * move}, 1.0, "") for name, move in (("m", 0.01), ("k", -0.2))
    )
    known = content(structural=(Symmetry(("m", "a"), "", {}),))
    known = replace(known, consequences=(slight, strong))
    one = replace(fit, coefficients=(PLAIN, vague, held), identifiability=known)
    sentences = meaning_sentences(one, known, coefficient_uses(one.coefficients, known))
    assert sentences[1:] == (
        "a is known, with standard errors below 10 %. v has an open sign.",
        "No manoeuvre identifies m apart from the others. Changing k by +10 % would change a by −20 %.",
    )
    assert len(meaning_sentences(fit, Identifiability((), (), 1.0, 1.0), ())) == 1
