"""A loop file into a `TuningTask`: plant, controller, what disturbs it, what is to be small and what must be kept."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from pydantic import ValidationError

from seatrial.control.loopfile.disturbances import loop_disturbances, point_motions, refuse_calm
from seatrial.control.loopfile.loop import extended_structure, loop_from_tables, objective, objective_places
from seatrial.control.loopfile.plant import (
    LoopPlant,
    hull_factor,
    plant_at_speed,
    plant_from_table,
    refuse_reversed_plant,
    refuse_reversed_servo,
    refuse_wild_motion,
)
from seatrial.control.loopfile.schema import (
    ActuatorTable,
    BlockTable,
    DemandTable,
    LoopFile,
    ObjectiveTable,
    PlantTable,
    SimulationTable,
    StationTable,
    TrackTable,
    angle_value,
    positive_value,
    rate_value,
    si_value,
    symbol_unit,
)
from seatrial.control.station.tune_station import refuse_impossible_station
from seatrial.control.task import (
    Demand,
    Seaway,
    SimulationSettings,
    SlowDisturbance,
    StationDemand,
    TrackDemand,
    TuningTask,
    refuse_unstable,
)
from seatrial.control.track.tune_track import refuse_impossible_track
from seatrial.core.equations import Model
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import InputError, spelling_hint
from seatrial.core.values.files import parse_toml, read_table_text, refuse_absurd_numbers
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial.amounts import Amount, schema_error
from seatrial.physics.loops import ActuatorDrive, Block, LiftingSurface, Objective, Sampling, TransferLoop
from seatrial.physics.loops.discrete import default_sample_time, ringing_blocks, round_sample_time
from seatrial.physics.loops.objective import hourly_energy
from seatrial.physics.models.thruster_layout import layout_of
from seatrial.physics.simulate.closed_loop import simulation_step

_TIME_CONSTANTS = 30.0  # duration of a demand where none is given, in its time constants; chosen
_DELAY_OVER_DEAD_TIME = 1.0  # least delay margin beyond the declared dead time, over it; chosen
_DEAD_TIME_SAMPLES = 25  # samples of the dead time at most where no sample time is declared; chosen
_ACCEPTANCE_LENGTHS = 2.0  # of the circle of acceptance, in lengths of the ship: Fossen 2011, section 10.3
_SHARPEST_CORNER = math.radians(120.0)  # of a track; chosen
_LARGEST_SHARE = 0.9  # of a spread that a log leaves: an actuator of no rate is none; chosen
_MOST_STEPS = 1e7  # steps over all seeds; guards against a wrong unit


def parse_loop(path: Path) -> LoopFile:
    """Return the file's tables, checked key by key."""
    try:
        table = parse_toml(read_table_text(path))
    except OSError as error:
        raise InputError(f"loop file '{path}' cannot be read ({error.strerror}); check the path") from None
    except ValueError as error:
        raise InputError(f"loop file '{path}' is no valid TOML: {error}") from None
    refuse_absurd_numbers(table, str(path))
    try:
        return LoopFile.model_validate(table)
    except ValidationError as error:
        raise schema_error(error, LoopFile, str(path)) from None


def tuning_task(path: Path, own_model: Model | None = None, model_file: Path | ModelFile | None = None) -> TuningTask:
    """Return the tuning that a loop file asks for.

    Args:
        own_model: equations of a model file that are not built in.
        model_file: takes the place of the one that `[plant] model` names: its path, or what it holds.
    """
    file = parse_loop(path)
    try:
        home = path.resolve().parent
        plant = plant_from_table(file.plant, home, own_model, model_file)
        file, plant = _with_logged_actuator(file, plant, home)
        task = _task_from_tables(file, plant, home)
        if task.schedule_grid is None or task.demand is None:
            return task

        def at_speed(U: float) -> TuningTask:
            alone = file.model_copy(update={"schedule": None, "track": None, "station": None})
            there = plant_at_speed(file.plant, plant, U, home, own_model, model_file)
            return _task_from_tables(alone, there, home)

        for U in task.schedule_grid.speeds:
            at_speed(U)
        return replace(task, at_speed=lru_cache(at_speed))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _with_logged_actuator(file: LoopFile, plant: LoopPlant, home: Path) -> tuple[LoopFile, LoopPlant]:
    """Return the tables with rate, dead time and lag of the actuator's log where they stand in none, and what it shows.

    The lag is the servo of controllers that bring none.
    """
    table = file.actuator
    if not table.log:
        return file, plant
    from seatrial.control.actuator_log import actuator_response, logged_records

    path = home / table.log
    try:
        response = actuator_response(logged_records(path), plant.actuator)
    except InputError as error:
        raise InputError(f"actuator.log: {error}") from None
    fitted: dict[str, object] = {}
    shares: dict[str, float] = {}
    if table.rate is None and math.isfinite(response.rate):
        fitted["rate"] = Amount(value=response.rate)
        shares["rate"] = min(response.rate_error / response.rate, _LARGEST_SHARE)
    if table.dead_time is None and response.dead_time > 0.0:
        fitted["dead_time"] = response.dead_time
        shares["dead_time"] = min(response.dead_time_error / response.dead_time, _LARGEST_SHARE)
    if not table.servo and file.controller.kind != "yu2014":
        fitted["servo"] = (BlockTable(lag=response.lag, name="lag of the actuator", source=table.log),)
    uncertainty = replace(file.uncertainty, actuator=replace(file.uncertainty.actuator, **shares))
    if uncertainty.dead_time is None and "dead_time" in fitted:
        uncertainty = replace(uncertainty, dead_time=response.dead_time + response.dead_time_error)
    described = f"{plant.description}; {response.sentence(plant.actuator)}"
    return (
        file.model_copy(update={"actuator": table.model_copy(update=fitted), "uncertainty": uncertainty}),
        replace(plant, description=described),
    )


def _task_from_tables(file: LoopFile, plant: LoopPlant, home: Path) -> TuningTask:
    loop = loop_from_tables(
        file.controller, file.actuator.servo, plant, file.name or f"{plant.actuator} on {plant.output}",
        _dead_time(file.actuator),
    )  # fmt: skip
    places = objective_places(file.minimise)
    loop = replace(loop, points=point_motions(plant, places), sampling=_sampling(file, plant, loop))
    refuse_reversed_plant(plant, _plant_key(file.plant))
    refuse_reversed_servo(loop.servo)
    demand = None if file.demand is None else _demand(file.demand, plant)
    if demand is None and file.seas and plant.output == "psi":
        raise InputError("key 'demand' is missing: an autopilot also changes course; add [demand] with its change")
    if demand is None:
        refuse_unstable(loop)
    restriction = _constraints(file, plant)
    met = loop_disturbances(file, plant, home, places)
    refuse_calm(met, loop, file.schedule)
    if demand is None:
        refuse_wild_motion(met, loop, plant)
    inertia, surface = file.actuator.inertia, _surface(file.actuator)
    drive = None if inertia is None else ActuatorDrive(inertia, file.actuator.efficiency)
    objectives = tuple(
        _energy_objective(drive, surface, met, where)
        if aim.name == "energy"
        else objective(aim, plant, restriction, where)
        for where, aim in ((f"minimise[{i}]", aim) for i, aim in enumerate(file.minimise, 1))
    )
    _refuse_duplicates(file.minimise, objectives)
    task = TuningTask(
        question=file.question,
        name=loop.name,
        plant=plant.description,
        loop=loop,
        disturbances=met,
        objectives=objectives,
        constraints=restriction,
        U=plant.U,
        effectiveness=plant.effectiveness,
        baselines=_baselines(file.baselines, loop),
        extended_structures=tuple(
            extended_structure(loop, table, f"extended_structures[{i}]", _wave_frequency(met, loop))
            for i, table in enumerate(file.extended_structures, start=1)
        ),
        schedule_grid=file.schedule,
        simulation=_simulation_settings(file.simulation, len(file.seas), demand, loop.required_sampling),
        trimmed_ship=plant.trimmed_ship,
        demand=demand,
        genetic=file.genetic,
        drive=drive,
        surface=surface,
        uncertainty=file.uncertainty,
        track=None if file.track is None else _track(file.track, plant, demand),
        station=None if file.station is None else _station(file.station, file, plant),
        sample_s=file.controller.sample_s,
    )
    if task.track is not None:
        refuse_impossible_track(task, task.track)
    if task.station is not None:
        refuse_impossible_station(task.station)
    return task


def _wave_frequency(disturbances: Sequence[Seaway | SlowDisturbance], loop: TransferLoop) -> float | None:
    """Return the mean frequency [rad/s] at which the first sea acts that moves a craft by a path of its own; else None.

    Of the action, not of the motion: waves that keep up with the ship move its heading as far as they like.
    """
    sea = next((one for one in disturbances if isinstance(one, Seaway) and one.path and not one.is_output), None)
    return None if sea is None else sea.exposure(loop).mean_frequency(Block("action"))


def _plant_key(table: PlantTable) -> str:
    """Return the key that says what the plant is."""
    return next(f"plant.{key}" for key in ("roll", "response", "model") if getattr(table, key) is not None)


def _refuse_duplicates(tables: Sequence[ObjectiveTable], objectives: Sequence[Objective]) -> None:
    """Refuse one thing named twice: `roll` and `output` are one, an off-target with another target is not."""
    keys = [(made.name, aim.model_dump(exclude={"name"})) for aim, made in zip(tables, objectives, strict=True)]
    for i, key in enumerate(keys, start=1):
        if key in keys[: i - 1]:
            raise InputError(f"minimise[{i}]: the {key[0]} is named twice; name it once")


def _constraints(file: LoopFile, plant: LoopPlant) -> ControllerConstraints:
    """Return limits in SI; angles of half a turn were meant as degrees."""
    table, unit = file.actuator, symbol_unit(plant.actuator)

    def largest(key: str) -> float:
        given = getattr(table, key)
        if given is None:
            return math.inf
        where = f"actuator.{key}"
        return angle_value(given, where) if unit == "rad" else positive_value(given, unit, where)

    return ControllerConstraints(
        Ms=file.limits.Ms,
        saturation=file.limits.saturation,
        rate_saturation=file.limits.rate_saturation,
        limit=largest("limit"),
        rate=math.inf if table.rate is None else rate_value(table.rate, unit, "actuator.rate"),
        stall=largest("stall"),
        delay=_DELAY_OVER_DEAD_TIME * _dead_time(table),
    )


def _dead_time(table: ActuatorTable) -> float:
    """Return the declared dead time [s]; zero without one."""
    return 0.0 if table.dead_time is None else table.dead_time


def _surface(table: ActuatorTable) -> LiftingSurface | None:
    """Return what the actuator turns in the water; None where no area is declared."""
    if (table.area is None) is not (table.aspect_ratio is None):
        raise InputError("actuator: the drag of fins or rudders needs both area and aspect_ratio; add the other")
    if table.area is None or table.aspect_ratio is None:
        return None
    return LiftingSurface(table.area, table.aspect_ratio)


def _energy_objective(
    drive: ActuatorDrive | None,
    surface: LiftingSurface | None,
    disturbances: Sequence[Seaway | SlowDisturbance],
    where: str,
) -> Objective:
    """Return the energy of the actuator at the one speed of all disturbances."""
    if drive is None and surface is None:
        raise InputError(f"{where}: 'energy' needs [actuator] inertia, or area and aspect_ratio; add them")
    speeds = sorted({disturbance.U for disturbance in disturbances})
    if surface is not None and len(speeds) > 1:
        raise InputError(
            f"{where}: the drag of 'energy' belongs to one speed, and the disturbances have {len(speeds)}; give all "
            "the same speed"
        )
    return hourly_energy(drive, surface, speeds[0])


def _baselines(baselines: Mapping[str, Mapping[str, float]], loop: TransferLoop) -> dict[str, Mapping[str, float]]:
    names = loop.gains.names
    for rival, gains in baselines.items():
        if unknown := [name for name in gains if name not in names]:
            hint = spelling_hint(unknown[0], [*names])
            raise InputError(f"baselines.{rival}: the controller has no gain '{unknown[0]}'{hint}")
        if missing := [name for name in names if name not in gains]:
            raise InputError(f"baselines.{rival}: gain {missing[0]} is missing; add it")
    return dict(baselines)


def _sampling(file: LoopFile, plant: LoopPlant, loop: TransferLoop) -> Sampling:
    """Return how the controller samples (by default as the loop allows), the actuator's dead time, sensor errors."""
    table, dead_time, unit = file.controller, _dead_time(file.actuator), symbol_unit(plant.output)
    errors = {
        key: 0.0 if value is None else positive_value(value, unit, f"sensors.{key}")
        for key, value in (("noise", file.sensors.noise), ("resolution", file.sensors.resolution))
    }
    if table.sample_s is None:
        shortest = round_sample_time(dead_time / _DEAD_TIME_SAMPLES)
        return Sampling(max(default_sample_time(loop), shortest), dead_time, **errors)
    made = Sampling(table.sample_s, dead_time, **errors)
    if table.derivative_filter is not None and "derivative" in ringing_blocks(loop, made.sample_s):
        raise InputError(
            f"controller.derivative_filter: it rings at samples of {made.sample_s:g} s; give {0.5 * made.sample_s:g} s "
            "or more, or leave it out"
        )
    return made


def _simulation_settings(
    table: SimulationTable | None, seas: int, demand: Demand | None, sampling: Sampling
) -> SimulationSettings | None:
    """Return the default for a stabiliser in a sea; None where a demand is followed or no seeds are given.

    Steps are as long as asked at most, and divide the controller's sample time.
    """
    if table is None:
        table = SimulationTable() if demand is None and seas else SimulationTable(seeds=0)
    if not table.seeds:
        return None
    if not seas:
        raise InputError("simulation: there is no block [[seas]] to simulate; leave the table out, or add one")
    if table.seeds == 1:
        raise InputError("simulation.seeds = 1 gives no interval; give two or more, or 0 for no simulation")
    duration, step = table.duration, table.step
    if step * 100.0 > duration:
        raise InputError(f"simulation: steps of {step:g} s are no simulation of {duration:g} s; make them shorter")
    if table.seeds * duration / step > _MOST_STEPS:
        raise InputError(
            f"simulation: {table.seeds} seas of {duration:g} s in steps of {step:g} s are more than {_MOST_STEPS:.0e} "
            "steps; take a shorter duration, longer steps or fewer seeds"
        )
    return SimulationSettings(table.seeds, duration, simulation_step(sampling, step))


def _track(table: TrackTable, plant: LoopPlant, demand: Demand | None) -> TrackDemand:
    """Return the track; the circle of acceptance defaults to two lengths (Fossen 2011, section 10.3)."""
    if demand is None or plant.output != "psi":
        raise InputError('track: a track is kept by a heading loop; give plant.output = "psi" and [demand], or leave '
                         "the table out")  # fmt: skip
    if table.corner > _SHARPEST_CORNER:
        raise InputError(
            f"track.corner = {math.degrees(table.corner):.3g} deg is no corner to keep a track around; give one up to "
            f"{math.degrees(_SHARPEST_CORNER):.0f} degrees"
        )
    if table.acceptance is not None:
        acceptance = table.acceptance
    elif plant.ship is not None and "L" in plant.ship.particulars:
        acceptance = _ACCEPTANCE_LENGTHS * plant.ship.length
    else:
        raise InputError("key 'track.acceptance' is missing, and the ship's length is not known; add it in m")
    return TrackDemand(table.current, table.bandwidth, table.corner, acceptance)


def _station(table: StationTable, file: LoopFile, plant: LoopPlant) -> StationDemand:
    """Return the station, its forces in the unit of the model: N, or N for each kg."""
    if plant.craft is None or plant.output != "psi":
        raise InputError(
            "station: a station is kept by the thrusters of an identified craft beside its heading loop; give "
            'plant.model of a craft with thrusters and leave plant.output out (or "psi"), or leave [station] out'
        )
    layout = layout_of(plant.craft.model)
    gust = 0.0
    if table.gust is not None:
        gust = positive_value(table.gust, "N" if layout.has_bollard else "m/s^2", "station.gust")
    return StationDemand(
        model=plant.craft.model,
        covariance=plant.craft.covariance,
        current=table.current,
        current_rms=table.current_rms,
        current_bandwidth=table.bandwidth,
        gust_rms=gust,
        gust_bandwidth=table.gust_bandwidth or 0.0,
        limit=table.limit,
        dead_time=_dead_time(file.actuator),
        hull=hull_factor(file.hull, plant.ship),
    )


def _demand(table: DemandTable, plant: LoopPlant) -> Demand:
    """Return the demand; its time constant defaults to length over speed, and thirty are simulated."""
    if plant.disturbed_by == "alpha_w":
        raise InputError("demand: a roll stabiliser follows no demand; leave the table out")
    unit = symbol_unit(plant.output)
    change = (
        angle_value(table.change, "demand.change") if unit == "rad" else si_value(table.change, unit, "demand.change")
    )
    if not change:
        raise InputError("demand.change = 0 asks for nothing; give a change")
    if table.time_constant is not None:
        T = table.time_constant
    elif plant.ship is not None and "L" in plant.ship.particulars:
        T = plant.ship.length / plant.U
    else:
        raise InputError("key 'demand.time_constant' is missing, and the ship's length is not known; add it in s")
    settling = math.inf if table.settling is None else table.settling
    return Demand(change, table.overshoot, T, _TIME_CONSTANTS * T, settling, table.feed_forward)
