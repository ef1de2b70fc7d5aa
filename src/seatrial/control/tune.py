"""A task in, a tuning out: fronts, choice, simulation, schedule, bounds."""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.control.bounds import bounds, is_available
from seatrial.control.choice import choose
from seatrial.control.controller import components, describe_controller, discrete_controller, simulate_manoeuvres
from seatrial.control.findings import Checks, findings
from seatrial.control.front import (
    OWN_CHOICE,
    Effort,
    grid_front,
    pareto_front,
    published_search,
    refuse_idle,
    refuse_infeasible,
    thin_front,
)
from seatrial.control.gain_evaluation import GainChoice, GainEvaluator, NamedGains, gain_evaluator
from seatrial.control.robustness import robustness
from seatrial.control.schedule import schedule
from seatrial.control.simulation import compare_pairwise, energy_saving, simulate_disturbances, simulate_in_seaway
from seatrial.control.station.tune_station import tune_station
from seatrial.control.task import OUTPUT, TuningTask
from seatrial.control.track.tune_track import tune_track
from seatrial.core.results.tuning import (
    Controller,
    PairedDifference,
    ParetoFront,
    Robustness,
    SeawaySimulation,
    Tuning,
    TuningMethod,
)
from seatrial.core.values import NOTATION, display_unit
from seatrial.core.values.versions import versions
from seatrial.numerics.optimise import Solution, Status, hypervolume
from seatrial.physics.loops import margins

FRONT_POINTS = 300  # points of a front that are kept in the result; chosen
PARAMETER_DRAWS = 100  # ships drawn from the fit that follow a demand; chosen
_GRID = {1: 2000, 2: 200, 3: 60}  # free gains -> points a gain of the grid that the front is checked against; chosen


def tune(
    task: TuningTask,
    *,
    seed: int = 0,
    report_progress: Callable[[str], None] = lambda _: None,
    effort: Effort | None = None,
    method: TuningMethod = TuningMethod.FRONT,
) -> Tuning:
    """Tune the task's loop; the same seed gives the same gains, `effort` is that of each front.

    With a published `method` the chosen gains are its answer, and the choice from the front stands beside them.

    Raises:
        InputError: no gains keep the restrictions (which, by how much), or none but zero do, or the simulation runs
            away.
    """
    began = time.perf_counter()
    judges = (gain_evaluator(task), *(gain_evaluator(task, loop) for loop in task.extended_structures))
    fronts = tuple((one, _checked_front(one, task, seed, report_progress, effort or Effort())) for one in judges)
    if not len(fronts[0][1].gains):
        refuse_infeasible(judges[0], seed)
    own = choose(task, fronts, seed, report_progress)
    refuse_idle(describe_controller(own.evaluator, "chosen", own.gains))
    searched = None
    if method is TuningMethod.GENETIC:
        report_progress(f"genetic algorithm, {task.genetic.seeds} seeds")
        searched = published_search(judges[0], task.genetic, fronts[0][1], seed)
    choice = own if searched is None else searched.choice
    chosen = describe_controller(choice.evaluator, "chosen", choice.gains)
    reference = None if searched is None else describe_controller(own.evaluator, OWN_CHOICE, own.gains)
    designs = tuple(describe_controller(one.evaluator, one.name, one.gains) for one in own.designs)
    rivals = {name: _given_gains(judges[0], name, gains) for name, gains in task.baselines.items()}
    baselines = tuple(describe_controller(one.evaluator, name, one.gains) for name, one in rivals.items())
    stable = {one.name: rivals[one.name] for one in baselines if np.isfinite(one.Ms)}
    compared = stable if reference is None else {reference.name: own, **stable}
    checks = _run_checks(task, choice, compared, seed, report_progress)
    more_fronts = (*(made for _, made in fronts[1:]), *(() if searched is None else (searched.front,)))
    evaluations = sum(made.evaluations for _, made in fronts) if searched is None else searched.result.evaluations
    return Tuning(
        question=task.question,
        name=task.name,
        plant=task.plant,
        seas=tuple(met.description for met in task.disturbances),
        output=task.loop.output,
        actuator=task.loop.actuator,
        objectives={objective.name: objective.unit for objective in task.objectives},
        constraints=task.constraints,
        chosen=chosen,
        reasons=(
            *choice.reasons,
            *_comparison_reasons(chosen, baselines if reference is None else (reference, *baselines), task.loop.output),
        ),
        baselines=baselines,
        front=thin_front(fronts[0][1], FRONT_POINTS),
        extended_fronts=tuple(thin_front(made, FRONT_POINTS) for made in more_fronts if len(made.gains)),
        components=components(task.disturbances[0].disturbed(choice.evaluator.loop)),
        seaway_simulations=checks.simulations,
        disturbance_simulations=checks.disturbances,
        paired_differences=checks.comparisons,
        energy_savings=_energy_savings(checks.simulations),
        schedule=checks.schedule.points,
        schedule_trades=checks.schedule.trades,
        schedule_check=checks.schedule.check,
        bounds=checks.bounds,
        manoeuvres=checks.manoeuvres,
        findings=findings(choice.evaluator, chosen, baselines, fronts[0][1], checks, method),
        solution=Solution(choice.gains, float(chosen.objectives[0]), Status.EXHAUSTED, evaluations, (), seed),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
        method=method,
        search=None if searched is None else searched.result,
        reference=reference,
        designs=designs,
        gain_units={gain.name: gain.unit for gain in choice.evaluator.loop.gains},
        motion="" if task.motion is OUTPUT else task.motion.name.removeprefix("variance of the "),
        robustness=_robustness(task, choice, own.designs, rivals),
        track=checks.track,
        station=checks.station,
        discrete=discrete_controller(task, choice.evaluator.loop.with_gains(choice.gains)),
    )


def _robustness(
    task: TuningTask, choice: GainChoice, designs: Sequence[NamedGains], rivals: Mapping[str, GainChoice]
) -> tuple[Robustness, ...]:
    """Return how the chosen gains, the designs and the given ones hold ships that differ from the model."""
    named = (("chosen", choice), *((one.name, one) for one in designs), *rivals.items())
    loops = [(name, one, task.loop_at(task.U, one.evaluator.loop)) for name, one in named]
    return tuple(
        robustness(task, loop, name, one.gains)
        for name, one, loop in loops
        if margins(loop.with_gains(one.gains)).is_stable
    )


def _given_gains(evaluator: GainEvaluator, name: str, gains: Mapping[str, float]) -> GainChoice:
    """Return gains by name as a choice for the loop of `evaluator`."""
    return GainChoice(evaluator, np.array([gains[n] for n in evaluator.loop.gains.names]), name, ())


def _checked_front(
    evaluator: GainEvaluator, task: TuningTask, seed: int, report_progress: Callable[[str], None], effort: Effort
) -> ParetoFront:
    """The front of one loop; with up to three free gains its hypervolume over that of a grid, to the grid's nadir."""
    name = f"{len(evaluator.loop.gains.free)} gains" if evaluator.loop is task.loop else evaluator.loop.name
    began = time.process_time()
    made = pareto_front(evaluator, name, seed, report_progress, effort)
    made = replace(made, cpu_s=time.process_time() - began)
    count = _GRID.get(len(evaluator.loop.gains.free))
    if count is None or not len(made.gains):
        return made
    known = grid_front(evaluator, (count,) * len(evaluator.loop.gains.free))
    report_progress(f"front of {name}: checked against a grid")
    if not len(known):
        return made
    live = np.ptp(known, axis=0) > 0.0
    nadir = known[:, live].max(axis=0)
    whole = hypervolume(known[:, live], nadir) if live.any() else 0.0
    if not whole > 0.0:
        return made
    return replace(made, hypervolume=hypervolume(made.objectives[:, live], nadir) / whole)


def _run_checks(
    task: TuningTask,
    choice: GainChoice,
    compared: dict[str, GainChoice],
    seed: int,
    report_progress: Callable[[str], None],
) -> Checks:
    """Return simulation, schedule and bounds, as far as the task asks for them and nobody interrupts."""
    made, loop = Checks(), choice.evaluator.loop
    try:
        if task.demand is not None:
            report_progress(f"demand on {PARAMETER_DRAWS} ships that the fit allows")
            made.manoeuvres = simulate_manoeuvres(task, loop, "chosen", choice.gains, seed, draws=PARAMETER_DRAWS)
            report_progress("what disturbs the loop, simulated with the actuator's limits")
            made.disturbances = simulate_disturbances(task, loop, choice.gains, seed)
        if task.track is not None:
            report_progress("track: lookahead distance")
            made.track = tune_track(task, task.track, loop, choice.gains, seed, report_progress)
        if task.station is not None:
            made.station = tune_station(task, task.station, seed, report_progress)
        if task.simulation is not None and task.demand is None:
            made.simulations, made.comparisons = _simulate_controllers(task, choice, compared, seed, report_progress)
        if task.schedule_grid is not None:
            named = {**compared, "chosen": choice}
            fixed = {name: one.gains for name, one in named.items() if one.evaluator.loop is task.loop}
            made.schedule = schedule(task, task.schedule_grid, fixed, seed, report_progress)
        if is_available() and task.demand is None:
            report_progress("bounds")
            made.bounds = bounds(task, loop, choice.gains)
    except KeyboardInterrupt:
        made.is_interrupted = True
    return made


def _simulate_controllers(
    task: TuningTask,
    choice: GainChoice,
    compared: dict[str, GainChoice],
    seed: int,
    report_progress: Callable[[str], None],
) -> tuple[tuple[SeawaySimulation, ...], tuple[PairedDifference, ...]]:
    report_progress("simulation in waves: chosen gains")
    first = simulate_in_seaway(task, choice.evaluator.loop, "chosen", choice.gains, seed)
    others = []
    for name, one in compared.items():
        report_progress(f"simulation in waves: {name}")
        others.append(simulate_in_seaway(task, one.evaluator.loop, name, one.gains, seed))
    pairs = [compare_pairwise(first, other, what) for other in others for what in ("limited", "stalled")]
    return (first, *others), tuple(pairs)


def _energy_savings(simulations: Sequence[SeawaySimulation]) -> tuple[PairedDifference, ...]:
    """Return what the first needs less than each other; nothing where neither inertia nor area is declared."""
    if not simulations or not (len(simulations[0].drive_energy) or len(simulations[0].drag_energy)):
        return ()
    return tuple(energy_saving(simulations[0], other) for other in simulations[1:])


def _meaning(controller: Controller) -> str:
    """Return what the name of the package's own choice stands for; nothing for given gains."""
    return " (the package's choice from its own front)" if controller.name == OWN_CHOICE else ""


def _remaining_motion(controller: Controller, output: str) -> str:
    """Return what a controller leaves: a share of the motion, or its rms where that has none without control."""
    if math.isfinite(controller.reduction):
        return f"{100.0 * (1.0 - controller.reduction):.1f} % of the motion"
    factor, unit = display_unit(NOTATION[output].unit if output in NOTATION else "1")
    return f"{controller.rms['output'] * factor:.3g} {unit} rms".replace(" 1 rms", " rms")


def _comparison_reasons(chosen: Controller, baselines: tuple[Controller, ...], output: str) -> tuple[str, ...]:
    """Return the chosen one beside each rival, a sentence each."""
    return tuple(
        _comparison_reason(chosen, other, output)
        for other in baselines
        if other.rms["actuator_rate"] > 0.0 and np.isfinite(other.Ms) and np.isfinite(chosen.Ms)
    )


def _comparison_reason(chosen: Controller, other: Controller, output: str) -> str:
    leaves, theirs = _remaining_motion(chosen, output), _remaining_motion(other, output)
    return (
        f"By linear theory, compared with '{other.name}'{_meaning(other)}, it leaves {leaves}"
        f"{', as much' if leaves == theirs else f' instead of {theirs}'}, at "
        f"{chosen.rms['actuator_rate'] / other.rms['actuator_rate']:.2f} times the actuator's rms rate and Ms "
        f"{chosen.Ms:.2f} instead of {other.Ms:.2f}."
    )
