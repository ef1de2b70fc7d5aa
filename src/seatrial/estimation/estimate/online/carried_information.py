"""Information that outlives its records: a prior on the coefficients."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import Contribution

# Information of discarded records on the coefficients, as a Gaussian prior at the point of linearisation.


@dataclass(frozen=True, eq=False)
class MarginalPrior:
    """Gauss-Newton's model of all discarded data, an `Addend`: gradient' d + 1/2 d' information d, d = theta - point.

    Attributes:
        indices: positions of the coefficients among all model parameters, (k,); point: (k,); information: (k, k).
        gradient: (k,), of the data at the point, where the gradient of the priors is its opposite.
    """

    indices: Index
    point: Array
    information: Array
    gradient: Array

    def cost(self, values: Array) -> float:
        """As `Addend.cost`."""
        off = values[self.indices] - self.point
        return float(self.gradient @ off + 0.5 * off @ self.information @ off)

    def normal(self, values: Array, free: Sequence[int]) -> Contribution:
        """As `Addend.normal`."""
        off = values[self.indices] - self.point
        own = [list(self.indices).index(i) if i in self.indices else -1 for i in free]
        known = np.array([i >= 0 for i in own])
        gradient, hessian = np.zeros(len(own)), np.zeros((len(own), len(own)))
        rows = np.array([i for i in own if i >= 0], dtype=np.int64)
        gradient[known] = (self.gradient + self.information @ off)[rows]
        hessian[np.ix_(known, known)] = self.information[np.ix_(rows, rows)]
        return Contribution(self.cost(values), gradient, hessian)

    def discounted(self, share: float) -> Self:
        """Return the prior with that share of its information: older data count less (exponential forgetting)."""
        return replace(self, information=share * self.information, gradient=share * self.gradient)

    def inflation(self, hessian: Array, covariance: Array) -> float:
        """Return how many times the coefficients' covariance (k, k) exceeds that of white residuals, one at least.

        hessian: as for `marginalise`. Well determined directions weigh most.
        """
        k = len(self.point)
        white = float(np.trace(self.information @ inverse(hessian)[:k, :k]))
        held = float(np.trace(self.information @ covariance))
        return max(held / white, 1.0) if white > 0.0 and np.isfinite(held) else 1.0


def marginalise(indices: Index, point: Array, hessian: Array, mean: Array, weight: Array) -> MarginalPrior:
    """Return the information of the data at the optimum `point` (k,) of data and priors together.

    hessian: of coefficients, then nuisances if any, (n, n), priors included; the nuisances are eliminated.
    mean, weight: of the coefficients' priors, (k,); these stay with the problem and are taken out.
    """
    k = len(point)
    own, tie, rest = hessian[:k, :k], hessian[:k, k:], hessian[k:, k:]
    known = own - tie @ inverse(rest) @ tie.T if len(rest) else own
    return MarginalPrior(indices, point, known - np.diag(weight), -weight * (point - mean))
