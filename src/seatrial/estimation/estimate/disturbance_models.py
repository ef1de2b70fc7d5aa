"""Candidates for what is between a ship and its records: gusts with a memory, waves, wandering sensors.

Gusts, biases and lags are a model with more states; waves are motion that the filter adds to what sensors show.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.augment import (
    bias_name,
    biased_name,
    force_peaks,
    gust_name,
    lagged_name,
    wave_names,
    with_biases,
    with_gusts,
    with_lags,
    with_wave_forces,
)
from seatrial.core.equations.model import channel_of
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.information.frequency_response import SpectralPeak
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.physics.sensors.wave_motion import RATES, WaveMotion, motion_of

POSITIONS, VELOCITIES = ("x0", "y0"), ("u", "v")
GUSTS = "first-order Markov"
"""Name of gusts with a memory."""
SEAS = {1: "waves", 2: "sea and swell"}
"""Name of waves with so many peaks, which force the craft or move what its sensors show."""
MOST_PEAKS = len(SEAS)
# memories of gusts from which the search starts: from so many samples to a tenth of the longest run, so many values
_FEWEST_MEMORY_SAMPLES, _LONGEST_MEMORY_SHARE, _MEMORIES = 5.0, 0.1, 4
# memory that a search may reach, samples: what forgets faster is white noise, and steps of a sample do not follow it
_SHORTEST_MEMORY_SAMPLES = 0.5
FEWEST_SAMPLES = round(_FEWEST_MEMORY_SAMPLES / _LONGEST_MEMORY_SHARE)
"""Samples of the longest run from which on a disturbance can be estimated: in fewer no memory is tried."""

# intensities from which the search starts, over that of white noise with the same effect; gusts are the larger
_INTENSITY_FACTORS = (0.5, 1.5, 5.0, 15.0)
# intensity where white noise was none, over that which would explain all motion of its state; smallest size, SI
_LEAST_SHARE, _SMALLEST = 0.01, 1e-12
# relative damping of waves from which the search starts: swell, a sea's spectrum (Fossen 2011, section 8.2.6)
_WAVE_DAMPINGS = (0.03, 0.1)
# variance of what waves force over what residuals show of it, where the search starts; chosen
_FORCE_SHARES, _LEAST_FORCE = (0.3, 1.0), 1e-4  # the latter of a state that shows none, over that which shows most
# channels that show a state's motion integrated
_SHOWN_BY = {"r": ("psi",), "u": ("x0", "y0"), "v": ("x0", "y0"), "p": ("phi",), "q": ("theta",), "w": ("z",)}
# lag of a log from which the search starts, samples, ours
_LAG_SAMPLES = 2.0
# memory of a sensor's bias from which the search starts [s]; chosen: errors of receivers wander over minutes
_BIAS_MEMORY = 60.0
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

    @cached_property
    def cost(self) -> float:
        """Where the search begins: minus the log-likelihood, up to a constant that all candidates share."""
        return self.problem.cost(self.point, _NO_INITIAL_STATES)


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


def gusts(base: ProcessNoise, driven: Sequence[str], whites: Array) -> DisturbanceModel:
    """A first-order Markov acceleration on driven states, each with its own memory and intensity.

    base: what else is between craft and record, white noise on states taken away; whites: intensities of white noise
    about which those of gusts are tried, (driven,).
    """
    runs = base.output_error
    memories = np.geomspace(_FEWEST_MEMORY_SAMPLES * runs.data.dt, _LONGEST_MEMORY_SHARE * longest_run(runs), _MEMORIES)
    return likeliest_start([_gusts(base, driven, float(m), f * whites) for m in memories for f in _INTENSITY_FACTORS])


def wave_forces(base: ProcessNoise, driven: Sequence[str], peaks: Sequence[SpectralPeak]) -> list[DisturbanceModel]:
    """Accelerations of driven states by waves at one more peak than `base` has: one start, none without peaks.

    base: what else is between craft and record, white noise on states taken away; peaks: where it may lie.
    """
    points = [
        _wave_forces(base, driven, peak, damping, share)
        for peak in peaks for damping in _WAVE_DAMPINGS for share in _FORCE_SHARES
    ]  # fmt: skip
    return [likeliest_start(points)] if points else []


def _wave_forces(
    base: ProcessNoise, driven: Sequence[str], peak: SpectralPeak, damping: float, share: float
) -> DisturbanceModel:
    omega, number = peak.frequency, force_peaks(base.problem.runs.model) + 1
    model = with_wave_forces(base.problem.runs.model, driven, number, omega, damping)
    shown = dict(zip(map(channel_of, base.problem.runs.observables), peak.variance, strict=True))
    speeds = [max([shown.get(s, 0.0), *(omega**2 * shown.get(c, 0.0) for c in _SHOWN_BY.get(s, ()))]) for s in driven]
    least = max(_LEAST_FORCE * max(speeds), _SMALLEST)
    variance, squared = {}, {}
    for state, speed in zip(driven, speeds, strict=True):
        (xi, eta), size = wave_names(state, number), share * max(speed, least)
        variance |= {xi: size, eta: omega**2 * size}
        squared[eta] = 4.0 * damping * omega**3 * size  # of these stationary variances
    return _augmented(base, _NewStates(model, _kept_intensities(base) | squared, (omega, damping), variance))


def _kept_intensities(base: ProcessNoise) -> dict[str, float]:
    """Squared intensities of what has states of its own: white noise on the craft's states is taken away."""
    return {s: v for s, v in _squared_intensities(base).items() if s not in base.output_error.model.states}


def wave_motion(base: ProcessNoise, peaks: Sequence[SpectralPeak]) -> list[DisturbanceModel]:
    """Waves on the sensors at one more peak than `base` has, on the channels that show it: one start, none without.

    peaks: where it may lie.
    """
    points = [_wave_motion(base, _unfolded(base, peak), damping) for peak in peaks for damping in _WAVE_DAMPINGS]
    return [likeliest_start(points)] if points else []


def _unfolded(base: ProcessNoise, peak: SpectralPeak) -> SpectralPeak:
    """The peak at the frequency that angles and rates agree with: samples show those beyond half their own folded."""
    outputs = base.output_error.data.outputs
    variance = dict(zip(outputs, peak.variance.tolist(), strict=True))
    ratios = [variance[rate] / variance[angle] for angle, rate in RATES.items()
              if variance.get(angle, 0.0) > 0.0 and variance.get(rate, 0.0) > 0.0]  # fmt: skip
    if not ratios:
        return peak
    folded = 2.0 * np.pi / base.output_error.data.dt - peak.frequency
    shown = 0.5 * np.log(np.mean(ratios))  # a rate's variance over its angle's is omega^2
    is_folded = abs(np.log(folded) - shown) < abs(np.log(peak.frequency) - shown)
    return replace(peak, frequency=folded) if is_folded else peak


def _wave_motion(base: ProcessNoise, peak: SpectralPeak, damping: float) -> DisturbanceModel:
    old, point = base.problem, base.optimum.solution.point.copy()
    channels = [channel_of(o) for o in old.runs.observables]
    sizes = dict.fromkeys((*old.waves.motions, *_motions(channels, peak)), 0.0)
    for motion in sizes:
        shown = [v / (peak.frequency**2 if c != motion else 1.0) for c, v in zip(channels, peak.variance, strict=True)
                 if motion_of(c) == motion and v > 0.0]  # fmt: skip
        sizes[motion] = float(max(shown, default=0.0))
    waves = WaveMotion(tuple(sizes), old.waves.peaks + 1)
    earlier, first = old.wave_unknowns(point), old.runs.size + len(old.process)
    shapes, known = (
        earlier[: 2 * old.waves.peaks],
        earlier[2 * old.waves.peaks :].reshape(old.waves.peaks, len(old.waves.motions)),
    )
    widened = np.pad(known, ((0, 0), (0, len(sizes) - known.shape[1])))
    unknowns = np.concatenate([shapes, [peak.frequency, damping], widened.ravel(), list(sizes.values())])
    is_waved = np.array([sizes.get(motion_of(c), 0.0) > 0.0 for c in channels])
    deviations = np.where(is_waved, np.minimum(point[-len(channels) :], peak.floor), point[-len(channels) :])
    problem = replace(old, waves=waves, steps=None)
    moved = np.concatenate([point[:first], unknowns, deviations])
    return _described(base, problem, np.clip(moved, problem.lower, problem.upper))


def with_waves_only(base: ProcessNoise, kept: Sequence[bool]) -> DisturbanceModel:
    """The same disturbance with some of its peaks on the sensors only, begun where `base` is.

    kept: of each peak whether it stays.
    """
    old, point = base.problem, base.optimum.solution.point
    unknowns, first, count = old.wave_unknowns(point), old.runs.size + len(old.process), old.waves.peaks
    shapes, sizes = unknowns[: 2 * count].reshape(count, 2), unknowns[2 * count :].reshape(count, -1)
    waves = replace(old.waves, peaks=sum(kept)) if any(kept) else WaveMotion()
    rows = np.flatnonzero(kept)
    moved = np.concatenate([
        point[:first], shapes[rows].ravel(), sizes[rows].ravel(), point[first + len(unknowns) :],
    ])  # fmt: skip
    return _described(base, replace(old, waves=waves, steps=None), moved)


def _motions(channels: Sequence[str], peak: SpectralPeak) -> list[str]:
    return [motion_of(c) for c, v in zip(channels, peak.variance, strict=True) if v > 0.0]


def _described(base: ProcessNoise, problem: PredictionError, point: Array, other: str = "") -> DisturbanceModel:
    """A candidate with its name and the count of its unknowns; other: what its states do not show."""
    states, process, model = base.output_error.model.states, problem.process, problem.runs.model
    parts = ["white"] if any(s in states for s in process) else []
    gusty = [s for s in states if gust_name(s) in process]
    parts += [f"{GUSTS} on {', '.join(gusty)}"] if gusty else []
    forces, motions = force_peaks(model), problem.waves.peaks
    forced = [s for s in states if forces and wave_names(s, 1)[1] in process]
    parts += [f"{SEAS[forces]} forcing {', '.join(forced)}"] if forced else []
    parts += [f"{SEAS[motions]} on the sensors"] if motions else []
    parts += [other] if other else []
    constants = len(problem.runs.free) - len(base.output_error.free)
    return DisturbanceModel(problem, point, " and ".join(parts), len(process) + constants + problem.waves.size)


def sensor_models(base: ProcessNoise) -> Iterator[DisturbanceModel]:
    """White noise on the states, and wandering biases of positions or lags of velocities where these are compared.

    Force points know the caller's parameters only, so beside them no time constant is added.
    """
    states, outputs = base.output_error.model.states, base.output_error.data.outputs
    if base.output_error.extra_terms:
        return
    positions = tuple(c for c in POSITIONS if c in outputs and c in states)
    if positions:
        yield _biases(base, positions)
    velocities = tuple(c for c in VELOCITIES if c in outputs and c in states)
    if velocities:
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
            f"'{longest.name}', has {len(longest)}; record longer, or write method = \"output-error\" under [estimate]"
        )


def longest_run(problem: OutputError) -> float:
    """Duration of the longest run [s]."""
    return float(np.max(np.diff(problem.data.offsets))) * problem.data.dt


def white_intensities(base: ProcessNoise) -> Array:
    """Intensities of the white noise that `base` has, or where it has none a hundredth of the state's own motion."""
    estimated = base.problem.split(base.optimum.solution.point)[1]
    scale = base.state_spread / np.sqrt(longest_run(base.output_error))
    return np.maximum(estimated, _LEAST_SHARE * scale)


def likeliest_start(points: list[DisturbanceModel]) -> DisturbanceModel:
    """Return the candidate whose search begins at the likeliest point."""
    return min(points, key=lambda one: one.cost)


def _gusts(base: ProcessNoise, driven: Sequence[str], memory: float, intensities: Array) -> DisturbanceModel:
    """White noise on the states becomes white noise on accelerations of the same effect over longer times."""
    shortest = _SHORTEST_MEMORY_SAMPLES * base.output_error.data.dt
    model = with_gusts(base.problem.runs.model, dict.fromkeys(driven, memory), shortest)
    # stationary variance of a Gauss-Markov process whose integral spreads like white noise: q^2 / (2 memory)
    variance = {
        gust_name(s): _SPREAD_FACTOR**2 * float(q) ** 2 / (2.0 * memory)
        for s, q in zip(driven, intensities, strict=True)
    }
    squared = {gust_name(s): float(q / memory) ** 2 for s, q in zip(driven, intensities, strict=True)}
    return _augmented(base, _NewStates(model, _kept_intensities(base) | squared, (memory,) * len(driven), variance))


def _biases(base: ProcessNoise, channels: tuple[str, ...]) -> DisturbanceModel:
    """Biases that are at first as large as all noise of their channels."""
    model = with_biases(base.output_error.model, channels, _BIAS_MEMORY)
    variance = {bias_name(c): base.measurement_noise[c] ** 2 for c in channels}
    # stationary variance of a Gauss-Markov process: q^2 memory / 2
    squared = {**_squared_intensities(base), **{s: 2.0 * v / _BIAS_MEMORY for s, v in variance.items()}}
    new = _NewStates(model, squared, (_BIAS_MEMORY,), variance, {}, {c: biased_name(c) for c in channels})
    return _augmented(base, new, f"wandering biases of {', '.join(channels)}")


def _lags(base: ProcessNoise, channels: tuple[str, ...], lag: float) -> DisturbanceModel:
    """The channels follow their states late; they begin where the states begin."""
    model = with_lags(base.output_error.model, channels, lag)
    index = base.output_error.model.states.index
    variance = {lagged_name(c): float(base.problem.start_variance[:, index(c)].max()) for c in channels}
    mean = {lagged_name(c): base.problem.start[:, index(c)] for c in channels}
    squared = _squared_intensities(base)
    new = _NewStates(model, squared, (lag,), variance, mean, {c: lagged_name(c) for c in channels})
    return _augmented(base, new, f"lags of {', '.join(channels)}")


def _squared_intensities(base: ProcessNoise) -> dict[str, float]:
    squared = base.problem.split(base.optimum.solution.point)[1] ** 2
    return dict(zip(base.problem.process, map(float, squared), strict=True))


def _augmented(base: ProcessNoise, new: _NewStates, other: str = "") -> DisturbanceModel:
    old, runs = base.problem, base.problem.runs
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
    point, free, ny = base.optimum.solution.point, len(runs.free), len(data.outputs)
    own, waves, deviations = point[: runs.size], old.wave_unknowns(point), point[-ny:]
    point = np.concatenate([own[:free], new.constants, own[free:], list(new.squared.values()), waves, deviations])
    return _described(base, problem, np.clip(point, problem.lower, problem.upper), other)
