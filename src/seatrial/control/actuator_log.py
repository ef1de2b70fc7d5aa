"""What a log of ordered and actual angles shows of an actuator: its largest rate, dead time and lag."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from seatrial.core.results.coefficients import two_sided_quantile
from seatrial.core.values import Array, InputError, Record
from seatrial.core.values.notation import channel_meaning, display_unit
from seatrial.estimation.information.whiteness import autocorrelation, variance_inflation

ORDER_SUFFIX = "_ref"
"""Ending of the channel of an actuator's order: ``delta_ref`` of ``delta``."""
_RATE_QUANTILE = 0.99  # of the measured rates, from which the search for the largest begins; chosen
_RATE_SPAN = 3.0  # of the logarithm of the largest rate to either side of that, bounds of the search; chosen
_DEAD_TIMES, _LAGS = (0.2, 1.0, 3.0), (0.3, 1.0, 3.0)  # s, from which the search begins; chosen
_LEAST_LAG, _LARGEST_DEAD_TIME = 1e-3, 30.0  # s, bounds of the search; chosen
_DIFFERENCE = 1e-3  # of an unknown, of the slopes of residuals that interpolate the order; chosen
_SHOWN = 0.02  # share of samples at the largest rate from which on the log shows one; chosen
_MOVES = 20.0  # range of the order over the scatter of what is explained, from which on it moves; chosen
_LEVEL = 0.95  # of the intervals, as everywhere
_EDGE = 1e-9  # share of the largest rate within which it is reached: rounding


@dataclass(frozen=True)
class ActuatorResponse:
    """An actuator that follows its order by a lag after a dead time, no faster than its largest rate.

    y' = clip((u(t - dead_time) - y) / lag, -rate, rate); SI, half widths of 95 % intervals behind each.

    Attributes:
        rate: nan where the log never reaches one.
        scatter: rms of what the response leaves of the angle.
    """

    rate: float
    rate_error: float
    dead_time: float
    dead_time_error: float
    lag: float
    lag_error: float
    scatter: float

    def sentence(self, actuator: str) -> str:
        """Return what the log shows in a sentence."""
        factor, unit = display_unit("rad")
        rate = "no largest rate is reached"
        if math.isfinite(self.rate):
            rate = f"largest rate {self.rate * factor:.3g} ± {self.rate_error * factor:.2g} {unit}/s"
        return (
            f"{channel_meaning(actuator)} by its log: {rate}, dead time {self.dead_time:.3g} ± "
            f"{self.dead_time_error:.2g} s, lag {self.lag:.3g} ± {self.lag_error:.2g} s"
        )


def simulated_angles(time: Array, order: Array, first: float, rate: float, dead_time: float, lag: float) -> Array:
    """Return the angles (n,) of an actuator from its order (n,) at times (n,) [s], beginning at `first`.

    Each step is exact for the order of its middle, straight between samples: its mean where it changes at any moment.
    """
    late = np.interp(0.5 * (time[1:] + time[:-1]) - dead_time, time, order)
    angles = [first]
    for step, target in zip(np.diff(time).tolist(), late.tolist(), strict=True):
        gap = target - angles[-1]
        left = max(step - max(abs(gap) / rate - lag, 0.0), 0.0)  # s, of the step once the lag alone limits the rate
        move = rate * (step - left) + min(abs(gap), rate * lag) * -math.expm1(-left / lag)
        angles.append(angles[-1] + math.copysign(move, gap))
    return np.array(angles)


def actuator_response(records: Sequence[Record], actuator: str) -> ActuatorResponse:
    """Return the response of least squares over records with an actuator's angle and its order.

    Intervals are those of independent samples, widened by the correlation of the residuals (Sokal 1997); that of the
    dead time by half a sample, too, as the order may change at any moment between two.

    Raises:
        InputError: no record holds both channels, or the order hardly moves.
    """
    wanted = actuator + ORDER_SUFFIX
    runs = [(one.time, one[wanted], one[actuator]) for one in records if wanted in one and actuator in one]
    if not runs:
        raise InputError(
            f"no run of the log holds the order '{wanted}' and the angle '{actuator}'; declare the column of the order "
            f"as {wanted}"
        )
    fastest = max(float(np.quantile(np.abs(np.diff(angle) / np.diff(time)), _RATE_QUANTILE)) for time, _, angle in runs)
    if not fastest > 0.0:
        raise InputError(f"'{actuator}' stands still in the log; give a stretch in which it follows its order")

    def residuals(unknowns: Array) -> Array:
        rate, lag = np.exp(unknowns[[0, 2]])
        apart = [angle - simulated_angles(time, order, angle[0], rate, unknowns[1], lag) for time, order, angle in runs]
        return np.concatenate([one - np.mean(one) for one in apart])  # an offset of the sensor is no response

    bounds = (
        [math.log(fastest) - _RATE_SPAN, 0.0, math.log(_LEAST_LAG)],
        [math.log(fastest) + _RATE_SPAN, _LARGEST_DEAD_TIME, math.log(_LARGEST_DEAD_TIME)],
    )
    starts = [np.array([math.log(fastest), dead, math.log(lag)]) for dead, lag in product(_DEAD_TIMES, _LAGS)]
    start = min(starts, key=lambda unknowns: float(np.sum(residuals(unknowns) ** 2)))
    solution = least_squares(residuals, start, bounds=bounds, diff_step=np.full(3, _DIFFERENCE))
    scatter = float(np.std(solution.fun))
    if max(float(np.ptp(order)) for _, order, _ in runs) < _MOVES * scatter:
        raise InputError(f"'{actuator}' does not follow '{wanted}' in the log; are both channels named rightly?")
    rate, lag = np.exp(solution.x[[0, 2]]).tolist()
    is_reached = _share_at_rate(runs, rate, solution.x[1], lag) >= _SHOWN
    places = np.arange(3) if is_reached else np.array([1, 2])
    slopes = np.asarray(solution.jac, dtype=np.float64)[:, places]
    inflation = variance_inflation(autocorrelation([solution.fun], len(solution.fun) - 1))
    covariance = np.linalg.pinv(slopes.T @ slopes) * scatter**2 * inflation
    half_sample = 0.5 * max(float(np.median(np.diff(time))) for time, _, _ in runs)
    half_widths = two_sided_quantile(_LEVEL, math.inf) * np.sqrt(np.diag(covariance))
    errors = dict(zip(places.tolist(), half_widths.tolist(), strict=True))
    return ActuatorResponse(
        rate if is_reached else math.nan, rate * errors.get(0, math.nan), float(solution.x[1]),
        math.hypot(errors[1], half_sample), lag, lag * errors[2], scatter,
    )  # fmt: skip


def _share_at_rate(runs: list[tuple[Array, Array, Array]], rate: float, dead_time: float, lag: float) -> float:
    """Return the share of steps in which the simulated angle moves at its largest rate."""
    at_rate = [
        np.abs(np.diff(simulated_angles(time, order, angle[0], rate, dead_time, lag)))
        >= (1.0 - _EDGE) * rate * np.diff(time)
        for time, order, angle in runs
    ]
    return float(np.mean(np.concatenate(at_rate)))


def logged_records(path: Path) -> list[Record]:
    """Return the runs of a trial file that are not left out, or the one record of a file of `write_record`."""
    from seatrial.data.read import read_record_csv
    from seatrial.data.trial import Role, load_runs
    from seatrial.data.trial.records import load_run

    if path.suffix != ".toml":
        return [read_record_csv(path)]
    return [load_run(run, 0.0).record for run in load_runs(path) if run.role is not Role.LEAVE_OUT]
