"""One controller out of the fronts, with reasons: by simulation where there is one, else the compromise."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.results.tuning import Front
from seatrial.tune.assess import Judge
from seatrial.tune.demand import manoeuvres
from seatrial.tune.front import non_dominated, spread
from seatrial.tune.sail import sailed
from seatrial.tune.task import Task
from seatrial.values import Array

CANDIDATES = 10
TOO_MUCH_LOST = 0.03
_SELECTION_SEEDS, _OTHER_SEAS = 3, 100_000
_EQUAL = 0.003


@dataclass(frozen=True, eq=False)
class Choice:
    """The judge of the chosen loop, its gains (g,), the name of the front they come from, and why."""

    judge: Judge
    gains: Array
    of: str
    reasons: tuple[str, ...]


def choose(task: Task, fronts: tuple[tuple[Judge, Front], ...], seed: int, tell: Callable[[str], None]) -> Choice:
    """The recommendation, from fronts that are not empty."""
    known = tuple((judge, front) for judge, front in fronts if len(front.gains))
    if task.demand is not None:
        return _following(task, known[0], seed, tell)
    if task.trials is not None:
        return _sailing(task, known, seed, tell)
    judge, front = known[0]
    some = _envelope(judge, front)
    return Choice(judge, some[_by_compromise(judge, some)[0]], front.name, (_COMPROMISE,))


_COMPROMISE = (
    "It is the compromise of the front: nearest to the best of output and actuator at once, each over its range in "
    "decades (least largest distance; Zeleny 1973)."
)


def _envelope(judge: Judge, front: Front) -> Array:
    """Gains of the front of which none moves both output and actuator less than another, well apart, (n, g)."""
    made = judge.of(front.gains)
    both = made.variances[:, :, :2].mean(axis=1)
    first = np.flatnonzero(non_dominated(both))
    return front.gains[first[spread(both[first], CANDIDATES)]]


def _by_compromise(judge: Judge, gains: Array) -> list[int]:
    """Order of some gains by their largest distance from the best, output against actuator rate."""
    both = np.log(np.maximum(judge.of(gains).variances[:, :, [0, 2]].mean(axis=1), 1e-300))
    far = (both - both.min(axis=0)) / np.maximum(np.ptp(both, axis=0), 1e-12)
    return np.argsort(far.max(axis=1), kind="stable").tolist()


def _sailing(task: Task, known: tuple[tuple[Judge, Front], ...], seed: int, tell: Callable[[str], None]) -> Choice:
    """The candidate that reduces the motion most in simulation with limits and stall, losing little to the limits."""
    assert task.trials is not None
    few = replace(task, trials=replace(task.trials, seeds=_SELECTION_SEEDS))
    tried: list[tuple[float, float, float, Choice]] = []
    for judge, front in known:
        some = _envelope(judge, front)
        rates = judge.of(some).variances[:, :, 2].mean(axis=1)
        for i, (gains, rate) in enumerate(zip(some, rates, strict=True)):
            made = sailed(few, judge.loop, "candidate", gains, seed + _OTHER_SEAS)
            tried.append((float(np.mean(made.stalled)), made.lost, float(rate), Choice(judge, gains, front.name, ())))
            tell(f"choice: {front.name}, candidate {i + 1} of {len(some)} simulated")
    keeping = [item for item in tried if item[1] < 0.8 * TOO_MUCH_LOST] or tried
    best = max(item[0] for item in keeping)
    reduction, lost, _, choice = min((item for item in keeping if item[0] >= best - _EQUAL), key=lambda item: item[2])
    reasons = (
        f"Of {len(tried)} controllers along the fronts it reduces the motion most when simulated with angle and rate "
        f"limits and stall ({100.0 * reduction:.1f} % on {_SELECTION_SEEDS} seas kept for the choice); of equals it "
        "moves the actuator least.",
        f"It loses {100.0 * lost:.1f} points of reduction to angle and rate limits there; more than "
        f"{100.0 * TOO_MUCH_LOST:.0f} points are not recommended.",
    )
    return replace(choice, reasons=reasons)


def _following(task: Task, known: tuple[Judge, Front], seed: int, tell: Callable[[str], None]) -> Choice:
    """The best compromise that follows the demand without overshooting, in simulation."""
    assert task.demand is not None
    judge, front = known
    some = _envelope(judge, front)
    order = _by_compromise(judge, some)
    worst: list[float] = []
    for count, place in enumerate(order, start=1):
        made = manoeuvres(task, judge.loop, "candidate", some[place], seed, draws=0)
        worst.append(made[0].overshoot)
        tell(f"choice: candidate {count} of {len(order)} carried through the demand")
        if made[0].overshoot <= task.demand.overshoot:
            why = (
                _COMPROMISE,
                f"It follows the demand with {100.0 * made[0].overshoot:.1f} % overshoot in the nonlinear model"
                + (f"; {count - 1} better compromises overshoot more than allowed." if count > 1 else "."),
            )
            return Choice(judge, some[place], front.name, why)
    least = int(np.argmin(worst))
    why = (f"No candidate keeps the overshoot allowed; this one overshoots least, by {100.0 * worst[least]:.1f} %.",)
    return Choice(judge, some[order[least]], front.name, why)
