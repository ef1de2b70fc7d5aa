"""How estimates move where an assumed value is off: the records' information on both together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, Index, Prior
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.information.consequences import estimate_shifts
from seatrial.estimation.problem.output_error import OutputError


@dataclass(frozen=True, eq=False)
class AssumedInformation:
    """Information of the records with the assumed values free, too, at the estimate.

    Attributes:
        place: parameter, assumed or free -> its position.
        point: values of all these and of what else the runs share, (n,), SI.
        information: of all of them, (n, n), initial states eliminated.
        moving: positions of what the fit estimates; the first `count` are its free coefficients.
        chi_squared: sum of squares over the noise at the estimate.
    """

    place: Mapping[str, int]
    point: Array
    information: Array
    moving: Index
    count: int
    chi_squared: float

    def shifts(self, change: Array) -> tuple[Array, float]:
        """Return changes of the free coefficients, (count,), SI, and the growth of chi squared; change: (n,), SI."""
        moves, growth = estimate_shifts(self.information, self.moving, change)
        return moves[: self.count], growth

    def unit(self, name: str) -> Array:
        """Return a change by one of an assumed value alone, (n,)."""
        return np.eye(1, len(self.point), self.place[name])[0]


def assumed_information(estimation: Estimation, names: Sequence[str], held: Sequence[str] = ()) -> AssumedInformation:
    """Return the information with fixed parameters of these names free, their priors put aside.

    held: further parameters whose priors are put aside, free or fixed.
    """
    estimate, model = output_error_estimate(estimation), estimation.model
    loose = {n: Prior(0.0, np.inf) for n in {*names, *held}}
    freed = model.parameters.freed(*names, *(n for n in held if n not in names)).with_priors(loose)
    problem: OutputError = replace(estimate.problem, model=model.with_parameters(freed))
    free, size = estimate.problem.free, len(problem.free)
    place = {n: i for i, n in enumerate(problem.free)}
    fitted = [place[n] for n in free]
    point = np.concatenate([problem.start()[:size], estimate.common_parameters[len(free) :]])
    point[fitted] = estimate.common_parameters[: len(free)]
    return AssumedInformation(
        place, point, problem.normal(point, estimate.optimum.local).without_local()[1],
        np.array([*fitted, *range(size, len(point))]), len(free),
        2.0 * problem.cost(point, estimate.optimum.local),
    )  # fmt: skip


def output_error_estimate(estimation: Estimation) -> PointEstimate:
    """Return the estimate with outputs simulated from initial states: under prediction error that over segments."""
    return estimation.shooting if estimation.has_process_noise else estimation.estimate
