"""A warning where the gain of a linear steering model falls from run to run as the rudder goes farther over."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from seatrial.core.results.coefficients import STORED_LEVEL
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.resampling import one_step_by_run
from seatrial.physics.manoeuvres import REACH_PERCENTILE

GAIN, CUBIC = "K", "alpha"
"""Of the steering models of Nomoto; Norrbin's cubic coefficient lets the gain fall with the yaw rate."""
LEAST_FALL = 0.05
"""Share of the gain from which a fall matters: turning circles then differ by as much; chosen."""


def varying_gain_finding(estimation: Estimation, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return a warning `gain-falls` where runs with more rudder have a gain that is smaller beyond chance.

    The gain of each run by itself, one Gauss-Newton step from the joint estimate, is fitted by a straight line over the
    square of its rudder angle, as Norrbin's cubic has it for small ones. records: the training runs, in their order.
    """
    parameters = estimation.model.parameters
    if not {GAIN, CUBIC} <= set(parameters.names) or not parameters[GAIN].free:
        return ()
    if parameters[CUBIC].free or parameters[CUBIC].value or not all("delta" in r for r in records):
        return ()
    angles = np.array([float(np.nanpercentile(np.abs(r["delta"]), REACH_PERCENTILE)) for r in records])
    if len(records) < 2 or np.ptp(angles) == 0.0:
        return ()
    by_run = one_step_by_run(estimation.shooting)
    column = estimation.shooting.problem.free.index(GAIN)
    gains = by_run.values[:, column]
    deviations = by_run.deviations[:, column] * np.sqrt(np.max(estimation.inflation, initial=1.0))
    line = _weighted_line(angles**2, gains, deviations)
    if line is None:
        return ()
    ends = line.value_at(np.array([angles.min(), angles.max()]) ** 2)
    is_chance = line.slope > -ndtri(0.5 + 0.5 * STORED_LEVEL) * line.deviation
    if is_chance or ends[0] <= 0.0 or 1.0 - ends[1] / ends[0] < LEAST_FALL:
        return ()
    order = np.argsort(angles)
    each = ", ".join(f"{significant(float(gains[k]), 3)} at {np.degrees(angles[k]):.0f} deg" for k in order)
    names = ", ".join(f'"{n}"' for n in (*parameters.free_names, CUBIC))
    return (Finding(
        Severity.WARNING, "gain-falls", f"the gain {GAIN} falls with the rudder angle, by "
        f"{100.0 * (1.0 - ends[1] / ends[0]):.0f} % over the training runs: no single number, and no interval of one, "
        "holds for all of them", f"{GAIN} of each run in 1/s: {each}",
        f"free {CUBIC}: under [model] write free = [{names}]",
    ),)  # fmt: skip


@dataclass(frozen=True)
class _Line:
    """A straight line with the standard deviation of its slope."""

    level: float
    slope: float
    deviation: float

    def value_at(self, x: Array) -> Array:
        return self.level + self.slope * x


def _weighted_line(x: Array, y: Array, deviations: Array) -> _Line | None:
    """Fit by weighted least squares; the scatter about the line widens the deviation where it exceeds the stated one.

    None: fewer than two points have a finite deviation, or all of these share one abscissa.
    """
    usable = np.isfinite(y) & np.isfinite(deviations) & (deviations > 0.0)
    if usable.sum() < 2 or np.ptp(x[usable]) == 0.0:
        return None
    design = np.stack([np.ones(usable.sum()), x[usable]], axis=1) / deviations[usable, None]
    target = y[usable] / deviations[usable]
    covariance = np.linalg.inv(design.T @ design)
    level, slope = covariance @ design.T @ target
    freedom = int(usable.sum()) - 2
    misfit = float(np.sum((target - design @ [level, slope]) ** 2)) / freedom if freedom else 1.0
    return _Line(float(level), float(slope), float(np.sqrt(covariance[1, 1] * max(misfit, 1.0))))
