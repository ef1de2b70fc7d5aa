"""One controller out of the fronts, with reasons: by simulation where there is one, else the compromise."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.assess import Judge
from seatrial.control.demand import shortfall
from seatrial.control.front import spread
from seatrial.control.sail import sailed
from seatrial.control.task import Task
from seatrial.core.results.tuning import Front
from seatrial.core.values import Array
from seatrial.numerics.optimise import non_dominated

CANDIDATES = 8
TOO_MUCH_LOST = 0.03
_SELECTION_SEEDS, _OTHER_SEAS = 8, 100_000
_EQUAL, _CAUTION = 0.003, 0.85


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
        return _following(task, known[0], tell)
    if task.trials is not None:
        return _sailing(task, known, seed, tell)
    judge, front = known[0]
    some = _envelope(judge, front)
    return Choice(judge, some[_by_compromise(judge, some)[0]], front.name, (_compromise(task, "the front"),))


def _compromise(task: Task, of: str) -> str:
    decades = "the output's in decades" if task.demand is None else "in decades"
    return (
        f"It is the compromise of {of}: nearest to the best of output and actuator at once, each over its range, "
        f"{decades} (least largest distance; Zeleny 1973)."
    )


def _envelope(judge: Judge, front: Front) -> Array:
    """Gains of the front of which none leaves less of the output at a lower actuator rate, by output, (n, g)."""
    both = _both(judge, front.gains)
    first = non_dominated(both)
    return front.gains[first[np.argsort(both[first, 0])]]


def _both(judge: Judge, gains: Array) -> Array:
    """Variances of output and actuator rate, means over what the loop meets, (n, 2)."""
    return judge.of(gains).variances[:, :, [0, 2]].mean(axis=1)


def _by_compromise(judge: Judge, gains: Array) -> list[int]:
    """Order of some gains by their largest distance from the best, rms of output against rms of actuator rate.

    In decades; the rate as it is where no demand is followed: there gains of zero are on the front, decades from any.
    """
    both = np.sqrt(_both(judge, gains))
    decades = slice(0, 1 if judge.task.demand is None else 2)
    both[:, decades] = np.log(np.maximum(both[:, decades], 1e-150))
    far = (both - both.min(axis=0)) / np.maximum(np.ptp(both, axis=0), 1e-12)
    return np.argsort(far.max(axis=1), kind="stable").tolist()


@dataclass(frozen=True, eq=False)
class _Tried:
    """A candidate simulated: mean reduction with limits, with and without stall, points lost to limits, rms rate."""

    judge: Judge
    gains: Array
    of: str
    reduction: float
    lost: float
    rate: float


def _sailing(task: Task, known: tuple[tuple[Judge, Front], ...], seed: int, tell: Callable[[str], None]) -> Choice:
    """The candidate that reduces the motion most in simulation with the actuator's limits, losing little to them."""
    assert task.trials is not None
    few = replace(task, trials=replace(task.trials, seeds=_SELECTION_SEEDS))

    def simulated(judge: Judge, front: Front, gains: Array) -> _Tried:
        made = sailed(few, judge.loop, "candidate", gains, seed + _OTHER_SEAS)
        reduction = 0.5 * float(np.mean(made.limited) + np.mean(made.stalled))
        rate = float(judge.of(gains[None]).variances[0, :, 2].mean())
        return _Tried(judge, gains, front.name, reduction, made.lost, rate)

    tried: list[_Tried] = []
    for judge, front in known:
        some = _envelope(judge, front)
        near = some[np.unique(np.linspace(0, len(some) - 1, CANDIDATES).astype(int))]
        for around in ("along the front", "about the best"):
            made = [simulated(judge, front, gains) for gains in near]
            tried += made
            tell(f"choice: {front.name}, {len(made)} candidates {around} simulated")
            near = _about(some, _best(made).gains)
    best = _best(tried)
    reasons = (
        f"Of {len(tried)} controllers along the fronts it reduces the motion most when simulated within the actuator's "
        f"limits, with and without stall, whose law is assumed (mean {100.0 * best.reduction:.1f} % on "
        f"{_SELECTION_SEEDS} seas kept for the choice); of equals it moves the actuator least.",
        f"It loses {100.0 * best.lost:.1f} points of reduction to angle and rate limits there; a loss of "
        f"{100.0 * TOO_MUCH_LOST:.0f} points or more is not recommended.",
    )
    return Choice(best.judge, best.gains, best.of, reasons)


def _best(tried: list[_Tried]) -> _Tried:
    """The best reduction of those that lose little, else of all; of equals the one that moves the actuator least."""
    keeping = [one for one in tried if one.lost < _CAUTION * TOO_MUCH_LOST] or tried
    most = max(one.reduction for one in keeping)
    return min((one for one in keeping if one.reduction >= most - _EQUAL), key=lambda one: one.rate)


def _about(some: Array, gains: Array) -> Array:
    """Gains between the neighbours, a candidate's distance away, of one of `some`, (n, g)."""
    place = int(np.argmin(np.abs(some - gains).max(axis=1)))
    step = max(len(some) // CANDIDATES, 1)
    low, high = max(place - step, 0), min(place + step, len(some) - 1)
    return some[np.unique(np.linspace(low, high, CANDIDATES).astype(int))]


def _following(task: Task, known: tuple[Judge, Front], tell: Callable[[str], None]) -> Choice:
    """The compromise among those that follow the demand without overshooting, in simulation."""
    assert task.demand is not None
    judge, front = known
    some = _envelope(judge, front)
    some = some[spread(_both(judge, some), 2 * CANDIDATES)]
    short = []
    for gains in some:
        short.append(shortfall(task, judge.loop, gains))
        tell(f"choice: {len(short)} of {len(some)} candidates carried through the demand")
    keeping = some[np.array([far == 0.0 for far, _ in short])]
    if not len(keeping):
        least = min(range(len(some)), key=lambda i: short[i][0])
        why = (f"No candidate follows the demand as asked; this one comes nearest, but {short[least][1]}.",)
        return Choice(judge, some[least], front.name, why)
    why = (
        f"{len(keeping)} of {len(some)} controllers along the front follow the demand in the nonlinear model, with no "
        f"more than {100.0 * task.demand.overshoot:.3g} % of overshoot, and keep every ship stable that the fit "
        "allows.",
        _compromise(task, "those"),
    )
    return Choice(judge, keeping[_by_compromise(judge, keeping)[0]], front.name, why)
