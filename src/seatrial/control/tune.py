"""A task in, a tuning out: fronts, choice, simulation, schedule, bounds."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from seatrial.control.assess import Judge, judge
from seatrial.control.bounds import bounds, is_available
from seatrial.control.choose import Choice, choose
from seatrial.control.controller import components, controller
from seatrial.control.demand import manoeuvres
from seatrial.control.feasible import refuse_idle, refuse_infeasible
from seatrial.control.findings import findings
from seatrial.control.front import Effort, front, grid, thinned
from seatrial.control.sail import paired, sailed
from seatrial.control.schedule import schedule
from seatrial.control.task import Task
from seatrial.core.results.tuning import Bound, Controller, Front, Manoeuvre, Paired, Sailed, Slot, Tuning
from seatrial.core.values import Array
from seatrial.core.values.versions import versions
from seatrial.numerics.optimise import Solution, Status, hypervolume

SHOWN = 300
DRAWS = 100
# points a gain of the grid that the front is checked against
_GRID = {1: 2000, 2: 400, 3: 100}


@dataclass
class _Checked:
    """What later steps add; an interruption keeps what is there."""

    sailed: tuple[Sailed, ...] = ()
    paired: tuple[Paired, ...] = ()
    manoeuvres: tuple[Manoeuvre, ...] = ()
    schedule: tuple[Slot, ...] = ()
    bounds: tuple[Bound, ...] = ()
    is_interrupted: bool = field(default=False)


def tune(
    task: Task,
    *,
    seed: int = 0,
    progress: Callable[[str], None] = lambda _: None,
    effort: Effort | None = None,
) -> Tuning:
    """Tune the task's loop; the same seed gives the same gains, `effort` is that of each front.

    Raises:
        InputError: no gains keep the restrictions (which, by how much), or none but zero do, or the simulation runs
            away.
    """
    began = time.perf_counter()
    judges = (judge(task), *(judge(task, loop) for loop in task.richer))
    fronts = tuple((one, _front(one, task, seed, progress, effort or Effort())) for one in judges)
    if not len(fronts[0][1].gains):
        refuse_infeasible(judges[0], seed)
    choice = choose(task, fronts, seed, progress)
    chosen = controller(choice.judge, "chosen", choice.gains)
    refuse_idle(chosen)
    rivals = {name: np.array([gains[n] for n in task.loop.gains.names]) for name, gains in task.rivals.items()}
    others = tuple(controller(judges[0], name, gains) for name, gains in rivals.items())
    stable = {one.name: rivals[one.name] for one in others if np.isfinite(one.peak)}
    checked = _check(task, choice, stable, seed, progress)
    return Tuning(
        question=task.question,
        name=task.name,
        plant=task.plant,
        seas=tuple(met.said for met in task.met),
        output=task.loop.output,
        actuator=task.loop.actuator,
        objectives=tuple(objective.name for objective in task.objectives),
        units=tuple(objective.unit for objective in task.objectives),
        restriction=task.restriction,
        chosen=chosen,
        reasons=(*choice.reasons, *_against(chosen, others)),
        rivals=others,
        front=thinned(fronts[0][1], SHOWN),
        richer=tuple(thinned(made, SHOWN) for _, made in fronts[1:] if len(made.gains)),
        components=components(choice.judge.loop),
        sailed=checked.sailed,
        paired=checked.paired,
        schedule=checked.schedule,
        bounds=checked.bounds,
        manoeuvres=checked.manoeuvres,
        findings=findings(
            choice.judge,
            chosen,
            others,
            fronts[0][1],
            sailed=checked.sailed,
            paired=checked.paired,
            schedule=checked.schedule,
            manoeuvres=checked.manoeuvres,
            is_interrupted=checked.is_interrupted,
        ),
        solution=Solution(
            choice.gains,
            float(chosen.objectives[0]),
            Status.EXHAUSTED,
            sum(made.evaluations for _, made in fronts),
            (),
            seed,
        ),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )


def _front(one: Judge, task: Task, seed: int, tell: Callable[[str], None], effort: Effort) -> Front:
    """The front of one loop; with up to three free gains its hypervolume over that of a grid, to the grid's nadir."""
    name = f"{len(one.loop.gains.free)} gains" if one.loop is task.loop else one.loop.name
    made = front(one, name, seed, tell, effort)
    count = _GRID.get(len(one.loop.gains.free))
    if count is None or not len(made.gains):
        return made
    known = grid(one, (count,) * len(one.loop.gains.free))
    tell(f"{name}: checked against a grid")
    if not len(known):
        return made
    live = np.ptp(known, axis=0) > 0.0
    nadir = known[:, live].max(axis=0)
    if not live.any():
        return made
    return replace(made, hypervolume=hypervolume(made.objectives[:, live], nadir) / hypervolume(known[:, live], nadir))


def _check(task: Task, choice: Choice, rivals: dict[str, Array], seed: int, tell: Callable[[str], None]) -> _Checked:
    """Simulation, schedule and bounds, as far as the task asks for them and nobody interrupts."""
    made, loop = _Checked(), choice.judge.loop
    try:
        if task.demand is not None:
            tell(f"the demand, with {DRAWS} ships that the fit allows")
            made.manoeuvres = manoeuvres(task, loop, "chosen", choice.gains, seed, draws=DRAWS)
        if task.trials is not None and task.demand is None:
            made.sailed, made.paired = _sail(task, choice, rivals, seed, tell)
        if task.plan is not None:
            made.schedule = schedule(task, task.plan, {**rivals, **_own(task, choice)}, seed, tell)
        if is_available() and task.demand is None:
            tell("bounds")
            made.bounds = bounds(task, loop, choice.gains)
    except KeyboardInterrupt:
        made.is_interrupted = True
    return made


def _own(task: Task, choice: Choice) -> dict[str, Array]:
    """The chosen gains, where they belong to the task's own loop."""
    return {"chosen": choice.gains} if choice.judge.loop is task.loop else {}


def _sail(
    task: Task, choice: Choice, rivals: dict[str, Array], seed: int, tell: Callable[[str], None]
) -> tuple[tuple[Sailed, ...], tuple[Paired, ...]]:
    tell("chosen gains simulated")
    first = sailed(task, choice.judge.loop, "chosen", choice.gains, seed)
    others = []
    for name, gains in rivals.items():
        tell(f"{name} simulated")
        others.append(sailed(task, task.loop, name, gains, seed))
    pairs = [paired(first, other, what) for other in others for what in ("limited", "stalled")]
    return (first, *others), tuple(pairs)


def _against(chosen: Controller, others: tuple[Controller, ...]) -> tuple[str, ...]:
    """The chosen one beside each rival, a sentence each."""
    return tuple(
        f"Beside '{other.name}' it leaves {100.0 * (1.0 - chosen.reduction):.1f} % of the motion instead of "
        f"{100.0 * (1.0 - other.reduction):.1f} %, at "
        f"{chosen.rms['actuator_rate'] / other.rms['actuator_rate']:.2f} times the actuator's rms rate and Ms "
        f"{chosen.peak:.2f} instead of {other.peak:.2f}."
        for other in others
        if other.rms["actuator_rate"] > 0.0 and np.isfinite(other.peak)
    )
