"""What is to be made small, by the names a loop file uses, as objectives."""

import math

from seatrial.control.loopfile.amounts import amount, positive, unit_of
from seatrial.control.loopfile.plant import Plant
from seatrial.control.loopfile.schema import AimTable
from seatrial.core.results.tuning import Restriction
from seatrial.core.values import NOTATION, InputError
from seatrial.data.trial.schema import Amount
from seatrial.physics.loops import Objective, Seen
from seatrial.physics.loops.objective import motion_interruptions, motion_sickness, off_target, variance

# name -> where the variance is taken, power of the frequency
_VARIANCES = {
    "output": (Seen.OUTPUT, 0),
    "output_rate": (Seen.OUTPUT, 1),
    "output_acceleration": (Seen.OUTPUT, 2),
    "actuator": (Seen.ACTUATOR, 0),
    "actuator_rate": (Seen.ACTUATOR, 1),
}
_OF = ("", "rate of the ", "acceleration of the ")


def objective(table: AimTable, plant: Plant, restriction: Restriction, where: str) -> Objective:
    """The objective of that name.

    Raises:
        InputError: words of a fin stabiliser for another loop, or no target and no limit to take it from.
    """
    what = _generic(table.what, plant, where)
    if what == "motion_interruptions":
        return motion_interruptions(_metres(table.height, f"{where}.height"), table.friction)
    if what == "motion_sickness":
        return motion_sickness(_metres(table.lever, f"{where}.lever"))
    if what == "actuator_off_target":
        name = f"{_meaning(plant.actuator)} off its target"
        return off_target(
            name, Seen.ACTUATOR, _target(table, plant, restriction, where) ** 2, one_sided=table.one_sided
        )
    seen, power = _VARIANCES[what]
    symbol = plant.output if seen is Seen.OUTPUT else plant.actuator
    return variance(f"variance of the {_OF[power]}{_meaning(symbol)}", _unit(symbol, power), seen, power)


def _generic(what: str, plant: Plant, where: str) -> str:
    """`roll` is the output of a fin stabiliser, `fin` its actuator."""
    on_roll = what.startswith(("roll", "motion"))
    if (on_roll and plant.output != "phi") or (what.startswith("fin") and plant.actuator != "alpha_f"):
        raise InputError(
            f"{where}: '{what}' is a word of roll stabilisers, the loop moves '{plant.output}' by '{plant.actuator}'; "
            "write output or actuator"
        )
    return what.replace("roll", "output", 1) if what.startswith("roll") else what.replace("fin", "actuator", 1)


def _target(table: AimTable, plant: Plant, restriction: Restriction, where: str) -> float:
    """Root mean square aimed at: as given, or that at which the allowed share of amplitudes exceeds the limit.

    exp(-limit^2 / (2 variance)) = share (Rayleigh; Yu et al. 2014, eq. (2), 150.31 deg^2 for 22 deg and 20 %).
    """
    if table.target is not None:
        return positive(table.target, unit_of(plant.actuator), f"{where}.target")
    if not math.isfinite(restriction.limit):
        raise InputError(f"{where}: there is neither a target nor an [actuator] limit to take it from; add one")
    return restriction.limit / math.sqrt(2.0 * math.log(1.0 / restriction.saturation))


def _metres(given: Amount | None, where: str) -> float:
    assert given is not None
    return amount(given, "m", where)


def _meaning(symbol: str) -> str:
    return NOTATION[symbol].meaning if symbol in NOTATION else symbol


def _unit(symbol: str, power: int) -> str:
    unit = unit_of(symbol)
    base = f"{unit}^2" if unit.isalpha() else f"({unit})^2"
    return base + ("" if power == 0 else f"/s^{2 * power}")
