"""Sway stiffness: spring tensions over the camera's sway, its clock's delay and drift fitted along."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial_studies.section2d.modes import jackknife_error
from seatrial_studies.section2d.runs import FlumeRun
from seatrial_studies.section2d.tank import SWAY_STIFFNESS

LEAST_SWAY_M, LEAST_SHARE = 0.003, 0.9
_DELAYS = np.arange(-0.4, 0.41, 0.05)
_DRIFTS = np.arange(-0.016, 0.0161, 0.004)
_MARGIN_S = 2.0


@dataclass(frozen=True)
class SpringRegression:
    """One run.

    Attributes:
        lower, upper: N/m, regression of tension on sway and its inverse; all noise in the one or the other.
        delay, drift: s, s/s of the camera.
        explained_share: share of the tension.
    """

    run: str
    lower: float
    upper: float
    delay: float
    drift: float
    explained_share: float

    @property
    def geometric_mean(self) -> float:
        """Return the slope [N/m] of the reduced major axis: the geometric mean of both."""
        return float(np.sqrt(self.lower * self.upper))


@dataclass(frozen=True)
class SwayStiffness:
    """Mean over the runs used, N/m, and its standard error from leaving runs out."""

    runs: tuple[SpringRegression, ...]
    mean: float
    error: float

    @property
    def value(self) -> float:
        """Return the stiffness [N/m]; the middle of the documented range where no run identifies it."""
        return self.mean if np.isfinite(self.mean) else sum(SWAY_STIFFNESS) / 2.0


def sway_stiffness(runs: Sequence[FlumeRun]) -> SwayStiffness:
    """Of the runs in which the section sways freely, the camera lives and tensions follow sway.

    Runs whose tension is explained to less than nine tenths are left out: slack springs, camera clocks that jump.
    """
    made = [one for run in runs if run.scenario in (3, 4) for one in spring_regression(run)]
    used = [s.geometric_mean for s in made if s.explained_share > LEAST_SHARE]
    if len(used) < 2:
        return SwayStiffness(tuple(made), float("nan"), float("nan"))
    means = [float(np.mean(used[:k] + used[k + 1 :])) for k in range(len(used))]
    return SwayStiffness(tuple(made), float(np.mean(used)), jackknife_error(means))


def spring_regression(run: FlumeRun) -> tuple[SpringRegression, ...]:
    """Empty where the camera is dead or the sway small."""
    from scipy.optimize import minimize

    start, stop = run.stroke_times[1], float(run.record.time[-1]) - _MARGIN_S
    part = run.record.between(start, stop)
    sway, whole = run.record["y0"], run.record.time
    if float(np.std(part["y0"])) < LEAST_SWAY_M:
        return ()
    tension = part["S_1"] - part["S_2"]
    centre = part.time - part.time.mean()

    def features(point: Array) -> Array:
        return np.column_stack([np.interp(part.time + point[0] + point[1] * centre, whole, sway), np.ones(len(centre))])

    def residuals(point: Array) -> Array:
        basis = features(point)
        return tension - basis @ np.linalg.lstsq(basis, tension, rcond=None)[0]

    def misfit(point: Array) -> float:
        return float(np.sum(residuals(point) ** 2))

    first = min(((d, s) for d in _DELAYS for s in _DRIFTS), key=lambda p: misfit(np.array(p)))
    corners = np.array([first, (first[0] + 0.02, first[1]), (first[0], first[1] + 0.002)])
    found = minimize(misfit, first, method="Nelder-Mead", options={"initial_simplex": corners, "xatol": 1e-5})
    slope = float(np.linalg.lstsq(features(found.x), tension, rcond=None)[0][0])
    explained = 1.0 - float(found.fun / np.sum((tension - tension.mean()) ** 2))
    return (SpringRegression(run.name, slope, slope / explained, float(found.x[0]), float(found.x[1]), explained),)
