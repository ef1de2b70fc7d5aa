"""What an online estimate rests on while samples are kept, and what the samples of a full window become.

    WarmUp ──► Window ──► RecursivePhase ──► Carried ──► RecursivePhase      output error over whole runs
                  └─────► Carried ──► Carried                                where no filter can take over

A filter that has diverged leads back to WarmUp. Each phase is a value; `OnlineEstimator` holds one at a time.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.estimate.online.marginal_prior import MarginalPrior, marginalise
from seatrial.estimation.estimate.online.window import WindowEstimate
from seatrial.estimation.information.covariance import inverse


@dataclass(frozen=True)
class WarmUp:
    """No estimate yet: too few samples, or none that the model can be fitted to."""

    def with_estimate(self, estimate: WindowEstimate) -> "Window":
        """Return the phase that the first estimate begins."""
        return Window(estimate)


@dataclass(frozen=True, eq=False)
class Window:
    """An estimate from every sample received so far, all of them kept."""

    estimate: WindowEstimate

    def with_estimate(self, estimate: WindowEstimate) -> Self:
        """Return the same phase with a later estimate."""
        return replace(self, estimate=estimate)

    def carried(self) -> "Carried":
        """Return the phase that keeps the window's normal equations instead of its samples."""
        prior = _window_information(self.estimate)
        hessian = self.estimate.estimate.optimum.normal.without_local()[1]
        return Carried(self.estimate, prior, prior.inflation(hessian, self.estimate.covariance))


@dataclass(frozen=True, eq=False)
class Carried:
    """An estimate from the samples kept and from the information of those no longer kept.

    Attributes:
        estimate: the latest, from both.
        prior: information of the samples no longer kept.
        inflation: factor on the covariance of that information for correlated residuals, at least 1.
    """

    estimate: WindowEstimate
    prior: MarginalPrior
    inflation: float = 1.0

    def with_estimate(self, estimate: WindowEstimate) -> Self:
        """Return the same phase with a later estimate."""
        return replace(self, estimate=estimate)

    def carried(self) -> Self:
        """Return the phase whose information includes the samples kept."""
        return replace(self, prior=_window_information(self.estimate))

    def discounted(self, share: float) -> Self:
        """Return the phase with that share of its information, 0 to 1."""
        return replace(self, prior=self.prior.discounted(share))

    def inflated_covariance(self, hessian: Array, prior_weight: Array) -> Array:
        """Return the covariance of the common parameters, (n, n), with correlated residuals allowed for.

        Args:
            hessian: of the search at its optimum, (n, n), priors and this phase's information included.
            prior_weight: inverse variances of the parameters' priors, (n,), which are not inflated.
        """
        stated = np.diag(prior_weight)
        return inverse((hessian - stated) / self.inflation + stated)


KeptPhase = WarmUp | Window | Carried
"""The phases that keep samples; the recursive filter keeps none."""


def _window_information(estimate: WindowEstimate) -> MarginalPrior:
    """What the estimate's problem knows of the coefficients, earlier information included, priors taken out."""
    problem = estimate.estimate.problem
    indices = np.array([problem.model.parameters.index(n) for n in problem.free], dtype=np.int64)
    mean, weight = (values[: len(indices)] for values in problem.priors)
    hessian = estimate.estimate.optimum.normal.without_local()[1]
    return marginalise(indices, estimate.value, hessian, mean, weight)
