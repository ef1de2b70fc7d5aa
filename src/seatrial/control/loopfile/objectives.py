"""What is to be made small, by the names a loop file uses, as objectives."""

import math
from collections.abc import Sequence

from seatrial.control.loopfile.plant import LoopPlant
from seatrial.control.loopfile.quantities import positive_value, si_value, symbol_unit
from seatrial.control.loopfile.schema import ObjectiveTable
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import NOTATION, InputError
from seatrial.data.trial.amounts import Amount
from seatrial.physics.loops import LoopSignal, Objective
from seatrial.physics.loops.objective import (
    motion_interruptions,
    motion_sickness,
    motion_sickness_at,
    motion_sickness_dose,
    squared_deviation,
    variance,
    vertical_acceleration,
)

# name -> where the variance is taken, power of the frequency
_VARIANCES = {
    "output": (LoopSignal.OUTPUT, 0),
    "output_rate": (LoopSignal.OUTPUT, 1),
    "output_acceleration": (LoopSignal.OUTPUT, 2),
    "actuator": (LoopSignal.ACTUATOR, 0),
    "actuator_rate": (LoopSignal.ACTUATOR, 1),
}
_DERIVATIVES = ("", "rate of the ", "acceleration of the ")


def objective(table: ObjectiveTable, plant: LoopPlant, constraints: ControllerConstraints, where: str) -> Objective:
    """Return the objective of that name."""
    if table.x is not None:
        return _objective_at_point(table, _in_metres(table.x, f"{where}.x"), where)
    what = _generic_name(table.name, plant, where)
    if what == "motion_interruptions":
        return motion_interruptions(_in_metres(table.height, f"{where}.height"), table.friction)
    if what == "motion_sickness":
        return motion_sickness(_in_metres(table.lever, f"{where}.lever"))
    if what == "actuator_off_target":
        name = f"{_meaning(plant.actuator)} off its target"
        return squared_deviation(
            name, LoopSignal.ACTUATOR, _target_rms(table, plant, constraints, where) ** 2, one_sided=table.one_sided
        )
    seen, power = _VARIANCES[what]
    symbol = plant.output if seen is LoopSignal.OUTPUT else plant.actuator
    return variance(f"variance of the {_DERIVATIVES[power]}{_meaning(symbol)}", _unit(symbol, power), seen, power)


def objective_places(tables: Sequence[ObjectiveTable]) -> tuple[float, ...]:
    """Return the places [m forward of the origin] that objectives name, each once."""
    named = enumerate(tables, start=1)
    return tuple(dict.fromkeys(_in_metres(t.x, f"minimise[{i}].x") for i, t in named if t.x is not None))


def _objective_at_point(table: ObjectiveTable, x: float, where: str) -> Objective:
    match table.name:
        case "vertical_acceleration":
            return vertical_acceleration(x)
        case "motion_sickness":
            return motion_sickness_at(x)
        case _:
            return motion_sickness_dose(x, positive_value(table.duration, "s", f"{where}.duration"))


def _generic_name(name: str, plant: LoopPlant, where: str) -> str:
    """Return the name for any loop: `roll` is the output of a fin stabiliser, `fin` its actuator."""
    on_roll = name.startswith("roll") or name in ("motion_interruptions", "motion_sickness")
    if (on_roll and plant.output != "phi") or (name.startswith("fin") and plant.actuator != "alpha_f"):
        raise InputError(
            f"{where}: '{name}' is a word of roll stabilisers, the loop moves '{plant.output}' by '{plant.actuator}'; "
            "write output or actuator"
        )
    return name.replace("roll", "output", 1) if name.startswith("roll") else name.replace("fin", "actuator", 1)


def _target_rms(table: ObjectiveTable, plant: LoopPlant, constraints: ControllerConstraints, where: str) -> float:
    """Return root mean square aimed at: as given, or that at which the allowed share of amplitudes exceeds the limit.

    exp(-limit^2 / (2 variance)) = share (Rayleigh; Yu et al. 2014, eq. (2), 150.31 deg^2 for 22 deg and 20 %).
    """
    if table.target is not None:
        return positive_value(table.target, symbol_unit(plant.actuator), f"{where}.target")
    if not math.isfinite(constraints.limit):
        raise InputError(f"{where}: there is neither a target nor an [actuator] limit to take it from; add one")
    return constraints.limit / math.sqrt(2.0 * math.log(1.0 / constraints.saturation))


def _in_metres(quantity: Amount | None, where: str) -> float:
    assert quantity is not None
    return si_value(quantity, "m", where)


def _meaning(symbol: str) -> str:
    return NOTATION[symbol].meaning if symbol in NOTATION else symbol


def _unit(symbol: str, power: int) -> str:
    unit = symbol_unit(symbol)
    base = f"{unit}^2" if unit.isalpha() else f"({unit})^2"
    return base + ("" if power == 0 else f"/s^{2 * power}")
