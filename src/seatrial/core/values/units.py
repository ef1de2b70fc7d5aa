"""Units at the boundary: factors to SI. Inside the package everything is SI and radians."""

import math

from seatrial.core.values.errors import InputError, listed

_DEGREE = math.pi / 180.0  # rad
# unit -> (factor to SI, SI unit); exact by definition (SI brochure 2019; 1 kn = 1852 m/h)
_UNITS: dict[str, tuple[float, str]] = {
    "1": (1.0, "1"), "percent": (0.01, "1"), "s": (1.0, "s"), "ms": (1e-3, "s"), "us": (1e-6, "s"), "ns": (1e-9, "s"),
    "min": (60.0, "s"), "h": (3600.0, "s"), "m": (1.0, "m"), "mm": (1e-3, "m"), "cm": (1e-2, "m"), "km": (1e3, "m"),
    "ft": (0.3048, "m"), "nmi": (1852.0, "m"), "rad": (1.0, "rad"), "deg": (_DEGREE, "rad"), "°": (_DEGREE, "rad"),
    "m/s": (1.0, "m/s"), "km/h": (1.0 / 3.6, "m/s"), "kn": (1852.0 / 3600.0, "m/s"), "kt": (1852.0 / 3600.0, "m/s"),
    "rad/s": (1.0, "rad/s"), "deg/s": (_DEGREE, "rad/s"), "°/s": (_DEGREE, "rad/s"),
    "deg/min": (_DEGREE / 60.0, "rad/s"), "°/min": (_DEGREE / 60.0, "rad/s"), "m/s^2": (1.0, "m/s^2"),
    "g": (9.80665, "m/s^2"), "rps": (1.0, "rps"), "rpm": (1.0 / 60.0, "rps"), "N": (1.0, "N"), "kN": (1e3, "N"),
    "MN": (1e6, "N"), "N m": (1.0, "N m"), "kN m": (1e3, "N m"), "kg": (1.0, "kg"), "t": (1e3, "kg"),
    "kg/m^3": (1.0, "kg/m^3"), "kg m^2": (1.0, "kg m^2"), "V": (1.0, "V"), "mV": (1e-3, "V"), "m^2": (1.0, "m^2"),
    "m^3": (1.0, "m^3"),
}  # fmt: skip
# unit -> spellings that people use, in small letters
_SPELLINGS = {
    "deg": "deg degs degree degrees °", "rad": "rad rads radian radians", "kn": "kn kt kts knt knts knot knots",
    "m/s": "m/s mps ms m/sec", "km/h": "km/h kmh kph", "deg/s": "deg/s deg/sec degrees/s dps °/s",
    "deg/min": "deg/min degrees/min °/min", "rad/s": "rad/s", "rpm": "rpm 1/min rev/min", "rps": "rps 1/s rev/s",
    "m": "m metre metres meter meters", "m/s^2": "m/s2", "V": "v volt volts", "us": "us pwm",
    "percent": "% pct percent",
}  # fmt: skip
UNIT_WORDS: dict[str, str] = {word: unit for unit, words in _SPELLINGS.items() for word in words.split()}
"""Spelling, in small letters -> unit."""


def si_unit(unit: str) -> tuple[float, str]:
    """Return factor and SI unit of a unit.

    Raises:
        InputError: the unit is unknown; the nearest known one is named.
    """
    if unit not in _UNITS:
        raise InputError(f"unknown unit '{unit}'{_unit_hint(unit)}")
    return _UNITS[unit]


def is_unit(text: str) -> bool:
    """Return whether a text is a unit or one of its usual spellings."""
    return text in _UNITS or text.lower() in UNIT_WORDS


def _unit_hint(unit: str) -> str:
    """The end of a sentence on an unknown unit: how it is written here, else all units."""
    meant = UNIT_WORDS.get(unit.strip().lower()) or next((u for u in _UNITS if u.lower() == unit.strip().lower()), "")
    return f"; write '{meant}'" if meant else f"; known are {listed(list(_UNITS))}"


def display_unit(unit: str) -> tuple[float, str]:
    """Return the factor from SI and the unit for reading: degrees for angles, otherwise SI."""
    return {"rad": (180.0 / math.pi, "deg"), "rad/s": (180.0 / math.pi, "deg/s")}.get(unit, (1.0, unit))
