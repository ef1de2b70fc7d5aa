"""The likelihood of a whole stretch's motion in a sea of unknown heading, for many ships and seas at once (Whittle).

The output is S (D w + P e + n), S = 1 / (1 + P K): waves w through the ship's response D, what the actuator does
besides following the output, a = -K y + e, through the plant P, and the sensor's noise n, which the controller follows,
too (identification in closed loop: Ljung 1999, System Identification, section 13.4). One transform is taken of the
whole stretch: in following seas waves of many frequencies gather at the largest frequency of encounter, and short
segments would smear that over bins that then count as independent, though they show the same waves.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.sea.encounter_matrix import BAND, TransformBins, band_edges, encounter_matrix
from seatrial.estimation.sea.encountered_sea import sea_spectrum
from seatrial.estimation.sea.legs_in_waves import PEAK_DEVIATION, PEAK_MEAN
from seatrial.estimation.sea.plant_factors import altered_responses
from seatrial.physics.hydro.excitation import Complex, G
from seatrial.physics.loops import TransferLoop, WaveEffect

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# logarithm of the steepness 2 pi H / (g T^2), H significant height, T peak period, before the stretch: 0.02 lies
# between swell and the Pierson-Moskowitz sea's 0.026, 95 % from 0.0075 to 0.053, short of the 1/15 at which seas
# break (DNV-RP-C205, 3.5.4); chosen
_STEEPNESS_MEAN, _STEEPNESS_DEVIATION = math.log(0.02), 0.5
# logarithm of a density that neither sea nor sensor explains (gusts, a motion that is not linear) over the largest,
# before the stretch: 95 % from 1e-8 to 1e-2; chosen
_REST_MEAN, _REST_DEVIATION = math.log(1e-5), 1.5 * math.log(10.0)
_SHORTEST, _LONGEST = 0.3, 3.0  # peak periods over the one expected that are looked at; chosen
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
        return math.log(_SHORTEST * self.expected_period), math.log(_LONGEST * self.expected_period)

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
