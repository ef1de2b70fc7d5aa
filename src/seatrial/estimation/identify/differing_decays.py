"""Roll decays that do not share one coefficient, as at several speeds or loadings: named, and in its interval."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.resampling import one_step_by_run
from seatrial.estimation.estimate.time_scale import is_pure_roll
from seatrial.estimation.identify.estimated_values_effect import EstimatedValueShift
from seatrial.estimation.identify.roll_characteristics import DAMPING_NAMES, RESTORING_NAMES
from seatrial.estimation.information.covariance import excess_spread

_CHANCE = (
    1e-3  # probability below which a spread between decays is no chance; chosen: with some five coefficients tested
)
_LEAST_LEFT = 0.05  # of the sum of squares, as far as one linear step is trusted to explain it; chosen
_MOST_NAMED = 8  # decays that a message names; chosen


@dataclass(frozen=True, eq=False)
class DifferingDecays:
    """The coefficient in which decays differ most.

    Attributes:
        name: of it; runs, values: each decay with what it says by itself, SI; spread: standard deviation between decays
            beyond their errors, SI.
    """

    name: str
    runs: tuple[str, ...]
    values: Array
    spread: float

    def shift(self, free: tuple[str, ...]) -> EstimatedValueShift:
        """Return the spread as what the coefficient of a single decay differs by."""
        moves = np.where([name == self.name for name in free], self.spread, 0.0)
        return EstimatedValueShift(
            f"{self.name} of a decay", self.spread / abs(float(np.mean(self.values))), moves, 0.0
        )

    def finding(self, unit: str) -> Finding:
        """Return the warning `decays-differ`."""
        each = zip(self.runs[:_MOST_NAMED], self.values[:_MOST_NAMED], strict=True)
        listed = ", ".join(f"{significant(float(value), 2)} in {run}" for run, value in each)
        return Finding(
            Severity.WARNING, "decays-differ", f"the decays do not share one {self.name}, and no single number holds",
            f"{self.name} in {unit}: {listed}",
            "fit the decays of each speed and loading by themselves",
            f"the interval of {self.name} holds what one decay differs from another by",
        )  # fmt: skip


def differing_decays(estimation: Estimation) -> DifferingDecays | None:
    """Return the coefficient in which the training decays differ beyond chance; None: none, or no roll decays.

    Each decay by itself, one Gauss-Newton step from the joint estimate, with the noise left when each has values of
    its own: else what they differ by would pass for noise. Q, the sum of squares about the weighted mean over the
    errors, is a chi squared where they share one value (Cochran 1954, Biometrics 10, 101-129).
    """
    if not is_pure_roll(estimation.model) or len(estimation.shooting.problem.data.runs) < 2:
        return None
    estimate, problem, found = estimation.shooting, estimation.shooting.problem, []
    by_run = one_step_by_run(estimate)
    squares = 2.0 * problem.cost(estimate.common_parameters, estimate.optimum.local)
    left = np.sqrt(max(1.0 - float(np.sum(by_run.decreases)) / squares, _LEAST_LEFT))
    for name in (*DAMPING_NAMES, *RESTORING_NAMES):
        if name not in problem.free:
            continue
        column = problem.free.index(name)
        values, errors = by_run.values[:, column], left * by_run.deviations[:, column]
        chance, spread = excess_spread(values, errors)
        found.append((chance, DifferingDecays(name, problem.data.runs, values, spread)))
    chance, strongest = min(found, key=lambda pair: pair[0], default=(1.0, None))
    return strongest if chance < _CHANCE else None
