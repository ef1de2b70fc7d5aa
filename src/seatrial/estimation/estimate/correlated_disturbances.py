"""Where white process noise leaves coloured innovations: gusts with a memory, biases, lags, chosen by likelihood."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaincinv

from seatrial.core.equations import Model
from seatrial.core.equations.augment import (
    bias_name,
    biased_name,
    gust_name,
    lagged_name,
    with_biases,
    with_gusts,
    with_lags,
)
from seatrial.core.values import Array, ProgressReporter
from seatrial.estimation.estimate.likelihood_ratio import CONFIDENCE_LEVEL, likelihood_ratio_test
from seatrial.estimation.estimate.process_noise import ProcessNoise, search_prediction_error
from seatrial.estimation.problem.prediction_error import PredictionError

POSITIONS, VELOCITIES = ("x0", "y0"), ("u", "v")
# memories of gusts from which the search starts, samples, ours
_MEMORY_SAMPLES = (10.0, 100.0)
# lag of a log from which the search starts, samples, ours
_LAG_SAMPLES = 2.0
# s in which a bias changes by the noise of its channel, where the search starts, ours
_DRIFT_SECONDS = 60.0
# initial standard deviation of a gust over its stationary one, ours
_SPREAD_FACTOR = 3.0


@dataclass(frozen=True, eq=False)
class DisturbanceAlternative:
    """An augmented model as a prediction-error problem, where its search begins, and what it is in words."""

    problem: PredictionError
    point: Array
    description: str
    unknown_count: int


def select_disturbance_model(
    process_noise: ProcessNoise, *, evaluations: int = 60, report_progress: ProgressReporter | None = None
) -> ProcessNoise:
    """The best of `found` and its alternatives: gusts with a memory, GNSS biases, lags of the log.

    Each has its own unknowns estimated; the likelihood decides, less one for every unknown more
    (Akaike 1974), and an alternative must gain more than chance does once in a thousand cases. The coefficients,
    intervals and intensities of the result are those of the caller's model; `colours` says what was added.
    `found` itself comes back where its coefficients were not searched: nothing can make such innovations white.
    """
    if np.isnan(process_noise.newton_decrement):
        return process_noise
    report = report_progress or (lambda _: None)
    best, score = process_noise, 2.0 * process_noise.optimum.normal.cost
    for one in alternatives(process_noise):
        report(f"process noise: {one.description}")
        if not np.isfinite(one.problem.cost(one.point, np.zeros((0, 0)))):
            continue
        exact, optimum, slope = search_prediction_error(one.problem, one.point, evaluations, report)
        gained = 2.0 * (process_noise.optimum.normal.cost - optimum.normal.cost)
        without = process_noise.optimum.normal.cost + 0.5 * process_noise.test.likelihood_ratio
        verdict = likelihood_ratio_test(exact, optimum.solution.point, optimum.normal.cost, without, None)
        verdict = replace(verdict, inflation_without=process_noise.test.inflation_without)
        made = ProcessNoise(exact, optimum, slope, verdict, process_noise.output_error, one.description)
        criterion = 2.0 * (optimum.normal.cost + one.unknown_count)
        if gained > 2.0 * gammaincinv(0.5 * one.unknown_count, CONFIDENCE_LEVEL) and criterion < score:
            best, score = made, criterion
    return best


def alternatives(process_noise: ProcessNoise) -> Iterator[DisturbanceAlternative]:
    """Every augmented problem that the model and the compared channels admit.

    Force points know the caller's parameters only, so beside them no time constant is added.
    """
    states, outputs = process_noise.output_error.model.states, process_noise.output_error.data.outputs
    driven = tuple(s for s in process_noise.problem.process if process_noise.process_intensities.get(s, 0.0) > 0.0)
    if driven and not process_noise.output_error.extra_terms:
        for multiple in _MEMORY_SAMPLES:
            yield _gusts(process_noise, driven, multiple * process_noise.output_error.data.dt)
    positions = tuple(c for c in POSITIONS if c in outputs and c in states)
    if positions:
        yield _biases(process_noise, positions)
    velocities = tuple(c for c in VELOCITIES if c in outputs and c in states)
    if velocities and not process_noise.output_error.extra_terms:
        yield _lags(process_noise, velocities, _LAG_SAMPLES * process_noise.output_error.data.dt)


def _gusts(process_noise: ProcessNoise, driven: tuple[str, ...], memory: float) -> DisturbanceAlternative:
    """White noise on the states becomes white noise on accelerations of the same effect over longer times."""
    model = with_gusts(process_noise.output_error.model, driven, memory)
    squared = np.array([process_noise.process_intensities[s] ** 2 for s in driven])
    # stationary variance of a Gauss-Markov process whose integral spreads like white noise: q^2 / (2 memory)
    spread = {gust_name(s): _SPREAD_FACTOR**2 * float(q) / (2.0 * memory) for s, q in zip(driven, squared, strict=True)}
    words = f"gusts with a memory on {', '.join(driven)}"
    return _augmented_alternative(
        process_noise, model, tuple(map(gust_name, driven)), squared / memory**2, spread, {}, {}, [memory], words, 1
    )


def _biases(process_noise: ProcessNoise, channels: tuple[str, ...]) -> DisturbanceAlternative:
    """A bias wanders by the channel's own noise in a minute."""
    model = with_biases(process_noise.output_error.model, channels)
    variance = {bias_name(c): process_noise.measurement_noise[c] ** 2 for c in channels}
    process = (*process_noise.problem.process, *variance)
    squared = [*_squared_intensities(process_noise), *(v / _DRIFT_SECONDS for v in variance.values())]
    names = {c: biased_name(c) for c in channels}
    words = f"wandering biases of {', '.join(channels)}"
    return _augmented_alternative(
        process_noise, model, process, np.array(squared), variance, {}, names, [], words, len(channels)
    )


def _lags(process_noise: ProcessNoise, channels: tuple[str, ...], lag: float) -> DisturbanceAlternative:
    """The channels follow their states late; they begin where the states begin."""
    model = with_lags(process_noise.output_error.model, channels, lag)
    at = process_noise.output_error.model.states.index
    spread = {lagged_name(c): float(process_noise.problem.start_variance[:, at(c)].max()) for c in channels}
    means = {lagged_name(c): process_noise.problem.start[:, at(c)] for c in channels}
    names = {c: lagged_name(c) for c in channels}
    words = f"lags of {', '.join(channels)}"
    return _augmented_alternative(
        process_noise, model, process_noise.problem.process, _squared_intensities(process_noise), spread, means,
        names, [lag], words, 1,
    )  # fmt: skip


def _squared_intensities(process_noise: ProcessNoise) -> Array:
    return process_noise.problem.split(process_noise.optimum.solution.point)[1] ** 2


def _augmented_alternative(
    process_noise: ProcessNoise,
    model: Model,
    process: tuple[str, ...],
    squared_intensities: Array,
    variance: dict[str, float],
    mean: dict[str, Array],
    renamed: dict[str, str],
    time_constants: list[float],
    description: str,
    unknown_count: int,
) -> DisturbanceAlternative:
    """variance, mean: of the new states at the start (mean 0 where none is given).

    renamed: channel -> observable that it is compared with; constants: values of the new parameters.
    """
    old, runs = process_noise.problem, process_noise.output_error
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
    own, free, ny = process_noise.common_parameters, len(runs.free), len(data.outputs)
    deviations = process_noise.optimum.solution.point[-ny:]
    point = np.concatenate([own[:free], time_constants, own[free:], squared_intensities, deviations])
    return DisturbanceAlternative(problem, np.clip(point, problem.lower, problem.upper), description, unknown_count)
