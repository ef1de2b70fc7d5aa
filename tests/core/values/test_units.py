"""Units at the boundary, and the one table of channel names."""

import math

import pytest

from seatrial.core.values import NOTATION, Finding, InputError, Severity, Ship, display_unit, quantity, si_unit
from seatrial.core.values.notation import _UNITS, is_unit, units_like


@pytest.mark.parametrize(
    ("unit", "factor", "base"),
    [
        ("deg", math.pi / 180, "rad"),
        ("deg/min", math.pi / 180 / 60, "rad/s"),
        ("kn", 0.514444444444, "m/s"),
        ("rpm", 1 / 60, "rps"),
        ("t", 1000.0, "kg"),
        ("nmi", 1852.0, "m"),
        ("ft", 0.3048, "m"),
    ],
)
def test_factors(unit: str, factor: float, base: str) -> None:
    assert si_unit(unit)[0] == pytest.approx(factor, rel=1e-11)
    assert si_unit(unit)[1] == base


@pytest.mark.parametrize("unit", sorted(_UNITS))
def test_every_si_unit_is_its_own(unit: str) -> None:
    base = si_unit(unit)[1]
    assert si_unit(base) == (1.0, base)


@pytest.mark.parametrize(
    ("text", "expected"), [("deg", True), ("Knots", True), ("N m", True), ("", False), ("psi", False)]
)
def test_a_unit_is_known_by_its_symbol_and_its_usual_spellings(text: str, expected: bool) -> None:
    assert is_unit(text) is expected


def test_display_turns_angles_into_degrees() -> None:
    assert display_unit("rad") == (pytest.approx(57.29577951308232), "deg")
    assert display_unit("m") == (1.0, "m")


def test_an_unknown_unit_is_refused_and_the_nearest_named() -> None:
    with pytest.raises(InputError, match="unknown unit 'knt'; write 'kn'"):
        si_unit("knt")


@pytest.mark.parametrize("symbol", sorted(NOTATION))
def test_every_channel_has_an_si_unit_and_a_known_frame(symbol: str) -> None:
    q = quantity(symbol)
    assert si_unit(q.unit) == (1.0, q.unit)
    assert q.frame in {"body", "earth", "none"}
    assert q.latex and q.standard_name and q.meaning and q.positive


def test_standard_names_are_unique() -> None:
    names = [q.standard_name for q in NOTATION.values()]
    assert len(set(names)) == len(names)


def test_a_finding_in_one_line() -> None:
    assert Finding(Severity.WARNING, "gap", "a gap", "3 s").text == "a gap (3 s)"
    assert Finding(Severity.INFO, "fine", "all is well").text == "all is well"


def test_a_ship_cannot_be_changed() -> None:
    ship = Ship("tanker", {"L": 7.0})
    assert ship.length == 7.0
    with pytest.raises(TypeError):
        ship.particulars["L"] = 8.0  # type: ignore[index]


def test_the_units_of_a_quantity_convert_to_its_own() -> None:
    assert units_like("rad/s") == ["rad/s", "deg/s", "deg/min"]
    assert all(si_unit(unit)[1] == "m/s" for unit in units_like("m/s"))
