"""Candidates of a model, simulated all at once or one by one, and the runs by which they are judged."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.simulate.batch import SegmentBatch
from seatrial.physics.simulate.linear import batch_class
from seatrial.physics.simulate.population import (
    Forcing,
    affine_population_matrices,
    discretised_hold,
    discretised_ramp,
    fitness,
    one_sample_fitness,
)

# Runs by which candidates are judged, and the steps from sample to sample in them.


@dataclass(frozen=True, eq=False)
class JudgedRun:
    """One run by which candidates are judged.

    Attributes:
        forcing: the inputs that the candidates take.
        initial_state: (states,).
        measured: (samples, channels), NaN where nothing was measured.
        states: recorded states (samples, states); None where not every state was recorded.
    """

    forcing: Forcing
    initial_state: Array
    measured: Array
    states: Array | None = None

    def state_at(self, sample: int) -> Array | None:
        """Return the state at a sample where it was recorded or the run begins, else None."""
        if self.states is not None:
            return self.states[sample]
        return self.initial_state if sample == 0 else None


def first_steps(runs: Sequence[JudgedRun]) -> Index:
    """Return the number of each run's first step, and the number of all steps, (runs + 1,)."""
    return np.cumsum([0, *(run.forcing.samples - 1 for run in runs)])


def run_of_step(runs: Sequence[JudgedRun], step: int) -> tuple[JudgedRun, int]:
    """Return the run of a step, and the sample at which the step begins."""
    edges = first_steps(runs)
    run = int(np.searchsorted(edges, step, side="right")) - 1
    return runs[run], step - int(edges[run])


def measured_count(runs: Sequence[JudgedRun]) -> int:
    """Return the number of measured values in all runs."""
    return sum(int(np.count_nonzero(np.isfinite(run.measured))) for run in runs)


# Candidates of a linear model, all simulated at once by the compiled population.


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


# Candidates of any model, simulated one by one by the compiled simulator of records.


@dataclass(frozen=True, eq=False)
class SimulatedCandidates:
    """Candidates for some coefficients of a model; everything else is as in the model.

    Attributes:
        names: the coefficients that are sought, in the order of a point.
        runs: forcings hold all inputs of the model at the samples, without substeps.
        output_names: observables that are compared; sigma: weight of each is 1/sigma, in its unit.
        workers: threads; None: one for each core.
    """

    model: Model
    names: tuple[str, ...]
    runs: tuple[JudgedRun, ...]
    output_names: tuple[str, ...]
    sigma: Array
    workers: int | None = None

    @property
    def step_count(self) -> int:
        """Number of steps from one sample to the next in all runs."""
        return int(first_steps(self.runs)[-1])

    def record_rms(self, points: Array) -> Array:
        """Root mean square of all weighted residuals of each candidate (Qi et al. 2025, eq. (27)), (count,)."""
        count = measured_count(self.runs)

        def one(point: Array) -> float:
            batch, measured = self._records
            total = self._squares(batch, point, self._initial_states, measured)
            return float(np.sqrt(total / count))

        return np.array(map_in_threads(one, list(points), workers=self.workers))

    def step_rms(self, points: Array, step: int, state: Array) -> Array:
        """Root mean square of the sample at the end of a step (Qi et al. 2025, eq. (28)), (count,)."""
        run, sample = run_of_step(self.runs, step)
        measured = run.measured[sample + 1]
        count = np.count_nonzero(np.isfinite(measured))
        if not count:
            return np.zeros(len(points))
        reached = self._reached(points, run, sample, state, self.output_names)
        with np.errstate(invalid="ignore", over="ignore"):
            total = np.nansum(((np.where(np.isfinite(reached), reached, np.inf) - measured) / self.sigma) ** 2, axis=1)
        return np.sqrt(total / count)

    def given_state(self, step: int) -> Array | None:
        """State at the start of a step where it was recorded or a run begins."""
        run, sample = run_of_step(self.runs, step)
        return run.state_at(sample)

    def advanced_state(self, point: Array, step: int, state: Array) -> Array:
        """State to which one candidate is carried by a step."""
        run, sample = run_of_step(self.runs, step)
        return self._reached(point[None], run, sample, state, self.model.states)[0]

    def _reached(self, points: Array, run: JudgedRun, sample: int, state: Array, outputs: Sequence[str]) -> Array:
        """Outputs of each candidate after one step, (count, outputs): candidates as segments of two rows."""
        count = len(points)
        inputs = np.tile(run.forcing.inputs[sample : sample + 2], (count, 1))
        batch = self._batch(inputs, 2 * np.arange(count + 1), outputs)
        y, _ = batch.simulate(0, count, np.tile(state, (count, 1)), self._parameters(points), np.empty((count, 0)))
        return y[1::2]

    def _squares(self, batch: SegmentBatch, point: Array, start: Array, measured: Array) -> float:
        """Sum of the squares of weighted residuals; infinite where a simulation diverges."""
        runs = len(self.runs)
        values = np.repeat(self._parameters(point[None]), runs, axis=0)
        y, _ = batch.simulate(0, runs, start, values, np.empty((runs, 0)))
        if not np.all(np.isfinite(y)):
            return np.inf
        with np.errstate(over="ignore"):
            return float(np.nansum(((y - measured) / self.sigma) ** 2))

    def _batch(self, inputs: Array, offsets: Index, outputs: Sequence[str]) -> SegmentBatch:
        return batch_class(self.model)(self.model, inputs, offsets, self.runs[0].forcing.dt, tuple(outputs))

    def _parameters(self, points: Array) -> Array:
        parameters = np.tile(self._values, (len(points), 1))
        parameters[:, self._columns] = points
        return parameters

    @cached_property
    def _records(self) -> tuple[SegmentBatch, Array]:
        """All runs end to end, and what was measured in them."""
        inputs = np.concatenate([run.forcing.inputs for run in self.runs])
        offsets = np.cumsum([0, *(len(run.measured) for run in self.runs)])
        return self._batch(inputs, offsets, self.output_names), np.concatenate([run.measured for run in self.runs])

    @cached_property
    def _initial_states(self) -> Array:
        return np.array([run.initial_state for run in self.runs])

    @cached_property
    def _values(self) -> Array:
        return self.model.parameters.values

    @cached_property
    def _columns(self) -> list[int]:
        return [self.model.parameters.index(name) for name in self.names]
