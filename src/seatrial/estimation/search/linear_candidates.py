"""Candidates of a linear model, all simulated at once by the compiled population."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.estimation.search.runs import JudgedRun, first_steps, measured_count, run_of_step
from seatrial.physics.simulate.population import (
    affine_population_matrices,
    discretised_hold,
    discretised_ramp,
    fitness,
    one_sample_fitness,
)


@dataclass(frozen=True, eq=False)
class LinearCandidates:
    """Candidates for some coefficients of an affine model; everything else is as in the model.

    Attributes:
        names: the coefficients that are sought, in the order of a point.
        inputs: indices of the model's inputs that move; the runs' forcings hold these in this order.
        channels: indices of the states that are compared; sigma: weight of each is 1/sigma, in its unit.
    """

    model: Model
    names: tuple[str, ...]
    inputs: tuple[int, ...]
    runs: tuple[JudgedRun, ...]
    channels: tuple[int, ...]
    sigma: Array

    def matrices(self, points: Array) -> tuple[Array, Array]:
        """A (count, states, states) and B (count, states, inputs) of points (count, unknowns)."""
        parameters = np.tile(self._values, (len(points), 1))
        parameters[:, self._columns] = points
        return affine_population_matrices(self.model, parameters, self.inputs)

    @property
    def output_names(self) -> tuple[str, ...]:
        """Observables that are compared."""
        return tuple(self.model.states[i] for i in self.channels)

    @property
    def step_count(self) -> int:
        """Number of steps from one sample to the next in all runs."""
        return int(first_steps(self.runs)[-1])

    def record_rms(self, points: Array) -> Array:
        """Root mean square of all weighted residuals of each candidate (Qi et al. 2025, eq. (27)), (count,)."""
        A, B = self.matrices(points)
        total = np.zeros(len(points))
        for run in self.runs:
            total += fitness(A, B, run.forcing, run.initial_state, run.measured, self.sigma, self.channels)
        return np.sqrt(total / measured_count(self.runs))

    def step_rms(self, points: Array, step: int, state: Array) -> Array:
        """Root mean square of the sample at the end of a step (Qi et al. 2025, eq. (28)), (count,)."""
        run, sample = run_of_step(self.runs, step)
        measured = run.measured[sample + 1]
        count = np.count_nonzero(np.isfinite(measured))
        if not count:
            return np.zeros(len(points))
        A, B = self.matrices(points)
        total = one_sample_fitness(A, B, run.forcing, sample, state, measured, self.sigma, self.channels)
        return np.sqrt(total / count)

    def given_state(self, step: int) -> Array | None:
        """State at the start of a step where it was recorded or a run begins."""
        run, sample = run_of_step(self.runs, step)
        return run.state_at(sample)

    def advanced_state(self, point: Array, step: int, state: Array) -> Array:
        """State to which one candidate is carried by a step."""
        run, sample = run_of_step(self.runs, step)
        forcing = run.forcing
        A, B = self.matrices(point[None])
        dt = forcing.dt / forcing.substeps
        if forcing.is_held:
            phi, gamma = discretised_hold(A, B, dt)
        else:
            phi, first, last = discretised_ramp(A, B, dt)
            gamma = np.concatenate([first, last], axis=2)
        for row in range(sample * forcing.substeps, (sample + 1) * forcing.substeps):
            state = phi[0] @ state + gamma[0] @ forcing.rows[row]
        return state

    @cached_property
    def _values(self) -> Array:
        return self.model.parameters.values

    @cached_property
    def _columns(self) -> list[int]:
        return [self.model.parameters.index(name) for name in self.names]
