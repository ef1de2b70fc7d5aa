"""Legs in waves that nobody measured: spectra of one, and several that share a ship."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, reduce

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.spectral_likelihood import WINDOW_CORRELATION, hann_leakage, hann_transform
from seatrial.numerics.optimise import NormalEquations, Status, levenberg_marquardt
from seatrial.physics.hydro.excitation import Complex, encounter_frequency
from seatrial.physics.loops import Block, TransferLoop, WaveEffect
from seatrial.physics.sea import Spectrum, bretschneider
from seatrial.physics.sea.spectrum import speed_factor

# One stretch of steady speed and heading in waves that nobody measured: spectra, the sea, and its likelihood.

# A sea of unknown height, period and peak as the spectra of a moving ship show it.

SEA_UNKNOWNS = ("height", "peak period", "peak")
"""What is unknown of a sea: logarithms of significant height [m] and peak period [s], and of gamma - 1."""
SEA_COUNT = len(SEA_UNKNOWNS)

_WINDOW_POWER = 1.5  # mean of a Hann window's square over the square of its mean: the area under its leakage, in bins
_NODES_A_BIN = 3.0  # nodes over the wave frequency for each bin of the transform, at least; chosen
_LEAKAGE_BINS = 8.0  # bins beyond the band from which the window still shows power; chosen
_PLACES_A_BIN = 64  # at which leakage is tabulated: within 1 % of a node's own, either way; chosen
_KEPT = 8  # tables of leakage in memory; chosen
_LONGEST, _SHORTEST = 0.5, 4.0  # wave frequencies over the ends of the band that are looked at; chosen


@dataclass(frozen=True, eq=False)
class EncounteredSea:
    """Nodes over the wave frequency for one speed and heading.

    Attributes:
        omega: (n,), rad/s; omega_e: (n,), rad/s, the frequencies at which they are met; width: rad/s.
        effect_energy: (n,), |effect|^2 for each metre of wave; leakage: (k, n), s/rad, what each frequency of a
            transform shows of each node's energy.
        shapes: (j, n), what each departure adds to the logarithm of the energy at each node.
    """

    omega: Array
    omega_e: Array
    width: float
    effect_energy: Array
    leakage: Array
    shapes: Array

    def disturbance_energy(self, sea: Array) -> Array:
        """Return each node's share of the variance of the disturbance, (n,).

        sea: (3 + j,), `SEA_UNKNOWNS` and the departures of wave spectrum and effect together from what is assumed.
        """
        assumed = self.effect_energy * sea_spectrum(sea[:SEA_COUNT]).density(self.omega) * self.width
        return assumed * np.exp(sea[SEA_COUNT:] @ self.shapes)

    def density(self, sea: Array, power_gain: Array) -> Array:
        """Return the density of a motion as the transforms show it, (k,); power_gain: (n,), |response|^2 at omega_e."""
        return self.leakage @ (power_gain * self.disturbance_energy(sea))


def sea_spectrum(sea: Array) -> Spectrum:
    """Return the spectrum of the unknowns (3,): Bretschneider's with a peak raised as JONSWAP's."""
    height, period, peak = np.exp(sea).tolist()
    raw = replace(bretschneider(height, period), gamma=1.0 + peak)
    return replace(raw, A=raw.A * height**2 / (16.0 * raw.moment(0)))  # significant height is four standard deviations


_NO_KNOTS: Array = np.empty(0)


def encountered_sea(bins: Array, U: float, beta: float, effect: WaveEffect, knots: Array = _NO_KNOTS) -> EncounteredSea:
    """Return the nodes for transforms at `bins` (k,) [rad/s], a ship of speed U [m/s], heading beta [rad, 0 following].

    knots: (j,), rising [rad/s], encounter frequencies at which the spectrum may depart from the assumed one, straight
    between them in the logarithm of the frequency.

    Raises:
        InputError: speed or heading out of sense.
    """
    q, step = speed_factor(U, beta), float(bins[1] - bins[0])
    longest, shortest = effect.frequency_range
    lowest = max(_LONGEST * float(bins[0]), longest)
    highest = _highest_wave(float(bins[-1]) + _LEAKAGE_BINS * step, q)
    highest = min(highest, shortest, _SHORTEST * float(bins[-1]))
    steepest = max(abs(1.0 - 2.0 * q * lowest), abs(1.0 - 2.0 * q * highest))
    count = math.ceil(_NODES_A_BIN * max(steepest, 1.0) * (highest - lowest) / step)
    width = (highest - lowest) / count
    omega = np.asarray(lowest + width * (np.arange(count) + 0.5), dtype=np.float64)
    omega_e = np.abs(encounter_frequency(omega, U, beta))
    columns = _leakage_columns(len(bins))
    places = np.rint(((omega_e - bins[0]) / step + _LEAKAGE_BINS) * _PLACES_A_BIN).astype(int)
    is_near = (places >= 0) & (places < columns.shape[1])
    leakage = np.where(is_near, columns[:, np.where(is_near, places, 0)], 0.0) / step
    place = np.log(np.maximum(omega_e, bins[0]))
    shapes = np.array([np.interp(place, np.log(knots), row) for row in np.eye(len(knots))]).reshape(-1, count)
    return EncounteredSea(omega, omega_e, width, np.abs(effect.amplitude(omega, U, beta)) ** 2, leakage, shapes)


@lru_cache(maxsize=_KEPT)
def _leakage_columns(count: int) -> Array:
    """Return what `count` bins show of energy at places from 8 bins below the first to 8 above the last, (count, p)."""
    width = round((count + 2.0 * _LEAKAGE_BINS - 1.0) * _PLACES_A_BIN) + 1
    places = np.arange(width) / _PLACES_A_BIN - _LEAKAGE_BINS
    return hann_leakage(np.arange(count)[:, None] - places) / _WINDOW_POWER


def _highest_wave(omega_e: float, q: float) -> float:
    """Return the highest wave frequency that is met at omega_e: the largest root of |omega - q omega^2| = omega_e."""
    if q > 0.0:
        return (1.0 + math.sqrt(1.0 + 4.0 * q * omega_e)) / (2.0 * q)
    return 2.0 * omega_e / (1.0 + math.sqrt(1.0 - 4.0 * q * omega_e))


# A loop whose ship differs from the model: by the actuator's effect, the natural frequency, and the damping.

PLANT_FACTORS = ("gain", "frequency", "damping")
"""What may differ, as logarithms of factors; zeros leave a loop as it is."""


def altered_loop(loop: TransferLoop, factors: Array) -> TransferLoop:
    """Return the loop with the plant's gain, and the natural frequencies and damping of plant and disturbance, changed.

    factors: (3,), logarithms, in the order of `PLANT_FACTORS`. Gains at rest are kept but for the first factor.
    """
    gain, frequency, damping = np.exp(factors).tolist()
    plant = _altered_block(loop.plant, frequency, damping).scaled(gain)
    return replace(loop, plant=plant, disturbance=_altered_block(loop.disturbance, frequency, damping))


def altered_responses(block: Block, omega: Array, factors: Array) -> Complex:
    """Return the responses at omega (k,) [rad/s] of a block altered by each row of factors (m, 2), (m, k).

    factors: logarithms, of natural frequency and damping, as of `altered_loop`.
    """
    frequency, damping = np.exp(factors).T[:, :, None]
    s = 1j * omega / frequency
    poles = damping * block.poles.real + 1j * block.poles.imag
    if not len(poles.T):
        return np.polyval(block.num, s) / block.den[-1]
    factor = reduce(np.multiply, (1.0 - s * (1.0 / pole) for pole in poles.T[:, :, None]))
    return np.polyval(block.num, s) / (block.den[-1] * factor)


def _altered_block(block: Block, frequency: float, damping: float) -> Block:
    """Return H(s / frequency) with the real parts of its poles times `damping`, the same at s = 0."""
    poles = frequency * (damping * block.poles.real + 1j * block.poles.imag)
    stretched = np.array(block.num) / frequency ** np.arange(len(block.num) - 1, -1, -1)
    den = np.real(np.poly(poles))
    num = stretched * (den[-1] / block.den[-1])
    return replace(block, num=tuple(num.tolist()), den=tuple(den.tolist()))


# Fourier transforms of the half-overlapping segments of a stretch of a record (Welch 1967, IEEE Trans. AU-15, 70).

# variance of the mean of half-overlapping Hann segments over that of as many independent ones, 1 + 2 (1/6)^2
# (Welch 1967, section on overlapping segments)
_OVERLAP_VARIANCE = 1.0 + 2.0 / 36.0
_FEWEST_SEGMENTS = 4  # from which a spread between segments says something; chosen


@dataclass(frozen=True, eq=False)
class StretchSpectra:
    """Transforms of m segments of c channels, scaled so that the mean of |transform|^2 is the one-sided density.

    Attributes:
        omega: (k,), rad/s, evenly spaced; transforms: (m, k, c).
    """

    omega: Array
    transforms: Complex

    @property
    def step(self) -> float:
        """Return the distance of two frequencies [rad/s]."""
        return float(self.omega[1] - self.omega[0])

    @property
    def information(self) -> float:
        """Return how many independent periodograms the mean of the segments is worth, at each frequency."""
        return len(self.transforms) / _OVERLAP_VARIANCE / WINDOW_CORRELATION

    def cross_density(self, first: int, second: int) -> Complex:
        """Return the mean over the segments of one channel times the conjugate of another, (k,)."""
        return np.mean(self.transforms[:, :, first] * self.transforms[:, :, second].conj(), axis=0)

    def band_limited(self, low: float, high: float) -> "StretchSpectra":
        """Return the same between two frequencies [rad/s]."""
        kept = (self.omega >= low) & (self.omega <= high)
        return replace(self, omega=self.omega[kept], transforms=self.transforms[:, kept])

    def strong_band(self, channel: int, share: float) -> "StretchSpectra":
        """Return the same on the band about the largest density of a channel where it is at least a share of that."""
        density = self.cross_density(channel, channel).real
        peak, weak = int(np.argmax(density)), np.flatnonzero(density < share * np.max(density))
        first = int(np.max(weak[weak < peak], initial=-1)) + 1
        last = int(np.min(weak[weak > peak], initial=len(density)))
        return replace(self, omega=self.omega[first:last], transforms=self.transforms[:, first:last])


def stretch_spectra(values: Array, dt: float, segment_s: float) -> StretchSpectra:
    """Return the transforms of the columns of values (n, c), every dt [s], in segments of `segment_s` [s].

    Raises:
        InputError: the values have gaps, or hold fewer than four segments.
    """
    count = round(segment_s / dt)
    starts = range(0, len(values) - count + 1, max(1, count // 2))
    if len(starts) < _FEWEST_SEGMENTS:
        shortest = 0.5 * (_FEWEST_SEGMENTS + 1) * segment_s
        raise InputError(f"a stretch of {len(values) * dt:.0f} s is too short for a spectrum; give {shortest:.0f} s")
    if not np.all(np.isfinite(values)):
        raise InputError("a stretch has gaps, which a spectrum cannot have; repair them")
    parts = [hann_transform(values[first : first + count], dt) for first in starts]
    return StretchSpectra(parts[0][0], np.array([transform for _, transform in parts]))


# One stretch of steady speed and heading in waves that nobody measured: its likelihood in closed loop (Whittle).

SHIP_COUNT = len(PLANT_FACTORS)
STEP = 1e-4  # of logarithmic unknowns, for central differences; chosen
_FLOOR = 1e-5  # of the largest density: sensors and whatever else the sea does not explain; chosen
_PERIODS = np.geomspace(0.4, 2.5, 15)  # peak periods to begin from, over the one expected; chosen
_ALIKE = 1e-3  # of the strongest combination of the controller's terms, below which one is not in the stretch; chosen


@dataclass(frozen=True, eq=False)
class ObservedLeg:
    """What a stretch shows, whatever sea it was in.

    Attributes:
        spectra: of output and actuator, in that order.
        loop: its plant and disturbance are those at the leg's speed; of its gains the values do not count.
    """

    spectra: StretchSpectra
    loop: TransferLoop

    @cached_property
    def gains(self) -> Array:
        """Return the loop's gains as the leg shows them, (g,): actuator regressed on each term of the output.

        Combinations of which the stretch holds nothing stay at zero.
        """
        outputs, actuators = (self.spectra.transforms[:, :, k] for k in (0, 1))
        terms = -self.loop.controller_terms(self.spectra.omega)[:, None, :] * outputs
        rows = terms.reshape(len(terms), -1).T
        size = np.linalg.norm(rows, axis=0)
        both = np.concatenate([rows.real, rows.imag]) / size
        wanted = actuators.ravel()
        return np.asarray(np.linalg.lstsq(both, np.concatenate([wanted.real, wanted.imag]), rcond=_ALIKE)[0] / size)

    @cached_property
    def output_density(self) -> Array:
        """Return the density of the output, (k,)."""
        return self.spectra.cross_density(0, 0).real

    @cached_property
    def controller(self) -> Complex:
        """Return K of a = -K y at the frequencies of the spectra, (k,)."""
        return self.controller_at(self.spectra.omega)

    def controller_at(self, omega: Array) -> Complex:
        """Return K of a = -K y at the gains that the leg shows, (k,)."""
        return np.asarray(self.gains @ self.loop.controller_terms(omega), dtype=np.complex128)

    @cached_property
    def independent_actuator(self) -> Array:
        """Return the density of what the actuator does besides following the output, (k,): limits, orders, sensors."""
        ordered = -self.controller[:, None] * self.spectra.transforms[:, :, 0].T
        return np.mean(np.abs(self.spectra.transforms[:, :, 1].T - ordered) ** 2, axis=1)


@dataclass(frozen=True, eq=False)
class WaveLeg:
    """A stretch of steady speed and heading.

    Attributes:
        observed: its spectra and its loop; sea: the nodes for its frequencies.
        expected_period: s, of the sea's peak, from which the search starts.
    """

    observed: ObservedLeg
    sea: EncounteredSea
    expected_period: float

    @property
    def spectra(self) -> StretchSpectra:
        """Return the spectra of output and actuator."""
        return self.observed.spectra

    @cached_property
    def _node_controller(self) -> Complex:
        return self.observed.controller_at(self.sea.omega_e)

    def likelihood(self, ship: Array, sea: Array) -> tuple[float, Array]:
        """Return minus the logarithm of the likelihood, up to a constant, and that of the output's density (k,).

        At factors on the ship (3,) and unknowns of the sea (3,).
        """
        return self._likelihood(self.responses(ship), self.sea.disturbance_energy(sea))

    def responses(self, ship: Array) -> tuple[Array, Array]:
        """Return |S D|^2 at the nodes and the density of S P e (k,), the ship having these factors (3,)."""
        loop = altered_loop(self.observed.loop, ship)
        closed = 1.0 + loop.plant.frequency_response(self.sea.omega_e) * self._node_controller
        gain = np.abs(loop.disturbance.frequency_response(self.sea.omega_e) / closed) ** 2
        P = loop.plant.frequency_response(self.spectra.omega)
        moved = np.abs(P / (1.0 + P * self.observed.controller)) ** 2 * self.observed.independent_actuator
        return gain, moved + _FLOOR * float(np.max(self.observed.output_density))

    def _likelihood(self, responses: tuple[Array, Array], energy: Array) -> tuple[float, Array]:
        """Return the likelihood of a ship met by waves of that energy at each node, (n,)."""
        gain, by_actuator = responses
        density = self.sea.leakage @ (gain * energy) + by_actuator
        terms = np.log(density) + self.observed.output_density / density
        return self.spectra.information * float(np.sum(terms)), np.log(density)

    def equations(self, ship: Array, sea: Array) -> tuple[Array, Array]:
        """Return gradient (u,) and Fisher information (u, u) of the cost, over the ship's and the sea's unknowns."""
        here, energy = self.responses(ship), self.sea.disturbance_energy(sea)
        ends = [
            *([self._likelihood(self.responses(ship + sign * step), energy) for sign in (1.0, -1.0)]
              for step in STEP * np.eye(SHIP_COUNT)),
            *([self._likelihood(here, self.sea.disturbance_energy(sea + sign * step)) for sign in (1.0, -1.0)]
              for step in STEP * np.eye(len(sea))),
        ]  # fmt: skip
        gradient, slopes = (np.array([up[part] - down[part] for up, down in ends]) / (2.0 * STEP) for part in (0, 1))
        return gradient, self.spectra.information * slopes @ slopes.T

    def start(self, ship: Array, peak: float) -> Array:
        """Return the sea (3,) of the best of some peak periods, its height by the energy of the motion."""
        as_assumed = np.zeros(len(self.sea.shapes))
        points = [np.array([0.0, np.log(self.expected_period * ratio), peak, *as_assumed]) for ratio in _PERIODS]
        responses = self.responses(ship)
        for point in points:
            density = np.exp(self._likelihood(responses, self.sea.disturbance_energy(point))[1])
            point[0] = 0.5 * np.log(np.mean(self.observed.output_density / density))
        return min(points, key=lambda point: self._likelihood(responses, self.sea.disturbance_energy(point))[0])


# Ship and seas together from legs in waves that nobody measured, with or without control: one ship, a sea each.

# log(gamma - 1) before the records: gamma 1.2 to 5.5 within a standard deviation, about what JONSWAP's records have
PEAK_MEAN, PEAK_DEVIATION = 0.0, 1.5
_WIDEST_SHIP = 1.6  # logarithm of a factor on the ship, either way: five times; chosen
_WIDEST_SHAPE = 6.0  # logarithm of a factor on the energy, either way: four hundred times; chosen
_LOWEST_SEA, _HIGHEST_SEA = np.array([-7.0, -3.0, -5.0]), np.array([4.0, 5.0, 3.0])
"""Bounds of a sea's unknowns: 1 mm to 55 m, 0.05 to 150 s, gamma 1.007 to 21; chosen."""
_NEGLIGIBLE, _EVALUATIONS = 1e-6, 200  # promised gain of log-likelihood that ends a search, and its length; chosen
_NO_LOCAL = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class LegPriors:
    """What is known before the legs, as standard deviations.

    Attributes:
        ship: of the ship's factors, (3,); zero holds one.
        sea_change: of the logarithms of height and peak period from one leg to the next, (2,); infinite where the legs
            have nothing to do with one another.
        shape: covariance of the departures from the assumed spectrum, the same in all legs, (j, j).
    """

    ship: Array
    sea_change: Array
    shape: Array = field(default_factory=lambda: np.empty((0, 0)))


@dataclass(frozen=True, eq=False)
class LegsInWaves:
    """A `LeastSquares` problem: the ship's factors (3,), departures of the spectrum (j,), then each leg's sea (3,)."""

    legs: tuple[WaveLeg, ...]
    priors: LegPriors

    @property
    def _shape_count(self) -> int:
        return len(self.priors.shape)

    @property
    def lower(self) -> Array:
        """Lower bounds."""
        ship, shape = np.where(self.priors.ship > 0.0, -_WIDEST_SHIP, 0.0), np.full(self._shape_count, -_WIDEST_SHAPE)
        return np.concatenate([ship, shape, *[_LOWEST_SEA] * len(self.legs)])

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        ship, shape = np.where(self.priors.ship > 0.0, _WIDEST_SHIP, 0.0), np.full(self._shape_count, _WIDEST_SHAPE)
        return np.concatenate([ship, shape, *[_HIGHEST_SEA] * len(self.legs)])

    def cost(self, shared: Array, local: Array) -> float:  # noqa: ARG002
        """Return minus the logarithm of the posterior, up to a constant."""
        ship, seas = _split(shared, len(self.legs))
        away = shared - self._prior_mean
        legs = sum(leg.likelihood(ship, sea)[0] for leg, sea in zip(self.legs, seas, strict=True))
        return legs + 0.5 * float(away @ self._precision @ away)

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return cost, gradient and Fisher information at a point."""
        ship, seas = _split(shared, len(self.legs))
        gradient, hessian = self._precision @ (shared - self._prior_mean), self._precision.copy()
        shape = np.arange(SHIP_COUNT, SHIP_COUNT + self._shape_count)
        for k, (leg, sea) in enumerate(zip(self.legs, seas, strict=True)):
            rows = np.r_[:SHIP_COUNT, _sea_slice(k, self._shape_count), shape]
            own_gradient, own_hessian = leg.equations(ship, sea)
            gradient[rows] += own_gradient
            hessian[np.ix_(rows, rows)] += own_hessian
        size = len(shared)
        return NormalEquations(
            self.cost(shared, local), gradient, hessian, _NO_LOCAL, np.zeros((0, 0, 0)), np.zeros((0, size, 0))
        )

    def start(self) -> Array:
        """Return the ship as the model has it, in the sea of the assumed spectrum that explains each leg best."""
        none = np.zeros(SHIP_COUNT)
        seas = [leg.start(none, PEAK_MEAN)[:SEA_COUNT] for leg in self.legs]
        return np.concatenate([none, np.zeros(self._shape_count), *seas])

    @property
    def _prior_mean(self) -> Array:
        return np.concatenate([np.zeros(SHIP_COUNT + self._shape_count), *[[0.0, 0.0, PEAK_MEAN]] * len(self.legs)])

    @property
    def _precision(self) -> Array:
        """Return the inverse of the covariance before the legs; the first sea's height and period are not known."""
        is_held = self.priors.ship <= 0.0
        ship = np.where(is_held, 0.0, 1.0 / np.where(is_held, 1.0, self.priors.ship) ** 2)
        seas = [np.array([0.0, 0.0, 1.0 / PEAK_DEVIATION**2])] * len(self.legs)
        precision = np.diag(np.concatenate([ship, np.zeros(self._shape_count), *seas]))
        shape = slice(SHIP_COUNT, SHIP_COUNT + self._shape_count)
        precision[shape, shape] = np.linalg.inv(self.priors.shape)
        change = np.diag(1.0 / self.priors.sea_change**2)
        for k in range(len(self.legs) - 1):
            starts = (_sea_slice(leg, self._shape_count).start for leg in (k, k + 1))
            one, other = (np.arange(start, start + len(change)) for start in starts)
            for first, second, sign in ((one, one, 1.0), (other, other, 1.0), (one, other, -1.0), (other, one, -1.0)):
                precision[np.ix_(first, second)] += sign * change
        return precision


@dataclass(frozen=True, eq=False)
class LegFit:
    """Ship and seas that the legs show.

    Attributes:
        ship: (3,), of `PLANT_FACTORS`; seas: (s, 3 + j), of `SEA_UNKNOWNS` and the departures from the assumed
            spectrum, which are the same in all, a row for each leg.
        covariance: of the ship's unknowns, the departures and then the seas' in turn, (3 + j + 3 s, 3 + j + 3 s).
        evidence: logarithm of the marginal likelihood by Laplace's method, up to a constant that is the same for all
            covariances of the departures (MacKay 1992, Neural Computation 4, 415-447, eq. (2.6)).
        is_converged: whether the search ended at the optimum.
    """

    ship: Array
    seas: Array
    covariance: Array
    evidence: float
    is_converged: bool

    @property
    def ship_deviations(self) -> Array:
        """Return standard deviations of the ship's factors, (3,)."""
        return np.sqrt(np.diag(self.covariance)[:SHIP_COUNT])

    def sea_deviations(self, leg: int) -> Array:
        """Return standard deviations of the unknowns of a leg's sea, (3,)."""
        return np.sqrt(np.diag(self.covariance)[_sea_slice(leg, len(self.departures))])

    @property
    def departures(self) -> Array:
        """Departures of the spectrum from the assumed one, (j,)."""
        return self.seas[0, SEA_COUNT:]

    @property
    def departure_evidence(self) -> float:
        """Return Wald's statistic of all departures together, at most chi-square of as many degrees of freedom."""
        rows = slice(SHIP_COUNT, SHIP_COUNT + len(self.departures))
        return float(self.departures @ np.linalg.solve(self.covariance[rows, rows], self.departures))

    def deviation(self, value: Callable[[Array, Array], float]) -> float:
        """Return the standard deviation of a value of ship (3,) and seas (s, 3 + j), to the first order."""
        centre, count = np.concatenate([self.ship, self.departures, self.seas[:, :SEA_COUNT].ravel()]), len(self.seas)
        ends = ([value(*_split(centre + sign * s, count)) for sign in (1.0, -1.0)] for s in STEP * np.eye(len(centre)))
        slope = np.array([up - down for up, down in ends]) / (2.0 * STEP)
        return float(np.sqrt(max(slope @ self.covariance @ slope, 0.0)))


def fit_legs(legs: Sequence[WaveLeg], priors: LegPriors) -> LegFit:
    """Return the ship and the seas that explain the legs, in order of time, best."""
    problem = LegsInWaves(tuple(legs), priors)
    optimum = levenberg_marquardt(problem, problem.start(), _NO_LOCAL, negligible=_NEGLIGIBLE, evaluations=_EVALUATIONS)
    free = np.flatnonzero(problem.upper > problem.lower)
    information = optimum.normal.hessian[np.ix_(free, free)]
    covariance = np.zeros((len(problem.lower), len(problem.lower)))
    covariance[np.ix_(free, free)] = inverse(information)
    spread = float(np.linalg.slogdet(information)[1] + np.linalg.slogdet(priors.shape)[1])
    is_converged = optimum.solution.status is Status.CONVERGED
    ship, seas = _split(optimum.solution.point, len(legs))
    return LegFit(ship, seas, covariance, -optimum.solution.value - 0.5 * spread, is_converged)


def _split(point: Array, legs: int) -> tuple[Array, Array]:
    """Return the ship's factors (3,) and the seas of the legs with the departures, (s, 3 + j)."""
    shape_end = len(point) - SEA_COUNT * legs
    shape = np.tile(point[SHIP_COUNT:shape_end], (legs, 1))
    return point[:SHIP_COUNT], np.hstack([point[shape_end:].reshape(legs, SEA_COUNT), shape])


def _sea_slice(leg: int, shape_count: int) -> slice:
    first = SHIP_COUNT + shape_count + SEA_COUNT * leg
    return slice(first, first + SEA_COUNT)
