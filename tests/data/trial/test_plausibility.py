"""Particulars of one hull pass, and those of two hulls are named with the edit."""

import pytest

from seatrial.core.values import Ship
from seatrial.data.trial.plausibility import hull_value_findings

MODEL = {"L": 3.2, "B": 0.46, "d": 0.17, "m": 118.0, "I5": 118.0 * 0.8**2}


def test_the_values_of_one_hull_are_no_finding() -> None:
    assert hull_value_findings(Ship("model", MODEL)) == ()


def test_an_inertia_of_another_hull_is_named_with_the_usual_one() -> None:
    (finding,) = hull_value_findings(Ship("model", {**MODEL, "I5": 129.4}))
    assert "0.33 L" in finding.message and finding.advice.startswith("I5 = 75.52 under [ship]")


def test_a_mass_beyond_the_box_of_water_is_named() -> None:
    (finding,) = hull_value_findings(Ship("model", {"L": 3.2, "B": 0.46, "d": 0.17, "m": 300.0}))
    assert "box of L, B and d" in finding.message


@pytest.mark.parametrize("missing", ["m", "L"])
def test_without_mass_or_length_nothing_is_judged(missing: str) -> None:
    values = {name: value for name, value in MODEL.items() if name != missing}
    assert hull_value_findings(Ship("model", values)) == ()
