"""Spectra of inputs and outputs, frequency responses of records and model, and peaks of residuals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.results.prediction import Prediction
from seatrial.core.results.ship_motions import FrequencyResponse, Mask
from seatrial.core.values import NOTATION, Array, Finding, Index, Record, Severity
from seatrial.core.values.notation import channel_unit

# Spectra and cross-spectra of an input and of outputs by averaged periodograms, and what they leave uncertain.

SIGNIFICANCE = 0.05
"""Probability with which the true response lies outside its region."""

ComplexValues = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class CrossSpectra:
    """One-sided densities over frequency, per rad/s.

    Attributes:
        omega: rad/s, (n,); averages: number of independent averages at each, (n,).
        input: density of the input, (n,); outputs: of each output, (n, ny).
        cross: of input and outputs, conj(U) Y, (n, ny).
    """

    omega: Array
    averages: Array
    input: Array
    outputs: Array
    cross: ComplexValues

    @property
    def response(self) -> ComplexValues:
        """Outputs over input, H1 (Bendat & Piersol 2010, section 9.3): unbiased by noise of the outputs, (n, ny)."""
        return self.cross / self.input[:, None]

    @property
    def coherence(self) -> Array:
        """Share of each output's power that is linear in the input, (n, ny)."""
        power = self.input[:, None] * self.outputs
        return np.divide(np.abs(self.cross) ** 2, power, out=np.zeros_like(power), where=power > 0.0)

    @property
    def radius(self) -> Array:
        """Radius of the circle about the response that holds the true one with 95 %, (n, ny).

        |H - G|^2 <= 2 / (v - 2) F(2, v - 2) (1 - coherence) Syy / Suu with v = 2 averages degrees of freedom (Jenkins &
        Watts 1968, section 10.3); the quantile of F(2, m) is m / 2 (0.05^(-2/m) - 1).
        """
        degrees = np.maximum(self.averages - 1.0, 0.0)
        with np.errstate(divide="ignore", over="ignore"):
            factor = SIGNIFICANCE ** (-1.0 / degrees) - 1.0
        residual = np.maximum(1.0 - self.coherence, 0.0) * self.outputs / self.input[:, None]
        with np.errstate(invalid="ignore"):
            return np.where(np.isfinite(factor)[:, None], np.sqrt(factor[:, None] * residual), np.inf)

    def banded(self, bands: int) -> "CrossSpectra":
        """Return means over about so many bands of equal width on a logarithmic scale, each one frequency or more."""
        edges = np.geomspace(self.omega[0], self.omega[-1] * (1.0 + _MARGIN), bands + 1)
        band = np.digitize(self.omega, edges)
        first = np.flatnonzero(np.diff(band, prepend=-1))
        size = np.diff(first, append=len(band))

        def mean(values: Array) -> Array:
            shape = (-1, *(1 for _ in values.shape[1:]))
            return np.add.reduceat(values, first, axis=0) / size.reshape(shape)

        cross = mean(self.cross.real) + 1j * mean(self.cross.imag)
        averages = mean(self.averages) * size / _shared_variance(size)
        return CrossSpectra(mean(self.omega), averages, mean(self.input), mean(self.outputs), cross)


_MARGIN = 1e-9
"""Share by which the last band reaches beyond the last frequency, so that this lies in it."""


_NEIGHBOURS = (4.0 / 9.0, 1.0 / 36.0)
"""Correlation of densities one and two frequencies apart: squares of 2/3 and 1/6 (Hann; Harris 1978, Proc. IEEE 66)."""

_OVERLAPPING = 1.0 / 36.0
"""Correlation of densities of two segments of half overlap: square of 1/6 (Hann; Welch 1967)."""


def _shared_variance(size: Array) -> Array:
    """Variance of the mean of neighbouring frequencies of a Hann window over that of independent ones."""
    once, twice = (np.maximum(1.0 - lag / size, 0.0) * share for lag, share in enumerate(_NEIGHBOURS, 1))
    return 1.0 + 2.0 * (once + twice)


def cross_spectra(pieces: Sequence[tuple[Array, Array]], length: int, dt: float) -> CrossSpectra | None:
    """Return the densities of an input and outputs over all segments of `length` samples; None where there is none.

    Left out are the two lowest frequencies, from which the straight line taken off each segment takes power, and the
    highest.

    Args:
        pieces: input (rows,) and outputs (rows, ny) of each run; segments with NaN are left out.
        length: of a segment, samples; dt: s.
    """
    inner = slice(2, (length + 1) // 2)
    outputs = pieces[0][1].shape[1]
    power = np.zeros((length // 2 + 1, 1 + outputs))
    cross = np.zeros((length // 2 + 1, outputs), np.complex128)
    segments = []
    for u, y in pieces:
        transforms = _transforms(np.column_stack([u, y]), length)
        segments.append(len(transforms))
        for f in transforms:
            power += np.abs(f) ** 2
            cross += np.conj(f[:, :1]) * f[:, 1:]
    if not any(segments):
        return None
    scale = dt / (np.pi * sum(segments))
    omega = (2.0 * np.pi / (length * dt) * np.arange(length // 2 + 1)).astype(np.float64)
    averages = np.full(len(omega), sum(_independent(n) for n in segments if n))
    return CrossSpectra(
        omega[inner], averages[inner], scale * power[inner, 0], scale * power[inner, 1:], scale * cross[inner]
    )


def _transforms(values: Array, length: int) -> list[ComplexValues]:
    """Fourier transforms (frequencies, n) of segments that overlap by half, those with NaN left out.

    Each without its straight line, under Hann's window of mean square 1 / length (Welch 1967).
    """
    window = np.hanning(length + 1)[:-1]  # periodic
    window /= np.sqrt(np.sum(window**2))
    segments = (values[a : a + length] for a in range(0, len(values) - length + 1, length - length // 2))
    return [np.fft.rfft(window[:, None] * _without_line(w), axis=0) for w in segments if np.isfinite(w).all()]


def power_density(values: Array, length: int, dt: float) -> tuple[Array, Array]:
    """Return frequencies [rad/s] and one-sided densities per rad/s, (frequencies, n), of columns without NaN.

    length: samples of a segment, at most those of the columns; dt: s. Source: Welch 1967, IEEE Trans. AU-15, 70-73.
    """
    power = np.mean([np.abs(f) ** 2 for f in _transforms(values, length)], axis=0)
    omega = np.asarray(2.0 * np.pi * np.fft.rfftfreq(length, dt), dtype=np.float64)
    is_twice = (omega > 0.0) & (np.arange(len(omega)) < (length + 1) // 2)  # neither the mean nor Nyquist's frequency
    return omega, np.where(is_twice, 2.0, 1.0)[:, None] * dt / (2.0 * np.pi) * power


def _independent(segments: int) -> float:
    """Independent segments that so many of half overlap are worth (Welch 1967)."""
    return segments / (1.0 + 2.0 * (1.0 - 1.0 / segments) * _OVERLAPPING)


def _without_line(values: Array) -> Array:
    """Columns without their mean and slope (least squares)."""
    place = np.linspace(-1.0, 1.0, len(values))
    return values - np.mean(values, axis=0) - np.outer(place, place @ values / (place @ place))


# Frequency responses of records and of the model over the same runs, by one estimator.

SEGMENTS = 8
"""Segments that all samples are cut into, half overlap not counted; chosen, a compromise of resolution and scatter."""
FEWEST_SAMPLES = 32
"""Samples of a segment below which no response is estimated; chosen."""
BANDS = 40
"""Bands of the logarithmic frequency scale over which densities are averaged; chosen."""
EXCITED_SHARE = 1e-3
"""Density of the input over its largest (-30 dB) from which on a frequency counts as excited; chosen."""
_INTEGRALS = {"psi": "r", "phi": "p", "theta": "q"}  # angle -> its rate, which stands for both where it is compared
_TRACK = ("x0", "y0")  # a track is no linear response of a helm


def frequency_responses(
    model: Model, predictions: Sequence[Prediction], compared: Sequence[str]
) -> tuple[FrequencyResponse, ...]:
    """Return the response of each compared channel to each input that moves, over all runs simulated to their end.

    Tracks are left out, and angles whose rate is compared as well. Runs shorter than a segment are left out.
    """
    runs = [p for p in predictions if p.divergence is None]
    outputs = [c for c in compared if c not in _TRACK and _INTEGRALS.get(c) not in compared]
    outputs = [c for c in outputs if any(c in p.measured and c in p.simulated for p in runs)]
    inputs = [n for n in model.input_names if any(n in p.measured and np.ptp(p.measured[n]) > 0.0 for p in runs)]
    if not runs or not outputs:
        return ()
    length = segment_length([len(p.measured) for p in runs])
    if length < FEWEST_SAMPLES:
        return ()
    return tuple(r for name in inputs for output in outputs for r in _response(runs, name, output, length))


def segment_length(rows: Sequence[int]) -> int:
    """Return the samples of a segment: an eighth of all of them, but no more than the median run has; even."""
    return 2 * (min(sum(rows) // SEGMENTS, int(np.median(rows))) // 2)


def _response(runs: Sequence[Prediction], name: str, output: str, length: int) -> list[FrequencyResponse]:
    """The response of one output to one input; none where no segment is measured without gaps or nothing moves."""
    pairs = [p for p in runs if name in p.measured and output in p.measured and output in p.simulated]
    pieces = [(p.measured[name], np.column_stack([p.measured[output], p.simulated[output]])) for p in pairs]
    spectra = cross_spectra(pieces, length, pairs[0].measured.dt) if pairs else None
    if spectra is None:
        return []
    spectra = spectra.banded(BANDS)
    excited = spectra.input >= EXCITED_SHARE * np.max(spectra.input)
    if not np.max(spectra.input) > 0.0:
        return []
    rows = slice(int(np.argmax(excited)), len(excited) - int(np.argmax(excited[::-1])))
    return [_result(spectra, rows, excited, _names(pairs[0].measured, name, output))]


def _names(record: Record, name: str, output: str) -> tuple[str, str, str]:
    units = [record.channel(c).unit if c in record else channel_unit(c) for c in (output, name)]
    return name, output, _ratio(*units)


def _ratio(output: str, name: str) -> str:
    """Unit of an output over an input."""
    if name == "1":
        return output
    return f"{output} / ({name})" if " " in name or "/" in name else f"{output} / {name}"


def _result(spectra: CrossSpectra, rows: slice, excited: Mask, names: tuple[str, str, str]) -> FrequencyResponse:
    response = spectra.response[rows]
    return FrequencyResponse(
        *names, spectra.omega[rows], response[:, 0], response[:, 1], spectra.coherence[rows, 0],
        spectra.radius[rows, 0], spectra.averages[rows], tuple(map(bool, excited[rows])),
    )  # fmt: skip


# At which frequencies records show a linear ship: those that its constant coefficients stand for.

POWER_SHARE = 0.9  # middle share of the power; chosen
_WELCH_SEGMENTS = 4


def frequency_range(records: Sequence[Record], channels: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Channel -> frequencies [rad/s] between which the middle 90 % of its power lies, over all records (Welch 1967).

    Gaps are left out; channels that no record holds, or that never move, are not in the answer.
    """
    found = {}
    for channel in channels:
        pieces = [_measured_samples(r, channel) for r in records if channel in r]
        # samples of the shortest spectrum; chosen
        powers = [_power_spectrum(values, dt) for values, dt in pieces if len(values) > 16 and np.ptp(values) > 0.0]
        if powers:
            found[channel] = _central_band(powers)
    return found


def _measured_samples(record: Record, channel: str) -> tuple[Array, float]:
    """The measured samples of a channel and their step: motions may be sampled more slowly than the record."""
    good = np.flatnonzero(np.isfinite(record[channel]))
    step = int(np.median(np.diff(good))) if len(good) > 1 else 1
    return record[channel][good], record.dt * step


def _power_spectrum(values: Array, dt: float) -> tuple[Array, Array]:
    length = max(16, 2 * len(values) // (_WELCH_SEGMENTS + 1))  # samples of the shortest spectrum; chosen
    omega, density = power_density(values[:, None], min(length, len(values)), dt)
    return omega, density[:, 0] * len(values) * dt


def _central_band(powers: Sequence[tuple[Array, Array]]) -> tuple[float, float]:
    omega = np.concatenate([w for w, _ in powers])
    weight = np.concatenate([p * (w[1] - w[0]) for w, p in powers])
    order = np.argsort(omega, kind="stable")
    share = np.cumsum(weight[order]) / np.sum(weight)
    tail = 0.5 * (1.0 - POWER_SHARE)
    low, high = (float(omega[order][np.searchsorted(share, s)]) for s in (tail, 1.0 - tail))
    return low, high


def frequency_range_finding(ranges: Mapping[str, tuple[float, float]]) -> Finding:
    """What it means for the coefficients."""
    ranges_text = ", ".join(f"{NOTATION[c].meaning} {low:.2g} to {high:.2g} rad/s" for c, (low, high) in ranges.items())
    low, high = min(a for a, _ in ranges.values()), max(b for _, b in ranges.values())
    return Finding(
        Severity.INFO,
        "frequency-range",
        f"the constant coefficients stand for frequencies of encounter from {low:.2g} to {high:.2g} rad/s; outside "
        f"they "
        "extrapolate, for added mass and damping change with frequency",
        f"{100 * POWER_SHARE:.0f} % of the power: {ranges_text}",
    )


# Peaks of residual spectra: at which frequencies some channels swing, and by how much, above what lies beside.

_SEGMENT_LENGTHS = (64, 1024)
"""Samples of the stretches that are averaged, at least and at most; chosen."""
_AVERAGES = 4  # stretches in all samples, which overlap by half; chosen
_ASIDE = 1.7  # factor between a peak and the places to both sides that it is compared with; chosen
_SMOOTHED = 3  # neighbouring frequencies that are averaged; chosen
_LEAST_EXCESS = float(np.log(2.0))  # of a peak over the power law through both sides; chosen: slopes' knees reach 0.4
_HIGH_EXCESS = float(np.log(8.0))  # of a peak that is waves beyond doubt; chosen
_SHARED_EXCESS = float(np.log(1.25))  # of the other channels there, whose noise hides more; chosen
_APART = 1.2  # least factor between two peaks; chosen
_BAND = 1.4  # factor to both sides of a peak within which its variance lies; chosen


@dataclass(frozen=True, eq=False)
class SpectralPeak:
    """A frequency [rad/s] at which spectra peak.

    Attributes:
        variance: of each channel in its band, above what lies beside, (ny,), 0 where it does not peak there.
        floor: variance of white noise with the least density of each channel's spectrum, (ny,).
        is_high: whether a channel exceeds its sides there as nothing but waves does.
    """

    frequency: float
    variance: Array
    floor: Array
    is_high: bool = False


def spectral_peaks(pieces: Sequence[Array], dt: float, most: int) -> list[SpectralPeak]:
    """Return the highest peaks of the spectra of residuals, at most so many, the one that exceeds its sides most first.

    Excess is the logarithm of density over the geometric mean of those at 1.7 times and at 1 / 1.7 of the frequency:
    nothing for any power law, below zero where white noise takes over from one.

    Args:
        pieces: residuals of runs, (rows, ny) each, NaN where nothing was measured; dt: time step [s].
    """
    omega, density = _density(pieces, dt)
    if len(omega) < 2 * _SMOOTHED:
        return []
    excess = _excess(omega, density)
    peaks: list[SpectralPeak] = []
    for place in _local_maxima(np.max(excess, axis=1)):
        frequency = float(omega[place])
        if all(max(frequency / p.frequency, p.frequency / frequency) > _APART for p in peaks):
            peaks.append(_peak(omega, density, excess, place))
    return peaks[:most]


def _density(pieces: Sequence[Array], dt: float) -> tuple[Array, Array]:
    """Frequencies [rad/s] and densities per rad/s, (frequencies, ny), averaged over overlapping stretches (Welch)."""
    rows = sum(len(p) for p in pieces)
    longest = max(len(p) for p in pieces)
    shortest, most = _SEGMENT_LENGTHS
    length = int(np.clip(2 ** int(np.log2(max(rows // _AVERAGES, 1))), shortest, most))
    length = min(length, longest)
    long_enough = [p for p in pieces if len(p) >= length]
    spectra = [power_density(np.nan_to_num(p), length, dt) for p in long_enough]
    density = np.average([d for _, d in spectra], axis=0, weights=[len(p) for p in long_enough])
    return spectra[0][0][1:], density[1:]


def _excess(omega: Array, density: Array) -> Array:
    """Logarithm of the smoothed densities over what a power law through both sides has, (frequencies, ny)."""
    kernel = np.ones(_SMOOTHED) / _SMOOTHED
    padded = np.pad(density, ((_SMOOTHED // 2, _SMOOTHED // 2), (0, 0)), mode="edge")
    smooth = np.stack([np.convolve(column, kernel, "valid") for column in padded.T], axis=1)
    log = np.log(np.maximum(smooth, np.finfo(float).tiny))
    sides = [np.stack([np.interp(omega * f, omega, c) for c in log.T], axis=1) for f in (_ASIDE, 1.0 / _ASIDE)]
    return log - 0.5 * (sides[0] + sides[1])


def _local_maxima(values: Array) -> Index:
    """Places of local maxima with enough excess, the largest first."""
    padded = np.pad(values, 1, constant_values=-np.inf)
    is_peak = (values >= padded[:-2]) & (values >= padded[2:]) & (values >= _LEAST_EXCESS)
    places = np.flatnonzero(is_peak)
    return places[np.argsort(-values[places], kind="stable")]


def _peak(omega: Array, density: Array, excess: Array, place: int) -> SpectralPeak:
    frequency, step = omega[place], omega[1] - omega[0]
    is_inside = (omega > frequency / _BAND) & (omega < frequency * _BAND)
    edges = np.searchsorted(omega, [frequency / _BAND, frequency * _BAND]).clip(0, len(omega) - 1)
    beside = np.min(density[edges], axis=0)
    variance = step * np.sum(np.maximum(density[is_inside] - beside, 0.0), axis=0)
    near = slice(max(place - 1, 0), place + 2)
    variance = np.where(np.max(excess[near], axis=0) >= _SHARED_EXCESS, variance, 0.0)
    is_high = bool(np.max(excess[near]) >= _HIGH_EXCESS)
    return SpectralPeak(float(frequency), variance, np.min(density, axis=0) * float(omega[-1]), is_high)
