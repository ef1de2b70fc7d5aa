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
from seatrial.physics.loops import Performance, Preamplifier
from seatrial_studies.yu2014.published import LOWER, PUBLISHED_VALUES, TABLE_1, UPPER, ControllerResult
from seatrial_studies.yu2014.published_loop import (
    RollResponse,
    SeaCondition,
    calibrated_K_q,
    performance,
    roll_response,
)

_UNSTABLE_LOG = 5.0
SPREADING = 1.0
# starts of the baseline's search beside the GA's gains: its residuals have several valleys
_BASELINE_STARTS = (PUBLISHED_VALUES, np.array([10.0, 5.0, 80.0]), np.array([10.0, 45.0, 5.0]))


@dataclass(frozen=True, eq=False)
class Table1Fit:
    """One reading of the preamplifier and one sense of the heading.

    Attributes:
        following_is_zero: whether 0 deg in table 1 is a following sea; else a head sea.
        K_q, level: fitted; genetic: the GA's column so made, (6, 3) as `Column.logs`.
        baseline: gains fitted to the traditional PID's column; traditional: that column, (6, 3).
    """

    preamplifier: Preamplifier
    following_is_zero: bool
    K_q: float
    level: float
    genetic: Array
    baseline: Array
    traditional: Array

    @property
    def log_error(self) -> float:
        """rms log error of the GA's column."""
        return _rms(self.genetic - _printed_logs()[0])

    @property
    def baseline_log_error(self) -> float:
        """rms log error of the traditional PID's column."""
        return _rms(self.traditional - _printed_logs()[1])

    @property
    def gains_at_bounds(self) -> int:
        """How many of the baseline's gains stand at a bound of the paper's box."""
        return int(np.sum((self.baseline < 0.001 * UPPER) | (self.baseline > 0.999 * UPPER)))

    def sea(self, heading: float, speed: float) -> SeaCondition:
        """Return a sea of table 1 as fitted."""
        return SeaCondition(speed, heading if self.following_is_zero else 180.0 - heading, spreading=SPREADING)

    def row_result(self, log_values: Array, row: int) -> ControllerResult:
        """Numbers of one row of `genetic` or `traditional`."""
        roll, rate, left = np.exp(log_values[row])
        return ControllerResult(float(roll), float(rate), 100.0 * (1.0 - float(left)))


def fit_table_1(preamplifier: Preamplifier, *, following_is_zero: bool) -> Table1Fit:
    """Fit K_q and the level to the GA's column, then the baseline's gains, by least squares of logarithms."""
    printed, traditional = _printed_logs()

    def residuals(x: Array) -> Array:
        return (
            _table_1_logs(
                _table_1_seas(preamplifier, math.exp(x[0]), following_is_zero), PUBLISHED_VALUES, math.exp(x[1])
            )
            - printed
        ).ravel()

    start = np.array([math.log(calibrated_K_q(preamplifier)), math.log(0.5)])
    found = least_squares(residuals, start, diff_step=(1e-4, 1e-4), xtol=1e-6)
    K_q, level = (float(v) for v in np.exp(found.x))
    seas = _table_1_seas(preamplifier, K_q, following_is_zero)
    baseline = _fit_baseline(seas, level, traditional)
    made, other = _table_1_logs(seas, PUBLISHED_VALUES, level), _table_1_logs(seas, baseline, level)
    return Table1Fit(preamplifier, following_is_zero, K_q, level, made, baseline, other)


def _fit_baseline(seas: list[Performance], level: float, printed: Array) -> Array:
    """Gains of the traditional PID within the paper's box."""

    def residuals(share: Array) -> Array:
        return (_table_1_logs(seas, LOWER + share * (UPPER - LOWER), level) - printed).ravel()

    found = [
        least_squares(residuals, np.clip((s - LOWER) / (UPPER - LOWER), 0.01, 0.99), bounds=(0.0, 1.0), xtol=1e-6)
        for s in _BASELINE_STARTS
    ]
    best = min(found, key=lambda result: float(result.cost))
    return LOWER + np.asarray(best.x) * (UPPER - LOWER)


def _table_1_seas(preamplifier: Preamplifier, K_q: float, following_is_zero: bool) -> list[Performance]:
    made = []
    for row in TABLE_1:
        heading = row.heading if following_is_zero else 180.0 - row.heading
        made.append(performance(preamplifier, SeaCondition(row.speed, heading, spreading=SPREADING), K_q))
    return made


def _table_1_logs(seas: list[Performance], gains: Array, level: float) -> Array:
    """Logarithms of roll, rate and what is left, (6, 3); far off where a loop is unstable."""
    return np.stack([_response_logs(roll_response(of, gains), level) for of in seas])


def _response_logs(response: RollResponse, level: float) -> Array:
    if not math.isfinite(response.Ms):
        return np.full(3, _UNSTABLE_LOG)
    return np.log([level * response.roll, level * response.rate, response.roll / response.uncontrolled])


def _printed_logs() -> tuple[Array, Array]:
    return np.stack([row.genetic.log_values for row in TABLE_1]), np.stack(
        [row.traditional.log_values for row in TABLE_1]
    )


def _rms(errors: Array) -> float:
    return math.sqrt(float(np.mean(errors**2)))


def best_fit_of(fits: tuple[Table1Fit, ...], preamplifier: Preamplifier) -> Table1Fit:
    """Return the sense of the heading with the smaller error."""
    return min((f for f in fits if f.preamplifier is preamplifier), key=lambda f: f.log_error)
