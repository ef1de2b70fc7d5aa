"""Initial states put where they suit the shared unknowns best, at the price of one simulation."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import NormalEquations


@dataclass(frozen=True, eq=False)
class EliminatedStates:
    """The cost of an output-error problem by its shared unknowns alone, near an optimum.

    Initial states follow the shared unknowns along the optimum's normal equations; what a step of Gauss and Newton by
    the slopes there would still gain is taken off (variable projection; Golub & Pereyra 1973, SIAM J. Numer. Anal. 10,
    413).

    Attributes:
        shared, local, normal: the optimum and its normal equations.
        slopes: derivatives of the outputs by the initial states there, (rows, ny, m).
    """

    problem: OutputError
    shared: Array
    local: Array
    normal: NormalEquations
    slopes: Array

    @classmethod
    def about(cls, problem: OutputError, shared: Array, local: Array, normal: NormalEquations) -> "EliminatedStates":
        """Return the cost about an optimum, whose slopes are computed."""
        slopes = problem.slopes(shared, local)
        return cls(problem, shared, local, normal, slopes[:, :, slopes.shape[2] - local.shape[1] :])

    def states(self, shared: Array) -> Array:
        """Return the initial states that go with the shared unknowns, to first order, (segments, m)."""
        forces = np.einsum("snm,n->sm", self.normal.cross, shared - self.shared)
        return self.local - self.normal.solve_local(forces[:, :, None])[:, :, 0]

    def cost(self, shared: Array) -> float:
        """Return half the squares of residuals and priors at the best initial states; infinite where a run diverges."""
        simulated = self.problem.simulated_outputs(shared, self.states(shared))
        if not np.all(np.isfinite(simulated)):
            return np.inf
        pull = self.problem.weighted_residuals(simulated)
        gradient = np.add.reduceat(np.einsum("ty,tym->tm", pull, self.slopes), self.problem.data.offsets[:-1], axis=0)
        gain = self.normal.solve_local(gradient[:, :, None])[:, :, 0]
        return self.problem.cost_of_outputs(simulated, shared) - 0.5 * float(np.sum(gain * gradient))
