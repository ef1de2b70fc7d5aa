"""A loop at its own gains, how near to instability, and at any gains in a sea: objectives, peak, gradients."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.numerics.kernels.loop import evaluate_loops, sensitivity_peaks, variance_gradients
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops.encounter_spectrum import EncounterSpectrum, disturbance_spectrum, nodes
from seatrial.physics.loops.loop import TransferLoop
from seatrial.physics.loops.objective import LoopSignal, Objective, WeightedVariance

# How near a loop is to instability, at its own gains.

_SAMPLES = 2000  # frequencies that the margins are bracketed on; chosen
_BELOW, _ABOVE = 0.3, 2.0  # ends of the band over the slowest and the fastest root; chosen
_EMPTY_BAND = 1e-2, 1e2  # rad/s, where there is no root; chosen
_AT_ORIGIN, _PEAK_TOLERANCE = 1e-6, 1e-9  # rad/s, a root that counts as zero; of log omega at the peak: rounding
_LEAST = 1e-300  # rad/s, guards against a pole at zero


@dataclass(frozen=True)
class StabilityMargins:
    """Of one loop; nan where it is unstable.

    Attributes:
        is_stable: all closed-loop poles lie left of the axis; Ms: the largest |S|, infinite if unstable;
        Ms_frequency: rad/s.
        gain: the factor that the loop gain may grow by, infinite if any; lower_gain: that it may fall to, zero if any.
        phase: rad, positive: the least that L may turn, either way, where its size is one; infinite if it never is.
        delay: s of dead time that the loop tolerates: the least lag up to -1 over the frequency, infinite if any.
        damping: the least damping ratio of a closed-loop pole.
    """

    is_stable: bool
    Ms: float
    Ms_frequency: float
    gain: float
    phase: float
    delay: float
    damping: float
    lower_gain: float = math.nan


def frequency_band(loop: TransferLoop) -> tuple[float, float]:
    """Return frequencies [rad/s] between which everything of the loop happens.

    A little more than from the slowest to the fastest of its poles and zeros, of a sampled loop to its Nyquist
    frequency; beside the open ones those that swing when it is closed at its own gains or with all at their upper
    bounds, as integrators let it.
    """
    d, n = loop.polynomials
    bounds = np.array([gain.upper for gain in loop.gains])
    closed = d + loop.gain_values @ n, d + np.where(np.isfinite(bounds), bounds, loop.gain_values) @ n
    swinging = [roots[np.abs(roots.imag) > 0.5 * np.abs(roots.real)] for roots in (np.roots(row) for row in closed)]
    roots = np.abs(np.concatenate([np.roots(d), *(np.roots(row) for row in n), *swinging]))
    some = roots[roots > _AT_ORIGIN]
    low, high = (_BELOW * float(some.min()), _ABOVE * float(some.max())) if some.size else _EMPTY_BAND
    highest = math.inf if loop.sampling is None else loop.sampling.highest
    return min(low, _BELOW * highest), min(high, highest)


def sensitivity_magnitude(loop: TransferLoop, omega: Array) -> Array:
    """Return |S| of the loop at omega [rad/s], (n,)."""
    return 1.0 / np.abs(1.0 + loop.open_loop(omega))


def sensitivity_peak(loop: TransferLoop) -> tuple[float, float]:
    """Return Ms and where it is [rad/s], to rounding, by a search about the largest sample; the loop must be stable."""
    from scipy.optimize import minimize_scalar

    u = _log_frequencies(loop)
    place = int(np.argmax(sensitivity_magnitude(loop, np.exp(u))))
    ends = u[max(place - 1, 0)], u[min(place + 1, _SAMPLES - 1)]
    found = minimize_scalar(
        lambda v: -float(sensitivity_magnitude(loop, np.exp(np.array([v])))[0]), bounds=ends, method="bounded",
        options={"xatol": _PEAK_TOLERANCE},
    )  # fmt: skip
    return max(-float(found.fun), 1.0), math.exp(float(found.x))


def margins(loop: TransferLoop) -> StabilityMargins:
    """Return the margins at the loop's gains; Ms to rounding, by a search about the largest sample."""
    poles = loop.closed_loop_poles
    damping = float(np.min(-poles.real / np.maximum(np.abs(poles), _LEAST)))
    if not np.all(poles.real < 0.0):
        return StabilityMargins(False, math.inf, math.nan, math.nan, math.nan, math.nan, damping)
    peak, at = sensitivity_peak(loop)
    turned, lag = _unit_crossings(loop)
    axis = _crossing_frequencies(loop, lambda z: z.imag)
    factors = -1.0 / loop.open_loop(axis if loop.sampling is None else np.append(axis, loop.sampling.highest)).real
    return StabilityMargins(
        True, peak, at, _minimum(factors[factors > 1.0]), _minimum(np.minimum(lag, 2.0 * math.pi - lag)),
        _minimum(lag / turned), damping, float(np.max(factors[(factors > 0.0) & (factors < 1.0)], initial=0.0)),
    )  # fmt: skip


def delay_margin(loop: TransferLoop) -> float:
    """Return the delay [s] of `margins` alone, which costs a third of it; nan where the loop is unstable."""
    if not np.all(loop.closed_loop_poles.real < 0.0):
        return math.nan
    turned, lag = _unit_crossings(loop)
    return _minimum(lag / turned)


def _unit_crossings(loop: TransferLoop) -> tuple[Array, Array]:
    """Return frequencies [rad/s] where |L| is one, and the lag up to -1 there, rad in 0 .. 2 pi."""
    turned = _crossing_frequencies(loop, lambda z: np.abs(z) - 1.0)
    return turned, np.mod(np.angle(loop.open_loop(turned)) + math.pi, 2.0 * math.pi)


def _log_frequencies(loop: TransferLoop) -> Array:
    """Logarithms of frequencies over the band and all closed poles: a weak loop that integrates crosses one early."""
    low, high = frequency_band(loop)
    poles = np.abs(loop.closed_loop_poles)
    poles = poles[poles > 0.0]  # a plant that integrates and is not controlled stays where it is
    highest = math.inf if loop.sampling is None else loop.sampling.highest
    first, last = min(low, _BELOW * poles.min()), min(max(high, _ABOVE * poles.max()), highest)
    return np.linspace(math.log(first), math.log(last), _SAMPLES)


def _crossing_frequencies(loop: TransferLoop, function: Callable[[Complex], Array]) -> Array:
    """Return frequencies [rad/s] at which a function of L changes its sign."""
    from scipy.optimize import brentq

    u = _log_frequencies(loop)
    rises = np.flatnonzero(np.diff(np.sign(function(loop.open_loop(np.exp(u))))))

    def along(v: float) -> float:
        return float(function(loop.open_loop(np.exp(np.array([v]))))[0])

    # tolerance in the logarithm of the frequency: rounding
    return np.exp(np.array([float(brentq(along, u[i], u[i + 1], xtol=1e-13)) for i in rises]))  # type: ignore[arg-type]


def _minimum(values: Array) -> float:
    return float(values.min()) if values.size else math.inf


# A loop in a sea, ready to be evaluated at any gains: objectives, sensitivity peak, stability, gradients.

_ORDER = (LoopSignal.OUTPUT, LoopSignal.ACTUATOR, LoopSignal.POINT)
_MS_SAMPLES = 192  # frequencies that the peak of |S| is bracketed on; chosen
PEAKS = 3  # of |S| that are looked at by themselves: one of the wave band and one to either side; chosen
_STILL = 0.1, 1.0  # rad/s, band of a disturbance of no energy
_NOISE_SAMPLES, _NOISE_DECADES = 240, 5  # frequencies of the sensor's noise, and decades up to the highest; chosen


@dataclass(frozen=True, eq=False)
class LoopEvaluation:
    """Loops evaluated, m of them.

    Attributes:
        variances: of the rows, (m, r); infinite where unstable.
        Ms: the largest |S| (m,), by a parabola of L through samples; infinite where unstable.
    """

    variances: Array
    Ms: Array


@dataclass(frozen=True, eq=False)
class Performance:
    """The loop in one exposure.

    Variances are exact to 1e-8 up to Ms 5, at nodes that settle without control; to 1e-4 up to 10, to one in a hundred
    up to 20, and unusable beyond 50. An exposure whose `response` is the closed loop's, D S, resolves any loop.
    A loop slower than 0.002 rad/s in following seas, where waves keep up with the ship, may be 0.1 % off.

    Attributes:
        variances: variances computed, in this order: those on the output first, then the actuator, then points.

    Raises:
        InputError: the plant does nothing at a frequency of the exposure, rows stand in another order, or a point is
            none of the loop's, or unknown to the sea.
    """

    loop: TransferLoop
    spectrum: EncounterSpectrum
    variances: tuple[WeightedVariance, ...]

    def __post_init__(self) -> None:
        seen = [_ORDER.index(row.signal) for row in self.variances]
        if seen != sorted(seen):
            raise InputError("rows on the output must precede rows on the actuator, and those rows on points")
        points = {row.x for row in self.variances if row.signal is LoopSignal.POINT}
        if points - {point.x for point in self.loop.points} or (points and not self.spectrum.points):
            raise InputError(
                f"loop '{self.loop.name}' in {self.spectrum.description} knows no motion at "
                f"{', '.join(f'{x:g} m' for x in sorted(points))} forward of the origin"
            )
        dead = self.spectrum.omega_e[self.loop.plant_response(self.spectrum.omega_e) == 0.0]
        if dead.size:
            raise InputError(
                f"the actuator {self.loop.actuator} of loop '{self.loop.name}' does not move {self.loop.output} at "
                f"{dead[0]:.3g} rad/s; is the ship at rest?"
            )

    @cached_property
    def _noise(self) -> tuple[Array, Array]:
        """Frequencies [rad/s] and energies of the samples' errors; none of a loop in continuous time."""
        sampling = self.loop.sampling
        if sampling is None or not sampling.noise_variance:
            return np.empty(0), np.empty(0)
        # white from sample to sample: one-sided density variance T / pi up to the Nyquist frequency
        omega, width = nodes((10.0**-_NOISE_DECADES * sampling.highest, sampling.highest), _NOISE_SAMPLES)
        return omega, sampling.noise_variance * sampling.sample_s / math.pi * width

    @cached_property
    def _omega(self) -> Array:
        """Nodes of the exposure and of the noise, rad/s."""
        return np.concatenate([self.spectrum.omega_e, self._noise[0]])

    @cached_property
    def _node_weights(self) -> tuple[Array, Array, Array, Array]:
        """What |S|^2, |L S|^2, both, and |L S|^2 in the output weigh at each node, of exposure and noise.

        Of the exposure |W D|^2 and |W D / P|^2 times the energy, see the module. Noise of the samples moves output and
        actuator as `misreading_paths` say, and a point by its plant as the actuator.
        """
        met, seen, heard = self._exposure_weights, len(self.spectrum.omega_e), len(self._noise[0])
        made = [np.concatenate([part, np.zeros((len(part), heard))], axis=1) for part in met]
        omega, energy = self._noise
        in_output = np.zeros((len(met[0]), seen + heard))
        if heard:
            heard_in_output, moved = (
                np.abs(misreading_path) ** 2 * energy for misreading_path in self.loop.misreading_paths(omega)
            )
            rows = {signal: [row for row in self.variances if row.signal is signal] for signal in _ORDER}
            for i, row in enumerate(rows[LoopSignal.OUTPUT]):
                in_output[i, seen:] = row.magnitude(omega) ** 2 * heard_in_output
            for i, row in enumerate(rows[LoopSignal.ACTUATOR]):
                made[1][i, seen:] = row.magnitude(omega) ** 2 * moved
            for i, row in enumerate(rows[LoopSignal.POINT]):
                place = [point.x for point in self.loop.points].index(row.x)
                reach = np.abs(self.loop.points[place].plant.frequency_response(omega)) ** 2
                made[2][4 * i + 1, seen:] = row.magnitude(omega) ** 2 * reach * moved
        return tuple(np.ascontiguousarray(part) for part in (*made, in_output))  # type: ignore[return-value]

    @cached_property
    def _exposure_weights(self) -> tuple[Array, Array, Array]:
        """What |S|^2, |L S|^2 and both weigh at each node of the exposure."""
        w = self.spectrum.omega_e
        free = np.abs(self.loop.disturbance.frequency_response(w)) ** 2 * self.spectrum.energy
        moved = free / np.abs(self.loop.plant_response(w)) ** 2
        outputs = [row.magnitude(w) ** 2 * free for row in self.variances if row.signal is LoopSignal.OUTPUT]
        actuators = [row.magnitude(w) ** 2 * moved for row in self.variances if row.signal is LoopSignal.ACTUATOR]
        points = [row.magnitude(w) ** 2 * self._point_energies(row.x)
                  for row in self.variances if row.signal is LoopSignal.POINT]  # fmt: skip
        return tuple(np.ascontiguousarray(np.reshape(part, (-1, len(w)))) for part in (outputs, actuators, points))  # type: ignore[return-value]

    def _point_energies(self, x: float) -> Array:
        """Return energies of q and r and their cross spectrum's two parts at the point x, (4, n)."""
        place = [point.x for point in self.loop.points].index(x)
        q, w = self.spectrum.points[place], self.spectrum.omega_e
        ratio = self.loop.points[place].plant.frequency_response(w) / self.loop.plant_response(w)
        moved = ratio * self.loop.disturbance.frequency_response(w)
        common = np.conj(moved) * q.cross
        of_r = q.energy - 2.0 * common.real + np.abs(moved) ** 2 * self.spectrum.energy
        return np.stack([q.energy, of_r, q.energy - common.real, -common.imag])

    @cached_property
    def _open_loop_tables(self) -> tuple[Array, Array, Array, Array]:
        seen = self.loop.open_loop_terms(self._omega)
        wide = self.loop.open_loop_terms(np.geomspace(*frequency_band(self.loop), _MS_SAMPLES))
        return tuple(np.ascontiguousarray(part) for part in (seen.real, seen.imag, wide.real, wide.imag))  # type: ignore[return-value]

    @cached_property
    def _no_frequencies(self) -> Array:
        """The open loop without frequencies, (g, 0): no peak is looked for."""
        return np.empty((len(self.loop.terms), 0))

    @cached_property
    def _polynomials(self) -> tuple[Array, Array]:
        """Those of the loop, as arrays that compiled code takes: it knows none that are frozen."""
        d, n = self.loop.polynomials
        return np.array(d), np.array(n)

    def evaluate(self, gains: Array, *, with_Ms: bool = True) -> LoopEvaluation:
        """Return loops with the gains (m, g); without the peak, `peak` only states whether a loop is stable (zero).

        Raises:
            InputError: there is not one gain for each term.
        """
        k = np.ascontiguousarray(np.atleast_2d(gains), dtype=np.float64)
        if k.shape[1] != len(self.loop.terms):
            raise InputError(f"loop '{self.loop.name}' has {len(self.loop.terms)} gains, not {k.shape[1]}")
        re, im, wide_re, wide_im = self._open_loop_tables
        if not with_Ms:
            wide_re = wide_im = self._no_frequencies
        peak, out = np.zeros(len(k)), np.empty((len(k), len(self.variances)))
        evaluate_loops(k, *self._polynomials, self.loop.idle_integrators(k), re, im, *self._node_weights,
                       wide_re, wide_im, peak, out)  # fmt: skip
        return LoopEvaluation(out, peak)

    def variance_gradients(self, gains: Array) -> Array:
        """Return d variances / d gains at one point (g,), shape (r, g); the loop must be stable."""
        re, im, _, _ = self._open_loop_tables
        out = np.empty((len(self.variances), len(gains)))
        variance_gradients(np.ascontiguousarray(gains, dtype=np.float64), re, im, *self._node_weights, out)
        return out

    def sensitivity_peaks(self, gains: Array) -> tuple[Array, Array]:
        """Return the largest peaks of |S| over the band, largest first, and their slopes d |S| / d gains, by parabolas.

        (3,) and (3, g); zero where there are fewer peaks.
        """
        _, _, re, im = self._open_loop_tables
        peaks, slopes = np.empty(PEAKS), np.empty((PEAKS, len(gains)))
        sensitivity_peaks(np.ascontiguousarray(gains, dtype=np.float64), re, im, peaks, slopes)
        return peaks, slopes

    @property
    def uncontrolled_variances(self) -> Array:
        """The variances with all gains at zero, (r,): those on the actuator vanish."""
        on_s, on_t, on_both, _ = self._node_weights
        return np.concatenate([on_s.sum(axis=1), np.zeros(len(on_t)), on_both[::4].sum(axis=1)])


def calm_actuator(loop: TransferLoop) -> tuple[float, float]:
    """Return the rms of a stable loop's actuator and of its rate, SI, by the sensor's errors alone, at its gains."""
    angle, rate = (WeightedVariance(LoopSignal.ACTUATOR, lambda w, n=power: w**n) for power in (0, 1))
    still = disturbance_spectrum(lambda w: 0.0 * w, _STILL[0], _STILL[1], loop.disturbance, "calm water")
    variances = Performance(loop, still, (angle, rate)).evaluate(loop.gain_values, with_Ms=False).variances[0]
    rms_angle, rms_rate = np.sqrt(variances).tolist()
    return rms_angle, rms_rate


def distinct_variances(objectives: tuple[Objective, ...]) -> tuple[tuple[WeightedVariance, ...], list[list[int]]]:
    """Return all different rows of some objectives in the order of `Performance`, and for each where its own stand."""
    different = dict.fromkeys(row for objective in objectives for row in objective.variances)
    rows = sorted(different, key=lambda row: _ORDER.index(row.signal))
    return tuple(rows), [[rows.index(row) for row in objective.variances] for objective in objectives]
