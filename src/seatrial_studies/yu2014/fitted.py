"""Table 1 with what it leaves open fitted to it: nothing here is reproduced, and no number is called so.

Chosen: a sea spread by cos^2, without which the table's nearly equal headings are out of reach. Fitted to the GA's
column: K_q, and one factor on all rolls and fin rates (level). Fitted to the traditional PID's column, with these as
they are: its three gains, which the paper does not print.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from seatrial.core.values import Array
from seatrial.physics.loops import Performance
from seatrial.physics.loops.fin import Preamplifier
from seatrial_studies.yu2014.published import FOUND, LOWER, TABLE_1, UPPER, Column
from seatrial_studies.yu2014.readings import Motion, Sea, calibrated, motion, performance

_FAR = 5.0
SPREADING = 1.0
# starts of the baseline's search beside the GA's gains: its residuals have several valleys
_STARTS = (FOUND, np.array([10.0, 5.0, 80.0]), np.array([10.0, 45.0, 5.0]))


@dataclass(frozen=True, eq=False)
class Fitted:
    """One reading of the preamplifier and one sense of the heading.

    Attributes:
        following_is_zero: whether 0 deg in table 1 is a following sea; else a head sea.
        K_q, level: fitted; genetic: the GA's column so made, (6, 3) as `Column.logs`.
        baseline: gains fitted to the traditional PID's column; traditional: that column, (6, 3).
    """

    reading: Preamplifier
    following_is_zero: bool
    K_q: float
    level: float
    genetic: Array
    baseline: Array
    traditional: Array

    @property
    def error(self) -> float:
        """rms log error of the GA's column."""
        return _rms(self.genetic - _printed()[0])

    @property
    def baseline_error(self) -> float:
        """rms log error of the traditional PID's column."""
        return _rms(self.traditional - _printed()[1])

    @property
    def at_bounds(self) -> int:
        """How many of the baseline's gains stand at a bound of the paper's box."""
        return int(np.sum((self.baseline < 0.001 * UPPER) | (self.baseline > 0.999 * UPPER)))

    def sea(self, heading: float, speed: float) -> Sea:
        """A sea of table 1 as fitted."""
        return Sea(speed, heading if self.following_is_zero else 180.0 - heading, spreading=SPREADING)

    def column(self, made: Array, row: int) -> Column:
        """Numbers of one row of `genetic` or `traditional`."""
        roll, rate, left = np.exp(made[row])
        return Column(float(roll), float(rate), 100.0 * (1.0 - float(left)))


def fitted(reading: Preamplifier, *, following_is_zero: bool) -> Fitted:
    """Least squares of logarithms, twice."""
    printed, traditional = _printed()

    def off(x: Array) -> Array:
        return (_column(_seas(reading, math.exp(x[0]), following_is_zero), FOUND, math.exp(x[1])) - printed).ravel()

    start = np.array([math.log(calibrated(reading)), math.log(0.5)])
    found = least_squares(off, start, diff_step=(1e-4, 1e-4), xtol=1e-6)
    K_q, level = (float(v) for v in np.exp(found.x))
    seas = _seas(reading, K_q, following_is_zero)
    baseline = _baseline(seas, level, traditional)
    made, other = _column(seas, FOUND, level), _column(seas, baseline, level)
    return Fitted(reading, following_is_zero, K_q, level, made, baseline, other)


def _baseline(seas: list[Performance], level: float, printed: Array) -> Array:
    """Gains of the traditional PID within the paper's box."""

    def off(share: Array) -> Array:
        return (_column(seas, LOWER + share * (UPPER - LOWER), level) - printed).ravel()

    found = [
        least_squares(off, np.clip((s - LOWER) / (UPPER - LOWER), 0.01, 0.99), bounds=(0.0, 1.0), xtol=1e-6)
        for s in _STARTS
    ]
    best = min(found, key=lambda result: float(result.cost))
    return LOWER + np.asarray(best.x) * (UPPER - LOWER)


def _seas(reading: Preamplifier, K_q: float, following_is_zero: bool) -> list[Performance]:
    made = []
    for row in TABLE_1:
        heading = row.heading if following_is_zero else 180.0 - row.heading
        made.append(performance(reading, Sea(row.speed, heading, spreading=SPREADING), K_q))
    return made


def _column(seas: list[Performance], gains: Array, level: float) -> Array:
    """Logarithms of roll, rate and what is left, (6, 3); far off where a loop is unstable."""
    return np.stack([_logs(motion(of, gains), level) for of in seas])


def _logs(made: Motion, level: float) -> Array:
    if not math.isfinite(made.peak):
        return np.full(3, _FAR)
    return np.log([level * made.roll, level * made.rate, made.roll / made.free])


def _printed() -> tuple[Array, Array]:
    return np.stack([row.genetic.logs for row in TABLE_1]), np.stack([row.traditional.logs for row in TABLE_1])


def _rms(off: Array) -> float:
    return math.sqrt(float(np.mean(off**2)))


def best_of(all_fitted: tuple[Fitted, ...], reading: Preamplifier) -> Fitted:
    """The sense of the heading with the smaller error."""
    return min((f for f in all_fitted if f.reading is reading), key=lambda f: f.error)
