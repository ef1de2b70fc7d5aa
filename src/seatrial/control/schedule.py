"""Gains for every speed, heading and height of sea, beside one set for all."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from seatrial.control.assess import OUTPUT, Judge, beyond
from seatrial.control.press import free_box, pressed, whole
from seatrial.control.task import Plan, Seaway, Task
from seatrial.core.results.tuning import Slot
from seatrial.core.values import Array

_SAMPLES, _STARTS, _ROUNDS, _NEAR = 4096, 3, 8, 1024


@dataclass(frozen=True, eq=False)
class Condition:
    """One speed, heading and height, with the judge of its loop: least output variance."""

    U: float
    beta: float
    height: float
    judge: Judge

    def cost(self, gains: Array) -> Array:
        """Output rms over that without control, of the gains (n, g); infinite where unstable."""
        return np.sqrt(self.judge.of(gains).objectives[:, 0] / self.judge.uncontrolled)


def conditions(task: Task, plan: Plan) -> tuple[Condition, ...]:
    """Every combination of the plan; the first seaway of the task gives spectrum, hull and spreading."""
    sea = next(met for met in task.met if isinstance(met, Seaway))
    made = []
    for height, U, beta in product(plan.heights, plan.speeds, plan.headings):
        met = replace(sea, spectrum=sea.spectrum.of_height(height), U=U, beta=beta)
        made.append(Condition(U, beta, height, Judge(replace(task, met=(met,)), task.loop, (OUTPUT,))))
    return tuple(made)


def schedule(
    task: Task, plan: Plan, rivals: Mapping[str, Array], seed: int, tell: Callable[[str], None]
) -> tuple[Slot, ...]:
    """The best gains of each condition, and what `rivals` (name -> gains) and one set for all cost there.

    "one for all" has the least mean cost of all sets that keep the restrictions in every condition.
    """
    known = conditions(task, plan)
    samples = _samples(known[0].judge, seed)
    made, best, others = [], [], dict(rivals)
    for i, condition in enumerate(known):
        best.append(_best_of(condition, samples))
        tell(f"schedule: {i + 1} of {len(known)} conditions")
    one = _one_for_all(known, samples, np.random.default_rng(seed))
    if one is not None:
        others["one for all"] = one
    for condition, gains in zip(known, best, strict=True):
        judged = condition.judge.of(gains[None])
        made.append(Slot(
            condition.U, condition.beta, condition.height,
            dict(zip(task.loop.gains.names, gains.tolist(), strict=True)),
            float(condition.cost(gains[None])[0]), float(judged.peak[0]),
            beyond(task.restriction.limit, float(judged.variances[0, 0, 1])),
            {name: float(condition.cost(other[None])[0]) for name, other in others.items()},
            bool(judged.is_feasible[0]),
        ))  # fmt: skip
    return tuple(made)


def _samples(judge: Judge, seed: int) -> Array:
    """Gains spread over their box, (n, g): Sobol points, half of them towards small gains."""
    from scipy.stats import qmc

    _, (low, high) = free_box(judge)
    unit = qmc.Sobol(len(low), seed=seed).random(_SAMPLES)
    unit[::2] **= 3.0
    return whole(judge, low + unit * (high - low))


def _one_for_all(known: tuple[Condition, ...], samples: Array, rng: np.random.Generator) -> Array | None:
    """Gains (g,) of the least mean cost among those that keep the restrictions everywhere; None without any."""
    places, (low, high) = free_box(known[0].judge)
    best, least, tried = None, math.inf, samples
    for size in np.geomspace(0.1, 0.003, _ROUNDS):
        total = np.mean([np.where(c.judge.of(tried).is_feasible, c.cost(tried), np.inf) for c in known], axis=0)
        place = int(np.argmin(total))
        if total[place] < least:
            best, least = tried[place], float(total[place])
        if best is None:
            return None
        steps = size * (high - low) * rng.standard_normal((_NEAR, len(places)))
        tried = whole(known[0].judge, np.clip(best[places] + steps, low, high))
    return best


def _best_of(condition: Condition, samples: Array) -> Array:
    """The best samples pressed against the restrictions; the least variance wins, (g,)."""
    judge = condition.judge
    judged = judge.of(samples)
    values = np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)
    places = free_box(judge)[0]
    if not np.isfinite(values).any():
        return samples[int(np.argmin(judged.excess.max(axis=1)))]

    tried = [samples[i] for i in np.argsort(values)[:_STARTS]]
    tried += [whole(judge, pressed(judge, start[places])[None])[0] for start in tried]
    judged = judge.of(np.array(tried))
    return tried[int(np.argmin(np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)))]
