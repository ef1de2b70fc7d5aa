"""Candidates for what disturbs a ship: gusts with a memory, waves, wandering sensors; each a model with more states."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.augment import (
    bias_name,
    biased_name,
    gust_name,
    lagged_name,
    memory_name,
    wave_name,
    wave_rate_name,
    with_biases,
    with_gusts,
    with_lags,
    with_waves,
)
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import PredictionError

POSITIONS, VELOCITIES = ("x0", "y0"), ("u", "v")
# memories of gusts from which the search starts: from so many samples to a tenth of the longest run, so many values
_FEWEST_MEMORY_SAMPLES, _LONGEST_MEMORY_SHARE, _MEMORIES = 5.0, 0.1, 4
FEWEST_SAMPLES = round(_FEWEST_MEMORY_SAMPLES / _LONGEST_MEMORY_SHARE)
"""Samples of the longest run from which on a disturbance can be estimated: in fewer no memory is tried."""

# intensities from which the search starts, over that of white noise with the same effect; gusts are the larger
_INTENSITY_FACTORS = (0.5, 1.5, 5.0, 15.0)
# intensity where white noise was none, over that which would explain all motion of its state; smallest size, SI
_LEAST_SHARE, _SMALLEST = 0.01, 1e-12
# peak frequencies of waves from which the search starts, over that of the innovations' spectrum
_FREQUENCY_FACTORS = (0.7, 1.0, 1.4)
# relative damping of waves from which the search starts (a sea's spectrum; Fossen 2011, section 8.2.6)
_WAVE_DAMPING = 0.1
# lag of a log from which the search starts, samples, ours
_LAG_SAMPLES = 2.0
# s in which a bias changes by the noise of its channel, where the search starts, ours
_DRIFT_SECONDS = 60.0
# initial standard deviation of a gust over its stationary one, ours
_SPREAD_FACTOR = 3.0
_NO_INITIAL_STATES = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class DisturbanceModel:
    """An augmented model as a prediction-error problem, and where its search begins.

    Attributes:
        name: in words; unknown_count: unknowns that describe the disturbance, beyond coefficients and sensor noise.
    """

    problem: PredictionError
    point: Array
    name: str
    unknown_count: int


@dataclass(frozen=True, eq=False)
class _NewStates:
    """States and parameters beyond the caller's.

    Attributes:
        squared: new driven state -> squared intensity at the start; constants: values of the new parameters.
        variance, mean: of the new states at the start of a run (mean 0 where none is given).
        renamed: channel -> observable that it is compared with.
    """

    model: Model
    squared: Mapping[str, float]
    constants: tuple[float, ...] = ()
    variance: Mapping[str, float] = field(default_factory=dict)
    mean: Mapping[str, Array] = field(default_factory=dict)
    renamed: Mapping[str, str] = field(default_factory=dict)


def gusts(base: ProcessNoise) -> DisturbanceModel:
    """A first-order Markov acceleration on every driven state, each with its own memory and intensity."""
    runs = base.output_error
    memories = np.geomspace(_FEWEST_MEMORY_SAMPLES * runs.data.dt, _LONGEST_MEMORY_SHARE * longest_run(runs), _MEMORIES)
    whites = white_intensities(base)
    points = [_gusts(base, float(m), f * whites) for m in memories for f in _INTENSITY_FACTORS]
    return _likeliest(points)


def waves(base: ProcessNoise, gusty: ProcessNoise, frequency: float) -> DisturbanceModel:
    """Gusts, and a second-order acceleration with a common peak on every driven state.

    gusty: the optimum with gusts alone; frequency: peak of its innovations' spectrum [rad/s].
    """
    driven, added = base.problem.process, gusty.added_parameters
    memory = np.array([added[memory_name(s)] for s in driven])
    squared = gusty.problem.split(gusty.optimum.solution.point)[1] ** 2
    points = [
        _waves(base, gusty, memory, squared, f * frequency, factor)
        for f in _FREQUENCY_FACTORS
        for factor in _INTENSITY_FACTORS
    ]
    return _likeliest(points)


def sensor_models(base: ProcessNoise) -> Iterator[DisturbanceModel]:
    """White noise on the states, and wandering biases of positions or lags of velocities where these are compared.

    Force points know the caller's parameters only, so beside them no time constant is added.
    """
    states, outputs = base.output_error.model.states, base.output_error.data.outputs
    positions = tuple(c for c in POSITIONS if c in outputs and c in states)
    if positions:
        yield _biases(base, positions)
    velocities = tuple(c for c in VELOCITIES if c in outputs and c in states)
    if velocities and not base.output_error.extra_terms:
        yield _lags(base, velocities, _LAG_SAMPLES * base.output_error.data.dt)


def refuse_short_runs(records: Sequence[Record]) -> None:
    """Refuse runs too short for any disturbance model.

    Raises:
        InputError: how many samples the longest run has, how many are needed, and what to do.
    """
    longest = max(records, key=len)
    if len(longest) < FEWEST_SAMPLES:
        raise InputError(
            f"a disturbance model needs a run of at least {FEWEST_SAMPLES} samples, and the longest one, "
            f"'{longest.name}', has {len(longest)}: the disturbance's memory is sought between "
            f"{_FEWEST_MEMORY_SAMPLES:.0f} samples and a tenth of the run; record longer, or write "
            'method = "output-error" under [estimate]'
        )


def longest_run(problem: OutputError) -> float:
    """Duration of the longest run [s]."""
    return float(np.max(np.diff(problem.data.offsets))) * problem.data.dt


def white_intensities(base: ProcessNoise) -> Array:
    """Intensities of the white noise that `base` has, or where it has none a hundredth of the state's own motion."""
    estimated = base.problem.split(base.optimum.solution.point)[1]
    scale = base.state_spread / np.sqrt(longest_run(base.output_error))
    return np.maximum(estimated, _LEAST_SHARE * scale)


def _likeliest(points: list[DisturbanceModel]) -> DisturbanceModel:
    return min(points, key=lambda one: one.problem.cost(one.point, _NO_INITIAL_STATES))


def _gusts(base: ProcessNoise, memory: float, intensities: Array) -> DisturbanceModel:
    """White noise on the states becomes white noise on accelerations of the same effect over longer times."""
    driven = base.problem.process
    model = with_gusts(base.output_error.model, dict.fromkeys(driven, memory))
    # stationary variance of a Gauss-Markov process whose integral spreads like white noise: q^2 / (2 memory)
    variance = {
        gust_name(s): _SPREAD_FACTOR**2 * float(q) ** 2 / (2.0 * memory)
        for s, q in zip(driven, intensities, strict=True)
    }
    squared = {gust_name(s): float(q / memory) ** 2 for s, q in zip(driven, intensities, strict=True)}
    new = _NewStates(model, squared, (memory,) * len(driven), variance)
    return _augmented(base, new, f"first-order Markov on {', '.join(driven)}", 2 * len(driven))


def _waves(
    base: ProcessNoise, gusty: ProcessNoise, memory: Array, squared: Array, frequency: float, factor: float
) -> DisturbanceModel:
    driven = base.problem.process
    held = dict(zip(driven, map(float, memory), strict=True))
    model = with_waves(with_gusts(base.output_error.model, held), driven, frequency, _WAVE_DAMPING)
    at_start = gusty.problem.start_variance[0, len(base.output_error.model.states) :]
    variance = dict(zip(map(gust_name, driven), map(float, at_start), strict=True))
    intensities = dict(zip(map(gust_name, driven), map(float, squared), strict=True))
    for state, spread in zip(driven, map(float, np.sqrt(0.5 * squared * memory)), strict=True):
        size = max(factor * spread, _SMALLEST)
        variance |= {wave_name(state): size**2, wave_rate_name(state): (size * frequency) ** 2}
        # stationary variance of the second-order process: q^2 / (4 zeta omega^3)
        intensities[wave_rate_name(state)] = 4.0 * _WAVE_DAMPING * frequency**3 * size**2
    new = _NewStates(model, intensities, (*map(float, memory), frequency, _WAVE_DAMPING), variance)
    words = f"first-order Markov and waves on {', '.join(driven)}"
    begun = _augmented(base, new, words, 3 * len(driven) + 2)
    return replace(begun, point=_with_coefficients(begun, gusty))


def _with_coefficients(begun: DisturbanceModel, gusty: ProcessNoise) -> Array:
    """The point with coefficients, what sessions have of their own, and sensor noise of another optimum."""
    free, ny = len(gusty.output_error.free), len(gusty.output_error.data.outputs)
    point, size = begun.point.copy(), begun.problem.runs.size
    common = gusty.common_parameters
    point[:free] = common[:free]
    if len(common) > free:
        point[size - (len(common) - free) : size] = common[free:]
    point[-ny:] = gusty.optimum.solution.point[-ny:]
    return np.clip(point, begun.problem.lower, begun.problem.upper)


def _biases(base: ProcessNoise, channels: tuple[str, ...]) -> DisturbanceModel:
    """A bias wanders by the channel's own noise in a minute."""
    model = with_biases(base.output_error.model, channels)
    variance = {bias_name(c): base.measurement_noise[c] ** 2 for c in channels}
    squared = {**_squared_intensities(base), **{s: v / _DRIFT_SECONDS for s, v in variance.items()}}
    new = _NewStates(model, squared, (), variance, {}, {c: biased_name(c) for c in channels})
    return _augmented(base, new, f"white, and wandering biases of {', '.join(channels)}", len(squared))


def _lags(base: ProcessNoise, channels: tuple[str, ...], lag: float) -> DisturbanceModel:
    """The channels follow their states late; they begin where the states begin."""
    model = with_lags(base.output_error.model, channels, lag)
    index = base.output_error.model.states.index
    variance = {lagged_name(c): float(base.problem.start_variance[:, index(c)].max()) for c in channels}
    mean = {lagged_name(c): base.problem.start[:, index(c)] for c in channels}
    squared = _squared_intensities(base)
    new = _NewStates(model, squared, (lag,), variance, mean, {c: lagged_name(c) for c in channels})
    return _augmented(base, new, f"white, and lags of {', '.join(channels)}", len(squared) + 1)


def _squared_intensities(base: ProcessNoise) -> dict[str, float]:
    squared = base.problem.split(base.optimum.solution.point)[1] ** 2
    return dict(zip(base.problem.process, map(float, squared), strict=True))


def _augmented(base: ProcessNoise, new: _NewStates, name: str, unknown_count: int) -> DisturbanceModel:
    old, runs = base.problem, base.output_error
    data = replace(runs.data, outputs=tuple(new.renamed.get(o, o) for o in runs.data.outputs))
    means = [new.mean.get(s, np.zeros(len(old.start))) for s in new.variance]
    problem = replace(
        old,
        runs=replace(runs, model=new.model, data=data),
        process=tuple(new.squared),
        start=np.column_stack([old.start, *means]),
        start_variance=np.hstack([old.start_variance, np.tile(list(new.variance.values()), (len(old.start), 1))]),
        steps=None,
    )
    own, free, ny = base.common_parameters, len(runs.free), len(data.outputs)
    deviations = base.optimum.solution.point[-ny:]
    point = np.concatenate([own[:free], new.constants, own[free:], list(new.squared.values()), deviations])
    return DisturbanceModel(problem, np.clip(point, problem.lower, problem.upper), name, unknown_count)
