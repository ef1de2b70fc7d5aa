"""Names, units and digits of manoeuvring measures."""

import math
import re

from seatrial.core.results import Measure
from seatrial.core.text.words import ordinal

_MEASURES = {
    "rudder_deg": ("rudder angle", "deg"),
    "approach_speed": ("approach speed", "m/s"),
    "advance_L": ("advance", "L"),
    "transfer_L": ("transfer", "L"),
    "tactical_diameter_L": ("tactical diameter", "L"),
    "steady_diameter_L": ("steady turning diameter", "L"),
    "steady_yaw_rate_deg_s": ("steady yaw rate", "deg/s"),
    "steady_drift_deg": ("steady drift angle", "deg"),
    "speed_loss": ("speed lost in the turn, share of approach speed", ""),
    "time_90_s": ("time to 90° change of heading", "s"),
    "initial_turning_time_s": ("initial turning time", "s"),
    "initial_turning_L": ("initial turning, distance", "L"),
    "period_s": ("period", "s"),
}
_UNIT_ENDINGS = (("_deg_s", "deg/s"), ("_deg", "deg"), ("_L", "L"), ("_s", "s"))
# decimals by unit, and how many more an interval may demand
_DECIMALS = {"deg": 1, "L": 2, "s": 1, "m/s": 3, "deg/s": 2}
EXTRA_DECIMALS = 2


def measure_label(name: str) -> tuple[str, str]:
    """Return name and unit of a manoeuvring measure: ``overshoot_1_deg`` -> 1st overshoot, deg."""
    if name in _MEASURES:
        return _MEASURES[name]
    overshoot = re.fullmatch(r"overshoot_(\d+)_deg", name)
    if overshoot:
        return f"{ordinal(int(overshoot[1]))} overshoot", "deg"
    for ending, unit in _UNIT_ENDINGS:
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), unit
    return name.replace("_", " "), ""


def measure_decimals(unit: str, m: Measure) -> int:
    """Return the decimals of a measure in that unit, enough for two digits of its interval's width."""
    usual = _DECIMALS.get(unit, 3)
    width = m.upper - m.lower if m.upper is not None and m.lower is not None else 0.0
    if not 0.0 < width < math.inf:
        return usual
    return min(usual + EXTRA_DECIMALS, max(usual, 1 - math.floor(math.log10(width))))


def is_inside(m: Measure) -> bool | None:
    """Return whether the measured value lies in the interval; None where one of them is not known."""
    if m.measured is None or m.lower is None or m.upper is None:
        return None
    return m.lower <= m.measured <= m.upper
