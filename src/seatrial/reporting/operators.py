"""What a fit means to those who operate the craft, in a sentence: roll, thrusters, motions in waves."""

import math
from collections.abc import Set

from seatrial.core.results import Fit, RollCharacteristics, Seakeeping
from seatrial.core.results.ship_motions import CraftMeasure, IntervalEstimate, ThrusterCraft
from seatrial.core.text.numbers import estimate_text, significant
from seatrial.core.text.words import enumeration
from seatrial.reporting.grades import is_missed
from seatrial.reporting.measures import is_extrapolated
from seatrial.reporting.roll_chapter import share_of_critical

# measures of a craft with thrusters that a sentence names: key -> text before the value, unit after it
_CRAFT_MEASURES = {
    "top_speed": ("makes", "m/s"),
    "yaw_rate_deg_s": ("turns at", "°/s"),
    "stopping_distance_m": ("stops within", "m"),
}


def operators_sentence(fit: Fit) -> str:
    """Return what the ship does in terms of those who operate it.

    Empty for a model of manoeuvring by a rudder, and for one that does not predict its held-out run.
    """
    if is_missed(fit):
        return ""
    if fit.roll is not None:
        return f"{_roll(fit.roll)}{_at_one_speed(fit)}"
    if fit.thruster_craft is not None:
        return _craft(fit.thruster_craft, _guessed_measures(fit))
    return "" if fit.seakeeping is None else _waves(fit.seakeeping)


def _roll(roll: RollCharacteristics) -> str:
    period, ratio = _estimate(roll.natural_period, " s"), _estimate(roll.damping_ratio.scaled(100.0), " %")
    text = f"The natural period at small angles is {period}, the linear damping {ratio} of critical"
    if roll.amplitude:
        text += f", {_equivalent_damping(roll)}"
    height = roll.metacentric_height
    if height is None or height.lower == height.upper:  # unknown, or given
        return f"{text}."
    return f"{text}; GM would be {_estimate(height, ' m')} with {roll.gyradius_source.partition(',')[0]}."


def _at_one_speed(fit: Fit) -> str:
    """Damping grows with speed, so that decays at one speed say nothing of another (Himeno 1981)."""
    is_at_one = any(finding.code == "one-speed" for finding in fit.findings)
    return " This is the damping at the speed of these runs only." if is_at_one else ""


def _equivalent_damping(roll: RollCharacteristics) -> str:
    """What a swing of the largest recorded angle is damped by, and whether it is more than small ones."""
    share, low, high = (
        100.0 * share_of_critical(b[-1], roll.period[-1])
        for b in (roll.damping, roll.damping_lower, roll.damping_upper)
    )
    value = _estimate(IntervalEstimate(share, low, high), " %")
    linear = roll.damping_ratio.scaled(100.0)
    grows, falls = low > linear.upper, high < linear.lower
    kind = "grows with the angle" if grows else "falls with the angle" if falls else "is not shown to change with it"
    return f"the equivalent damping at {math.degrees(roll.amplitude[-1]):.0f}° {value}: damping {kind}"


def _estimate(e: IntervalEstimate, unit: str) -> str:
    """A value with its interval: ``2.55 s (2.54 to 2.56 s)``."""
    text = estimate_text(e.value, 0.5 * (e.upper - e.lower), e.lower, e.upper)
    return f"{text.value}{unit} ({text.lower} to {text.upper}{unit})"


def _guessed_measures(fit: Fit) -> Set[str]:
    """Measures that rest on a thrust that no training run shows: at full command by one order alone, or astern."""
    codes = {finding.code for finding in fit.findings}
    if "single-order" in codes:
        return set(_CRAFT_MEASURES)
    return {"stopping_distance_m"} if "no-thrust-astern" in codes else set()


def _craft(craft: ThrusterCraft, guessed: Set[str]) -> str:
    names = [name for name in _CRAFT_MEASURES if name in craft.measures and name not in guessed]
    clauses = [f"{_CRAFT_MEASURES[name][0]} {_measure(craft.measures[name], _CRAFT_MEASURES[name][1])}"
               for name in names]  # fmt: skip
    is_far = any(is_extrapolated(craft.measures[name]) for name in names)
    place = "At full command, beyond the training runs," if is_far else "At full command"
    return f"{place} it {enumeration(clauses)}." if clauses else ""


def _measure(m: CraftMeasure, unit: str) -> str:
    gap = "" if unit.startswith("°") else " "
    if m.lower is None or m.upper is None:
        return f"{significant(m.value, 2)}{gap}{unit} (interval not determined)"
    return _estimate(IntervalEstimate(m.value, m.lower, m.upper), f"{gap}{unit}")


def _waves(seakeeping: Seakeeping) -> str:
    heave, pitch = significant(seakeeping.heave_significant, 2), significant(seakeeping.pitch_significant, 2)
    return (
        f"In {seakeeping.sea}, at {significant(seakeeping.speed, 3)} m/s and {seakeeping.heading:.0f}° to the waves, "
        f"significant amplitudes are {heave} m of heave and {pitch}° of pitch."
    )
