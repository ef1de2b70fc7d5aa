"""Where white process noise leaves coloured innovations: gusts with a memory, biases, lags, chosen by likelihood."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from seatrial.core.equations import Model
from seatrial.core.equations.augment import (
    bias_of,
    biased,
    gust_of,
    lagged,
    with_biases,
    with_gusts,
    with_lags,
)
from seatrial.core.values import Array, Progress
from seatrial.estimation.estimate.gate import LEVEL, gate
from seatrial.estimation.estimate.process_noise import ProcessNoise, searched
from seatrial.estimation.problem.prediction_error import PredictionError

POSITIONS, VELOCITIES = ("x0", "y0"), ("u", "v")
_MEMORIES = (10.0, 100.0)
_LAG = 2.0
_DRIFT_S = 60.0
_WIDE = 3.0


@dataclass(frozen=True, eq=False)
class Alternative:
    """An augmented model as a prediction-error problem, where its search begins, and what it is in words."""

    problem: PredictionError
    point: Array
    words: str
    unknowns: int


def coloured(found: ProcessNoise, *, evaluations: int = 60, progress: Progress | None = None) -> ProcessNoise:
    """The best of `found` and its alternatives: gusts with a memory, GNSS biases, lags of the log.

    Each has its own unknowns estimated; the likelihood decides, less one for every unknown more
    (Akaike 1974), and an alternative must gain more than chance does once in a thousand cases. The coefficients,
    intervals and intensities of the result are those of the caller's model; `colours` says what was added.
    `found` itself comes back where its coefficients were not searched: nothing can make such innovations white.
    """
    if np.isnan(found.slope):
        return found
    tell = progress or (lambda _: None)
    best, score = found, 2.0 * found.optimum.normal.cost
    for one in alternatives(found):
        tell(f"process noise: {one.words}")
        if not np.isfinite(one.problem.cost(one.point, np.zeros((0, 0)))):
            continue
        exact, optimum, slope = searched(one.problem, one.point, evaluations, tell)
        gained = 2.0 * (found.optimum.normal.cost - optimum.normal.cost)
        without = found.optimum.normal.cost + 0.5 * found.gate.ratio
        verdict = gate(exact, optimum.solution.point, optimum.normal.cost, without, None)
        verdict = replace(verdict, inflation_without=found.gate.inflation_without)
        made = ProcessNoise(exact, optimum, slope, verdict, found.runs, one.words)
        criterion = 2.0 * (optimum.normal.cost + one.unknowns)
        if gained > stats.chi2.ppf(LEVEL, one.unknowns) and criterion < score:
            best, score = made, criterion
    return best


def alternatives(found: ProcessNoise) -> Iterator[Alternative]:
    """Every augmented problem that the model and the compared channels admit.

    Force points know the caller's parameters only, so beside them no time constant is added.
    """
    states, outputs = found.runs.model.states, found.runs.data.outputs
    driven = tuple(s for s in found.problem.process if found.process.get(s, 0.0) > 0.0)
    if driven and not found.runs.others:
        for multiple in _MEMORIES:
            yield _gusts(found, driven, multiple * found.runs.data.dt)
    positions = tuple(c for c in POSITIONS if c in outputs and c in states)
    if positions:
        yield _biases(found, positions)
    velocities = tuple(c for c in VELOCITIES if c in outputs and c in states)
    if velocities and not found.runs.others:
        yield _lags(found, velocities, _LAG * found.runs.data.dt)


def _gusts(found: ProcessNoise, driven: tuple[str, ...], memory: float) -> Alternative:
    """White noise on the states becomes white noise on accelerations of the same effect over longer times."""
    model = with_gusts(found.runs.model, driven, memory)
    squared = np.array([found.process[s] ** 2 for s in driven])
    # stationary variance of a Gauss-Markov process whose integral spreads like white noise: q^2 / (2 memory)
    spread = {gust_of(s): _WIDE**2 * float(q) / (2.0 * memory) for s, q in zip(driven, squared, strict=True)}
    words = f"gusts with a memory on {', '.join(driven)}"
    return _augmented(
        found, model, tuple(map(gust_of, driven)), squared / memory**2, spread, {}, {}, [memory], words, 1
    )


def _biases(found: ProcessNoise, channels: tuple[str, ...]) -> Alternative:
    """A bias wanders by the channel's own noise in a minute."""
    model = with_biases(found.runs.model, channels)
    variance = {bias_of(c): found.measurement[c] ** 2 for c in channels}
    process = (*found.problem.process, *variance)
    squared = [*_squared(found), *(v / _DRIFT_S for v in variance.values())]
    names = {c: biased(c) for c in channels}
    words = f"wandering biases of {', '.join(channels)}"
    return _augmented(found, model, process, np.array(squared), variance, {}, names, [], words, len(channels))


def _lags(found: ProcessNoise, channels: tuple[str, ...], lag: float) -> Alternative:
    """The channels follow their states late; they begin where the states begin."""
    model = with_lags(found.runs.model, channels, lag)
    at = found.runs.model.states.index
    spread = {lagged(c): float(found.problem.start_variance[:, at(c)].max()) for c in channels}
    means = {lagged(c): found.problem.start[:, at(c)] for c in channels}
    names = {c: lagged(c) for c in channels}
    words = f"lags of {', '.join(channels)}"
    return _augmented(found, model, found.problem.process, _squared(found), spread, means, names, [lag], words, 1)


def _squared(found: ProcessNoise) -> Array:
    return found.problem.split(found.optimum.solution.point)[1] ** 2


def _augmented(
    found: ProcessNoise,
    model: Model,
    process: tuple[str, ...],
    squared: Array,
    variance: dict[str, float],
    mean: dict[str, Array],
    renamed: dict[str, str],
    constants: list[float],
    words: str,
    unknowns: int,
) -> Alternative:
    """variance, mean: of the new states at the start (mean 0 where none is given).

    renamed: channel -> observable that it is compared with; constants: values of the new parameters.
    """
    old, runs = found.problem, found.runs
    data = replace(runs.data, outputs=tuple(renamed.get(o, o) for o in runs.data.outputs))
    means = [mean.get(s, np.zeros(len(old.start))) for s in variance]
    problem = replace(
        old,
        runs=replace(runs, model=model, data=data),
        process=process,
        start=np.column_stack([old.start, *means]),
        start_variance=np.hstack([old.start_variance, np.tile(list(variance.values()), (len(old.start), 1))]),
        steps=None,
    )
    own, free, ny = found.shared, len(runs.free), len(data.outputs)
    deviations = found.optimum.solution.point[-ny:]
    point = np.concatenate([own[:free], constants, own[free:], squared, deviations])
    return Alternative(problem, np.clip(point, problem.lower, problem.upper), words, unknowns)
