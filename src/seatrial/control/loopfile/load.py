"""A loop file into a `Task`: plant, controller, what disturbs it, what is to be small and what must be kept."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from pydantic import ValidationError

from seatrial.control.loopfile.aims import objective
from seatrial.control.loopfile.amounts import amount, angle, positive, rate, unit_of
from seatrial.control.loopfile.diagram import loop_asked
from seatrial.control.loopfile.plant import Plant, hull_of, plant_asked
from seatrial.control.loopfile.schema import AimTable, DemandTable, LoopFile, SimulationTable
from seatrial.control.loopfile.structure import richer
from seatrial.control.loopfile.weather import met_by, plan_of, refuse_calm
from seatrial.control.task import Demand, Task, Trials, refuse_unstable
from seatrial.core.equations import Model
from seatrial.core.results.tuning import Restriction
from seatrial.core.values import InputError, nearest
from seatrial.data.trial.complaints import complaint
from seatrial.physics.loops import Objective, TransferLoop

_CHANGES = 30.0
_MOST_STEPS = 1e7
_LONGEST = 1e4


def parse_loop(path: Path) -> LoopFile:
    """The file's tables, checked key by key.

    Raises:
        InputError: no such file, no TOML, an unknown or missing key, a value of the wrong kind.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"loop file '{path}' cannot be read ({error.strerror}); check the path") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"loop file '{path}' is no valid TOML: {error}") from None
    try:
        return LoopFile.model_validate(table)
    except ValidationError as error:
        raise complaint(error, LoopFile, str(path)) from None


def task_of(path: Path, own_model: Model | None = None, model_file: Path | None = None) -> Task:
    """The tuning that a loop file asks for.

    Args:
        own_model: equations of a model file that are not built in.
        model_file: takes the place of the one that `[plant] model` names.

    Raises:
        InputError: one sentence naming file and key.
    """
    file = parse_loop(path)
    try:
        return _task(file, plant_asked(file.plant, path.resolve().parent, own_model, model_file))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _task(file: LoopFile, plant: Plant) -> Task:
    loop = loop_asked(file.controller, file.actuator.servo, plant, file.name or f"{plant.actuator} on {plant.output}")
    demand = None if file.demand is None else _demand(file.demand, plant)
    if demand is None:
        refuse_unstable(loop)
    restriction = _restriction(file, plant)
    met = met_by(file, plant, hull_of(file.hull, plant.ship))
    plan = None if file.schedule is None else plan_of(file.schedule)
    refuse_calm(met, loop, plan)
    objectives = tuple(objective(aim, plant, restriction, f"minimise[{i}]") for i, aim in enumerate(file.minimise, 1))
    _refuse_twice(file.minimise, objectives)
    return Task(
        question=file.question,
        name=loop.name,
        plant=plant.said,
        loop=loop,
        met=met,
        objectives=objectives,
        restriction=restriction,
        U=plant.U,
        effectiveness=plant.effectiveness,
        rivals=_rivals(file.given, loop),
        richer=tuple(richer(loop, table, f"richer[{i}]") for i, table in enumerate(file.richer, start=1)),
        plan=plan,
        trials=_trials(file.simulation, len(file.seas), demand),
        vessel=plant.vessel,
        demand=demand,
    )


def _refuse_twice(aims: Sequence[AimTable], objectives: Sequence[Objective]) -> None:
    """`roll` and `output` are one thing, an off-target with another target is not."""
    keys = [(made.name, aim.model_dump(exclude={"what"})) for aim, made in zip(aims, objectives, strict=True)]
    for i, key in enumerate(keys, start=1):
        if key in keys[: i - 1]:
            raise InputError(f"minimise[{i}]: the {key[0]} is asked for twice; name it once")


def _restriction(file: LoopFile, plant: Plant) -> Restriction:
    """Limits in SI; angles of half a turn were meant as degrees."""
    table, unit = file.actuator, unit_of(plant.actuator)

    def largest(key: str) -> float:
        given = getattr(table, key)
        if given is None:
            return math.inf
        where = f"actuator.{key}"
        return angle(given, where) if unit == "rad" else positive(given, unit, where)

    return Restriction(
        peak=file.limits.peak,
        saturation=file.limits.saturation,
        rate_saturation=file.limits.rate_saturation,
        limit=largest("limit"),
        rate=math.inf if table.rate is None else rate(table.rate, unit, "actuator.rate"),
        stall=largest("stall"),
    )


def _rivals(given: Mapping[str, Mapping[str, float]], loop: TransferLoop) -> dict[str, Mapping[str, float]]:
    names = loop.gains.names
    for rival, gains in given.items():
        for name in gains:
            if name not in names:
                raise InputError(f"given.{rival}: the controller has no gain '{name}'{nearest(name, [*names])}")
        for name in names:
            if name not in gains:
                raise InputError(f"given.{rival}: gain {name} is missing; add it")
    return dict(given)


def _trials(table: SimulationTable | None, seas: int, demand: Demand | None) -> Trials | None:
    """The house's own for a stabiliser in a sea; none where a demand is followed or no seeds are wanted."""
    if table is None:
        return Trials() if demand is None and seas else None
    if not table.seeds:
        return None
    if not seas:
        raise InputError("simulation: there is no block [[seas]] to simulate; leave the table out, or add one")
    if table.seeds == 1:
        raise InputError("simulation.seeds = 1 gives no interval; give two or more, or 0 for no simulation")
    duration = positive(table.duration, "s", "simulation.duration")
    step = positive(table.step, "s", "simulation.step")
    if step * 100.0 > duration:
        raise InputError(f"simulation: steps of {step:g} s are no simulation of {duration:g} s; make them shorter")
    if table.seeds * duration / step > _MOST_STEPS:
        raise InputError(
            f"simulation: {table.seeds} seas of {duration:g} s in steps of {step:g} s are more than {_MOST_STEPS:.0e} "
            "steps; take a shorter duration, longer steps or fewer seeds"
        )
    return Trials(table.seeds, duration, step)


def _demand(table: DemandTable, plant: Plant) -> Demand:
    """Without a time constant the ship's length over her speed; without a duration thirty time constants."""
    if plant.disturbed_by == "alpha_w":
        raise InputError("demand: a roll stabiliser follows no demand; leave the table out")
    unit = unit_of(plant.output)
    change = (
        angle(table.change, "demand.change", 20.0) if unit == "rad" else amount(table.change, unit, "demand.change")
    )
    if not change:
        raise InputError("demand.change = 0 asks for nothing; give a change")
    if table.time_constant is not None:
        T = positive(table.time_constant, "s", "demand.time_constant")
    elif plant.ship is not None and "L" in plant.ship.particulars:
        T = plant.ship.length / plant.U
    else:
        raise InputError("key 'demand.time_constant' is missing, and the ship's length is not known; add it in s")
    duration = _CHANGES * T if table.duration is None else positive(table.duration, "s", "demand.duration")
    if not T <= duration <= _LONGEST * T:
        raise InputError(
            f"demand.duration = {duration:g} s is no time to follow a demand of time constant {T:.4g} s; give one to "
            f"{_LONGEST:g} time constants"
        )
    return Demand(change, table.overshoot, T, duration)
