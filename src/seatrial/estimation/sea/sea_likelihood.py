"""The likelihood of a whole stretch's motion in a sea of unknown heading, and draws of ship and sea by it."""

import math
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.problem.spectral_likelihood import hann_leakage
from seatrial.estimation.sea.wave_leg import PEAK_DEVIATION, PEAK_MEAN, altered_responses, sea_spectrum
from seatrial.physics.hydro.excitation import Complex, G, encounter_frequency
from seatrial.physics.loops import TransferLoop, WaveEffect
from seatrial.physics.sea.spectrum import speed_factor

if TYPE_CHECKING:
    from scipy.sparse import csr_array


# What the transform of a whole stretch shows of waves: a matrix from bands of wave frequency, for each heading.

BAND = 0.01  # relative width of a band: a seventh of the width of JONSWAP's peak, 0.07 (Hasselmann et al. 1973); chosen
_LONGEST, _SHORTEST = 0.5, 4.0  # wave frequencies over the ends of the transform's that are looked at; chosen
_NODES_A_BIN = 3.0  # nodes for each bin of the transform that a band covers, at least; chosen
_WINDOW_POWER = 1.5  # mean of a Hann window's square over the square of its mean: the area under its leakage, in bins
_PLACES_A_BIN = 256  # at which leakage is tabulated: within 1 % of a node's own down to a tenth of the largest; chosen
_LEAKAGE_BINS = 6  # bins either way in which a node shows: beyond them less than 3e-6 of its energy; chosen


@dataclass(frozen=True, eq=False)
class TransformBins:
    """Bins of a stretch's transform: omega (k,) [rad/s], `stride` of the transform's steps [rad/s] apart."""

    omega: Array
    step: float
    stride: int


def band_edges(omega: Array, effect: WaveEffect) -> Array:
    """Return edges of the bands of wave frequency (n + 1,) [rad/s], evenly spaced in logarithm.

    omega: (k,), rad/s, of the transform; effect: of the waves, whose range bounds the bands.
    """
    longest, shortest = effect.frequency_range
    low, high = max(_LONGEST * float(omega[0]), longest), min(_SHORTEST * float(omega[-1]), shortest)
    return np.exp(math.log(low) + BAND * np.arange(math.ceil(math.log(high / low) / BAND) + 1))


def encounter_matrix(bins: TransformBins, edges: Array, U: float, headings: Array, effect: WaveEffect) -> "csr_array":
    """Return the density at k bins of the disturbance for unit density of waves in each band, (k, n), sparse.

    edges: (n + 1,), rad/s; U: m/s; headings: (h,), rad, 0 following; the mean over them is returned.

    Raises:
        InputError: speed or heading out of sense.
    """
    from scipy.sparse import csr_array

    step, leakage = bins.step, _leakage()
    last = bins.stride * (len(bins.omega) - 1)
    rows, columns, values = [], [], []
    for beta in headings.tolist():
        speed_factor(U, beta)  # refuses what is out of sense
        band, omega, width = _nodes(edges, U, beta, step)
        places = (np.abs(encounter_frequency(omega, U, beta)) - bins.omega[0]) / step
        share = width / (_WINDOW_POWER * step * len(headings))
        energy = np.abs(effect.amplitude(omega, U, beta)) ** 2 * share
        near = np.rint(places).astype(int)
        shows = (near > -_LEAKAGE_BINS) & (near < last + _LEAKAGE_BINS)
        row = near[shows, None] + np.arange(-_LEAKAGE_BINS, _LEAKAGE_BINS + 1)
        part = np.rint((places - near + 0.5)[shows] * _PLACES_A_BIN).astype(int)
        value = leakage[part] * energy[shows, None]
        inside = (row >= 0) & (row <= last) & (row % bins.stride == 0)
        rows.append(row[inside] // bins.stride)
        columns.append(np.broadcast_to(band[shows, None], row.shape)[inside])
        values.append(value[inside])
    cells = np.concatenate(rows), np.concatenate(columns)
    return csr_array((np.concatenate(values), cells), shape=(len(bins.omega), len(edges) - 1))


@cache
def _leakage() -> Array:
    """Return what the bins about the nearest one show of a node, half a bin below that to half a bin above, (p, 13)."""
    places = np.arange(_PLACES_A_BIN + 1) / _PLACES_A_BIN - 0.5
    return hann_leakage(np.arange(-_LEAKAGE_BINS, _LEAKAGE_BINS + 1) - places[:, None])


def _nodes(edges: Array, U: float, beta: float, step: float) -> tuple[Index, Array, Array]:
    """Return each node's band, its frequency and width [rad/s], (p,), met at most a third of a bin apart."""
    met = encounter_frequency(edges, U, beta)
    counts = np.maximum(np.ceil(_NODES_A_BIN * np.abs(np.diff(met)) / step), 1.0).astype(int)
    band = np.repeat(np.arange(len(counts)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    width = (np.diff(edges) / counts)[band]
    return band, edges[band] + (np.arange(len(band)) - first + 0.5) * width, width


# The likelihood of a whole stretch's motion in a sea of unknown heading, for many ships and seas at once (Whittle).

# logarithm of the steepness 2 pi H / (g T^2), H significant height, T peak period, before the stretch: 0.02 lies
# between swell and the Pierson-Moskowitz sea's 0.026, 95 % from 0.0075 to 0.053, short of the 1/15 at which seas
# break (DNV-RP-C205, 3.5.4); chosen
_STEEPNESS_MEAN, _STEEPNESS_DEVIATION = math.log(0.02), 0.5
# logarithm of a density that neither sea nor sensor explains (gusts, a motion that is not linear) over the largest,
# before the stretch: 95 % from 1e-8 to 1e-2; chosen
_REST_MEAN, _REST_DEVIATION = math.log(1e-5), 1.5 * math.log(10.0)
_LEAST_PERIOD, _GREATEST_PERIOD = 0.3, 3.0  # peak periods over the one expected that are looked at; chosen
HEADING_CELL = math.pi / 180.0  # rad, within which headings are not distinguished: what a helmsman keeps; chosen
_HEADINGS_A_CELL = 3  # from edge to edge, whose mean a cell shows: no craft keeps its heading to a tenth; chosen
_SEARCH_STEPS = 6  # of the height's optimum, from the energy of the motion; chosen
_HEIGHTS = math.log(1e-3), math.log(100.0)  # logarithms of heights [m] that are looked at; chosen: more than seas have
_TABLE = np.exp(BAND * np.arange(-140, 301))  # frequencies over the peak's of tabulated spectra: 0.25 to 20; chosen
_PEAKS = np.linspace(-5.0, 5.0, 101)  # log(gamma - 1) of tabulated spectra, in deviations from the mean; chosen

BIN_STRIDE = 2
"""Every second bin of the transform is looked at: with a Hann window these are nearly independent of each other."""
# a Hann window correlates bins two apart by 1/6 (Harris 1978, Proc. IEEE 66, 51-83), so that sums over them have this
# times the variance of independent ones: 1 + 2 (1/6)^2
_CORRELATION = 1.0 + 2.0 / 36.0

HEADING, PERIOD, SHIP, PEAK, REST = 0, 1, slice(2, 5), 5, 6
"""Columns of points: rad; logarithm of the peak period; ship's factors, peak and rest as standard normal numbers."""
POINT_SIZE = REST + 1
NORMAL_SIZE = POINT_SIZE - SHIP.start
NORMAL = slice(2, POINT_SIZE)
"""Columns that are standard normal before the stretch, and how many there are."""


@dataclass(frozen=True, eq=False)
class MotionSpectrum:
    """What a whole stretch shows, whatever sea it was in, at every second frequency of its transform.

    Attributes:
        omega: (k,), rad/s; step: between two frequencies of the transform, rad/s.
        density: of the output, |transform|^2, (k,); controller: K of a = -K y, (k,).
        independent_actuator: density of what the actuator does besides following the output, (k,).
        noise: density of the sensor that the controller follows.
    """

    omega: Array
    step: float
    density: Array
    controller: Complex
    independent_actuator: Array
    noise: float


@dataclass(frozen=True, eq=False)
class Heights:
    """For each point the optimal logarithm of the height [m], its deviation, and the logarithm of the evidence."""

    optimum: Array
    deviation: Array
    evidence: Array


@dataclass(frozen=True, eq=False)
class SeaLikelihood:
    """The evidence of points (m, 7), the height integrated by its normal approximation (Tierney & Kadane 1986).

    Attributes:
        motion: of the stretch; loop: its plant and disturbance are those at the speed U [m/s].
        effect: of the waves; expected_period: s, of the sea's peak.
        deviations: of the ship's factors before the stretch, (3,), logarithms.
    """

    motion: MotionSpectrum
    loop: TransferLoop
    U: float
    effect: WaveEffect
    expected_period: float
    deviations: Array

    @property
    def periods(self) -> tuple[float, float]:
        """Return the ends of the logarithms of the peak period that are looked at."""
        return math.log(_LEAST_PERIOD * self.expected_period), math.log(_GREATEST_PERIOD * self.expected_period)

    def heights(self, points: Array) -> Heights:
        """Return what each point (m, 7) makes of the stretch; evidence is minus infinity outside what is looked at."""
        low, high = self.periods
        beta, period = points[:, HEADING], points[:, PERIOD]
        inside = (beta > 0.0) & (beta < math.pi) & (period > low) & (period < high)
        kept = points[inside]
        heights = self._heights(*self._densities(kept), kept[:, PERIOD])
        columns = [np.full(len(points), missing) for missing in (0.0, 1.0, -np.inf)]
        for column, part in zip(columns, (heights.optimum, heights.deviation, heights.evidence), strict=True):
            column[inside] = part
        return Heights(*columns)

    def _densities(self, points: Array) -> tuple[Array, Array]:
        """Return the density of the output in waves of 1 m, and that which is not of the waves, (m, k) each."""
        factors, omega = self.deviations * points[:, SHIP], self.motion.omega
        P = np.exp(factors[:, :1]) * altered_responses(self.loop.plant, omega, factors[:, 1:])
        D = altered_responses(self.loop.disturbance, omega, factors[:, 1:])
        left = 1.0 / _energy(1.0 + P * self.motion.controller)
        rest = np.exp(_REST_MEAN + _REST_DEVIATION * points[:, [REST]]) * np.max(self.motion.density)
        rest = rest + self.motion.noise + _energy(P) * self.motion.independent_actuator
        return left * _energy(D) * self._shown_waves(points), left * rest

    def _shown_waves(self, points: Array) -> Array:
        """Return the density of the disturbance in waves of 1 m, (m, k)."""
        waves, shown = self._wave_density(points), np.empty((len(points), len(self.motion.omega)))
        cells = (points[:, HEADING] / HEADING_CELL).astype(int)
        order = np.argsort(cells, kind="stable")
        for group in np.split(order, np.flatnonzero(np.diff(cells[order])) + 1):
            shown[group] = (self._matrix(int(cells[group[0]])) @ waves[group].T).T
        return shown

    @cached_property
    def _edges(self) -> Array:
        return band_edges(self.motion.omega, self.effect)

    @cached_property
    def _bins(self) -> TransformBins:
        return TransformBins(self.motion.omega, self.motion.step, BIN_STRIDE)

    @cached_property
    def _matrices(self) -> dict[int, "csr_array"]:
        return {}

    def _matrix(self, cell: int) -> "csr_array":
        """Return what transforms show of the waves at the headings of a cell; made when it is first needed."""
        if cell not in self._matrices:
            headings = np.linspace(cell, cell + 1.0, _HEADINGS_A_CELL) * HEADING_CELL
            self._matrices[cell] = encounter_matrix(self._bins, self._edges, self.U, headings, self.effect)
        return self._matrices[cell]

    @cached_property
    def _log_shapes(self) -> Array:
        """Return logarithms of densities of seas of 1 m with their peak at 1 rad/s, at `_PEAKS` and `_TABLE`."""
        peaks = PEAK_MEAN + PEAK_DEVIATION * _PEAKS
        return np.log([sea_spectrum(np.array([0.0, math.log(2.0 * math.pi), peak])).density(_TABLE) for peak in peaks])

    def _wave_density(self, points: Array) -> Array:
        """Return the density of waves of 1 m in each band, (m, n); zero beyond the table."""
        log_peak = math.log(2.0 * math.pi) - points[:, PERIOD]
        first = (math.log(self._edges[0]) + 0.5 * BAND - log_peak - math.log(_TABLE[0])) / BAND
        place, share = np.divmod(first, 1.0)
        rows = np.interp(points[:, PEAK], _PEAKS, np.arange(len(_PEAKS)))
        row, part = np.divmod(np.minimum(rows, np.nextafter(len(_PEAKS) - 1.0, 0.0)), 1.0)
        columns = place[:, None].astype(int) + np.arange(len(self._edges) - 1)
        inside = (columns >= 0) & (columns < len(_TABLE) - 1)
        columns, at = np.where(inside, columns, 0), row[:, None].astype(int)
        share, part = share[:, None], part[:, None]
        log_density = sum(
            a * b * self._log_shapes[at + i, columns + j]
            for i, a in enumerate((1.0 - part, part)) for j, b in enumerate((1.0 - share, share))
        )  # fmt: skip
        return np.where(inside, np.exp(log_density - log_peak[:, None]), 0.0)

    def _heights(self, density: Array, rest: Array, periods: Array) -> Heights:
        """Return the heights H of which H^2 density + rest, (m, k), explains the stretch, by Fisher scoring."""
        observed, information = self.motion.density, 1.0 / _CORRELATION
        density = np.maximum(density, np.finfo(np.float64).tiny)
        expected = _STEEPNESS_MEAN - math.log(2.0 * math.pi / G) + 2.0 * periods
        x = np.clip(0.5 * np.log(np.sum(observed) / np.sum(density, axis=1)), *_HEIGHTS)
        precision = np.ones_like(x)
        for _ in range(_SEARCH_STEPS):
            total = np.exp(2.0 * x)[:, None] * density + rest
            slope = 2.0 * (1.0 - rest / total)
            precision = information * np.sum(slope**2, axis=1) + _STEEPNESS_DEVIATION**-2
            gradient = information * np.sum(slope * (1.0 - observed / total), axis=1)
            x = np.clip(x - (gradient + (x - expected) * _STEEPNESS_DEVIATION**-2) / precision, *_HEIGHTS)
        total = np.exp(2.0 * x)[:, None] * density + rest
        cost = information * np.sum(np.log(total) + observed / total, axis=1)
        cost += 0.5 * ((x - expected) / _STEEPNESS_DEVIATION) ** 2
        return Heights(x, precision**-0.5, -cost - 0.5 * np.log(precision))


def _energy(response: Complex) -> Array:
    return np.asarray(response.real**2 + response.imag**2, dtype=np.float64)


# Ship and sea of one stretch when the heading to the waves is not known either: draws of all that the motion allows.

_FIRST = 4096  # points that the population is drawn from: more than 20 for each degree of heading; chosen
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # step of the periods: multiples spread evenly over 0 to 1 (Kronecker)
_MEMBERS = 384  # of the population, even; chosen: many times its unknowns, so that none of several headings is lost
_KEPT_WEIGHT = 0.5  # share of the members that a rise of the power leaves; Jasra et al. 2011
_MOVES = 2  # generations at each power; chosen
# generations at one, every so many of which are kept after the first: from seed to seed means then differ by some 0.15
# of their deviations; chosen
_SETTLING, _GENERATIONS, _EVERY = 12, 60, 4
_DIFFERENCE = 2.38  # times the difference of two members, over the root of twice the unknowns; ter Braak 2006, eq. (2)
_STRETCHED = 0.5  # deviation of the logarithm of a factor on it: modes differ in width; chosen
_JUMPS, _JITTER = 0.1, 1e-4  # share of steps of a whole difference, from peak to peak; of every step, random; ter Braak
# shares of the unknowns that a step moves, one of them at random (crossover: Vrugt et al. 2009, International Journal
# of Nonlinear Sciences and Numerical Simulation 10, 273-290)
_CROSSOVERS = (0.3, 0.6, 1.0)
_BISECTIONS = 40  # of the next power: to 1e-12; chosen


@dataclass(frozen=True, eq=False)
class ShipInSea:
    """Draws: headings [rad] (n,), of `PLANT_FACTORS` (n, 3), and of `SEA_UNKNOWNS` (n, 3)."""

    headings: Array
    ships: Array
    seas: Array


@dataclass(frozen=True, eq=False)
class _Population:
    """Members: points (n, 7), evidence (n,), optimum and deviation of the height's logarithm, (n,)."""

    points: Array
    evidence: Array
    optimum: Array
    deviation: Array

    def chosen(self, places: Index) -> "_Population":
        """Return the members at these places."""
        return _Population(*(part[places] for part in vars(self).values()))

    def stepped(self, likelihood: SeaLikelihood, power: float, rng: np.random.Generator) -> "_Population":
        """Return the next generation: each half moves by differences of two members of the other."""
        first, second = np.split(np.arange(len(self.points)), 2)
        halfway = self._moved(first, second, likelihood, power, rng)
        return halfway._moved(second, first, likelihood, power, rng)

    def _moved(
        self, movers: Index, partners: Index, likelihood: SeaLikelihood, power: float, rng: np.random.Generator
    ) -> "_Population":
        """Return the population with the movers where Metropolis' rule takes them."""
        here, count = self.points[movers], len(movers)
        one = rng.integers(count, size=count)
        other = (one + rng.integers(1, count, size=count)) % count
        scale = _DIFFERENCE / math.sqrt(2.0 * POINT_SIZE) * np.exp(_STRETCHED * rng.standard_normal(count))
        scale = np.where(rng.random(count) < _JUMPS, 1.0, scale)
        moves = rng.random(here.shape) < rng.choice(_CROSSOVERS, size=(count, 1))
        step = scale[:, None] * (self.points[partners[one]] - self.points[partners[other]]) * moves
        there = here + step + _JITTER * rng.standard_normal(here.shape)
        heights = likelihood.heights(there)
        gain = power * (heights.evidence - self.evidence[movers])
        gain += 0.5 * (np.sum(here[:, NORMAL] ** 2, axis=1) - np.sum(there[:, NORMAL] ** 2, axis=1))
        accepted = np.log(rng.random(count)) < gain
        moved = _Population(*(part.copy() for part in vars(self).values()))
        moved.points[movers[accepted]] = there[accepted]
        for name in ("evidence", "optimum", "deviation"):
            getattr(moved, name)[movers[accepted]] = getattr(heights, name)[accepted]
        return moved


def draw_ship_in_sea(likelihood: SeaLikelihood, rng: np.random.Generator) -> ShipInSea:
    """Return draws of heading, ship and sea that a stretch allows, in the order in which they were made."""
    population, power = _first_points(likelihood, rng), 0.0
    population, power = _raised(population, power, _MEMBERS, rng)
    while power < 1.0:
        for _ in range(_MOVES):
            population = population.stepped(likelihood, power, rng)
        population, power = _raised(population, power, round(_KEPT_WEIGHT * _MEMBERS), rng)
    kept = []
    for generation in range(_GENERATIONS):
        population = population.stepped(likelihood, 1.0, rng)
        if generation >= _SETTLING and generation % _EVERY == 0:
            kept.append(population)
    points, optimum, deviation = (
        np.concatenate([getattr(one, name) for one in kept]) for name in ("points", "optimum", "deviation")
    )
    height = optimum + deviation * rng.standard_normal(len(points))
    seas = np.column_stack([height, points[:, PERIOD], PEAK_MEAN + PEAK_DEVIATION * points[:, PEAK]])
    # a cell of headings is all that the likelihood resolves: the truth may lie half a cell to either side
    headings = np.clip(points[:, HEADING] + HEADING_CELL * (rng.random(len(points)) - 0.5), 0.0, math.pi)
    return ShipInSea(headings, likelihood.deviations * points[:, SHIP], seas)


def _first_points(likelihood: SeaLikelihood, rng: np.random.Generator) -> _Population:
    """Return points drawn from what was known before the stretch, heading and period evenly (a lattice of rank 1)."""
    index = np.arange(_FIRST)
    places = np.column_stack([(index + 0.5) / _FIRST, (_GOLDEN * index + rng.random()) % 1.0])
    low, high = likelihood.periods
    normal = rng.standard_normal((_FIRST, NORMAL_SIZE))
    points = np.column_stack([math.pi * places[:, 0], low + (high - low) * places[:, 1], normal]).astype(np.float64)
    heights = likelihood.heights(points)
    return _Population(points, heights.evidence, heights.optimum, heights.deviation)


def _raised(population: _Population, power: float, wanted: int, rng: np.random.Generator) -> tuple[_Population, float]:
    """Return `_MEMBERS` drawn for the largest power up to one that leaves so many of equal weight, and that power."""
    low, high = power, 1.0
    if _equal_members((1.0 - power) * population.evidence) >= wanted:
        low = 1.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        is_kept = _equal_members((middle - power) * population.evidence) >= wanted
        low, high = (middle, high) if is_kept else (low, middle)
    places = _resampled((low - power) * population.evidence, _MEMBERS, rng)
    return population.chosen(rng.permutation(places)), low


def _equal_members(log_weight: Array) -> float:
    """Return how many members of equal weight the weights are worth (Kong, Liu & Wong 1994, JASA 89, 278)."""
    weight = np.exp(log_weight - np.max(log_weight))
    return float(np.sum(weight) ** 2 / np.sum(weight**2))


def _resampled(log_weight: Array, count: int, rng: np.random.Generator) -> Index:
    """Return places drawn by weight, (count,), at even steps of the cumulated weight (systematic resampling)."""
    cumulated = np.cumsum(np.exp(log_weight - np.max(log_weight)))
    steps = (np.arange(count) + rng.random()) / count
    return np.minimum(np.searchsorted(cumulated, steps * cumulated[-1]), len(cumulated) - 1)
