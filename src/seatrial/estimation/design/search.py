"""The search: orders whose worst ship, measured by what standard sequences would have told of it, is told best."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.design.exchange import exchanged
from seatrial.estimation.design.orders import counts, inputs, split
from seatrial.estimation.design.standards import Standard
from seatrial.estimation.design.task import Criterion, Task
from seatrial.estimation.design.worth import Bench, Told, excess, leaves
from seatrial.numerics.optimise import AdaptationSettings, Box, CovarianceAdaptation, Solution, Status
from seatrial.numerics.workers import mapped

# the mean over ships of (error / error of the best standard sequence)^4: near the worst ship's, and smooth
POWER = 4.0
LOST = 50.0
EXCESS = 20.0
# kept from the limits during the search, so that finer steps and other ships do not cross them
MARGIN = 0.02
DRAWN_STARTS = 96
GENERATIONS = 200
# evaluations of the exchange for each generation that follows
EXCHANGES = 5
# the search's box: a point beyond an end means that end, so that full deflection is no corner to be hit
LOWEST, HIGHEST, STEP = -1.0, 2.0, 0.1


@dataclass(frozen=True, eq=False)
class Yardstick:
    """The smallest error (ships,) that any standard sequence gives each ship."""

    bench: Bench
    reference: Array

    @classmethod
    def of(cls, bench: Bench, standard: list[Standard]) -> "Yardstick":
        """From the standard manoeuvres that keep within the limits, or all where none does."""
        told = [bench.told(r.made(bench)) for r in standard]
        errors = np.array([errors_of(bench.task, t) for t in told])
        within = np.array([not leaves(bench.task, t) for t in told])
        chosen = errors[within] if within.any() else errors
        return cls(bench, np.nanmin(np.where(np.isfinite(chosen), chosen, LOST), axis=0))

    def cost(self, point: Array) -> float:
        """Logarithm of the power mean of the ratios, and what leaving the limits costs."""
        task = self.bench.task
        told = self.bench.told(inputs(task, split(task, point), self.bench.dt))
        ratio = np.minimum(np.nan_to_num(errors_of(task, told) / self.reference, nan=LOST), LOST)
        return float(np.log(np.mean(ratio**POWER)) / POWER + _price(task, told))


@dataclass(frozen=True, eq=False)
class Found:
    """The best point of the search's box; whether the search was cut short by the keyboard."""

    solution: Solution
    is_interrupted: bool


def errors_of(task: Task, told: Told) -> Array:
    """What the criterion looks at, for each ship; NaN for a lost one."""
    if task.criterion is Criterion.WORST:
        return told.relative.max(axis=1)
    return np.sqrt(np.mean(told.relative**2, axis=1))


def search(yardstick: Yardstick, seed: int, progress: Callable[[str], None], generations: int = GENERATIONS) -> Found:
    """Random sequences, orders of the best exchanged one by one, then an evolution strategy about what that gives.

    The strategy is that of Hansen 2016, by `cmaes`; exchange finds the ends that orders go to, and leaves the rest.

    Ctrl-C gives the best so far. The same seed gives the same bits, whatever the number of workers.
    """
    generator = np.random.default_rng(seed)
    best, value, evaluations, history = np.zeros(0), np.inf, 0, []
    interrupted = False
    try:
        points = _drawn(yardstick.bench.task, generator)
        costs = np.array(mapped(yardstick.cost, points))
        best, value, evaluations = points[int(np.argmin(costs))], float(costs.min()), len(points)
        history.append(value)
        progress(f"search: orders exchanged one by one, {_told(value)}")
        drawn = evaluations
        for step in exchanged(yardstick.cost, best, value, generator, EXCHANGES * generations):
            best, value, evaluations = step[0], step[1], drawn + step[2]
        history.append(value)
        box = Box(np.full(len(best), LOWEST), np.full(len(best), HIGHEST))
        settings = AdaptationSettings(iterations=generations, step=STEP / (HIGHEST - LOWEST), resampling=5)
        strategy = CovarianceAdaptation(box, generator, settings, best)
        while not strategy.done:
            asked = strategy.ask()
            strategy.tell(np.array(mapped(yardstick.cost, list(asked))))
            evaluations += len(asked)
            point, cost = strategy.best
            if cost < value:
                best, value = point, cost
            history.append(value)
            if len(history) % 10 == 0:
                progress(f"search: {len(history)} of {generations} generations, {_told(value)}")
    except KeyboardInterrupt:
        if not len(best):
            raise
        interrupted = True
    status = Status.EXHAUSTED
    return Found(Solution(best, value, status, evaluations, tuple(history), seed), interrupted)


def _told(value: float) -> str:
    """A cost in words."""
    return f"error {np.exp(value):.3f} of the standard" if value < np.log(LOST) else "the limits are not kept yet"


def _price(task: Task, told: Told) -> float:
    """What it costs that ships which the limits bind leave them."""
    over = excess(task, told, MARGIN)
    return EXCESS * float(over.max() if task.limits.for_every_ship else over[0])


def _drawn(task: Task, generator: np.random.Generator) -> list[Array]:
    """Sequences that jump between two ends, of several switching times and amplitudes."""
    points = []
    for _ in range(DRAWN_STARTS):
        pieces = []
        for count in counts(task):
            times = int(generator.integers(1, 4))
            signs = np.repeat(generator.choice([-1.0, 1.0], size=count // times + 1), times)[:count]
            pieces.append(0.5 + 0.45 * generator.choice([0.25, 0.5, 0.75, 1.0]) * signs)
        points.append(np.concatenate(pieces))
    return points


def coarse(task: Task) -> float:
    """The step of the search [s]: a whole number of samples, an eighth of the shortest hold at most."""
    samples = max(1, int(task.shortest_hold * task.rate / 8.0 + 1e-9))
    while samples > 1 and not _fits(task, samples):
        samples -= 1
    return samples / task.rate


def _fits(task: Task, samples: int) -> bool:
    """Whether trial is a whole number of such steps."""
    total = round(task.duration * task.rate)
    return total % samples == 0


def finer(bench: Bench) -> Bench:
    """The same ships at the sensors' rate."""
    return replace(bench, dt=1.0 / bench.task.rate)
