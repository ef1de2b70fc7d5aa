"""Output error with the noise of each channel at what its residuals show, at every point of a search."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.estimate.point_estimate import (
    degrees_of_freedom_share,
    effective_inflation,
    residual_correlation,
    residual_spread,
)
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import NormalEquations


@dataclass(frozen=True, eq=False)
class ConcentratedLikelihood:
    """Negative log-likelihood with the noise levels concentrated out (Seber & Wild 1989, section 2.2.3).

    Sum of nu log(s) over channels: s the residuals' spread, nu their effective degrees of freedom. One search of it
    does what searches for given noise and estimates of the noise do in turn. With a robust loss the spread is that of
    the bulk, and the gradient that for a noise held there.

    Attributes:
        problem: whose `inflation` says how many samples count; its `noise` is not used.
        known_noise: channel -> stated noise, which stays.
    """

    problem: OutputError
    known_noise: Mapping[str, float]

    @property
    def lower(self) -> Array:
        """Lower bounds of the shared unknowns."""
        return self.problem.lower

    @property
    def upper(self) -> Array:
        """Upper bounds of the shared unknowns."""
        return self.problem.upper

    @cached_property
    def _stated(self) -> Array:
        return np.array([self.known_noise.get(o, np.nan) for o in self.problem.data.outputs])

    @cached_property
    def _degrees_of_freedom(self) -> Array:
        samples = np.isfinite(self.problem.data.measured).sum(axis=0) * degrees_of_freedom_share(self.problem)
        return samples if self.problem.inflation is None else samples / self.problem.inflation

    def cost(self, shared: Array, local: Array) -> float:
        """Return the negative log-likelihood with priors and other data; infinite where the model diverges."""
        residuals = self.residuals(shared, local)
        return np.inf if residuals is None else self._cost(self._spread(residuals), shared)

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return the Gauss-Newton model at a point: that of the problem with the noise there."""
        residuals = self.residuals(shared, local)
        if residuals is None:
            return replace(self.problem.normal(shared, local), cost=np.inf)
        spread = self._spread(residuals)
        return replace(self._with_noise(spread).normal(shared, local), cost=self._cost(spread, shared))

    def residuals(self, shared: Array, local: Array) -> Array | None:
        """Return simulated minus measured, SI, (rows, ny), NaN where nothing was measured; None after a divergence."""
        simulated = self.problem.simulated_outputs(shared, local)
        return simulated - self.problem.data.measured if np.all(np.isfinite(simulated)) else None

    def settled_at(self, shared: Array, local: Array) -> OutputError:
        """Return the problem with the noise of a point, and with samples counted as its residuals are correlated."""
        residuals = self.residuals(shared, local)
        if residuals is None:
            return self.problem
        problem = self._with_noise(self._spread(residuals))
        return replace(problem, inflation=effective_inflation(residual_correlation(problem, residuals)[1]))

    def _spread(self, residuals: Array) -> Array:
        return residual_spread(self.problem, residuals)

    def _with_noise(self, spread: Array) -> OutputError:
        return replace(self.problem, noise=np.where(np.isfinite(self._stated), self._stated, spread))

    def _cost(self, spread: Array, shared: Array) -> float:
        of_channels = np.where(np.isfinite(self._stated), 0.5 * (spread / self._stated) ** 2, np.log(spread))
        return float(self._degrees_of_freedom @ of_channels) + self.problem.prior_cost(shared)
