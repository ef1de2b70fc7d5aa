"""Searches of coefficients by a population, as published: fitness over a record or a sample, restarts."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, TypeVar

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index
from seatrial.numerics.optimise import (
    Box,
    Optimiser,
    Solution,
    search,
)
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.simulate.batch import SegmentBatch, batch_class
from seatrial.physics.simulate.population import (
    Forcing,
    affine_population_matrices,
    discretised_hold,
    discretised_ramp,
    fitness,
)
from seatrial.physics.simulate.population import one_sample_fitness as linear_one_sample_fitness

__all__ = [
    "Candidates", "FinishedSearch", "Fitness", "JudgedRun", "LinearCandidates", "SampleSearch", "SimulatedCandidates",
    "one_sample_fitness", "run_search", "whole_record_fitness",
]  # fmt: skip


# Searches of a population by the whole record or sample by sample, restarted: what one iteration judges by.

# What one iteration of a search judges candidates by: the whole record, or one sample.

Fitness = Callable[[Array], Array]
"""Points (count, unknowns) -> fitness (count,), to be made small; infinite where a candidate cannot be simulated."""


class Candidates(Protocol):
    """Models that differ in their coefficients, judged by the same records.

    Steps lead from one sample to the next, run after run, and are counted from 0.
    """

    @property
    def output_names(self) -> tuple[str, ...]:
        """Observables that are compared."""
        ...

    @property
    def sigma(self) -> Array:
        """Deviation of each that counts as 1, in its unit, (outputs,)."""
        ...

    @property
    def step_count(self) -> int:
        """Number of steps in all runs."""
        ...

    def record_rms(self, points: Array) -> Array:
        """Root mean square of all weighted residuals of each candidate, each run from its initial state, (count,)."""
        ...

    def step_rms(self, points: Array, step: int, state: Array) -> Array:
        """The same of the one sample at the end of a step that begins in the given state (states,), (count,)."""
        ...

    def given_state(self, step: int) -> Array | None:
        """State (states,) at the start of a step where it was recorded or a run begins; else None."""
        ...

    def advanced_state(self, point: Array, step: int, state: Array) -> Array:
        """State (states,) to which one candidate is carried by a step."""
        ...


def whole_record_fitness(candidates: Candidates) -> Fitness:
    """Return the root mean square over the whole record (Qi et al. 2025, eq. (27)) as a fitness."""
    return candidates.record_rms


def one_sample_fitness(candidates: Candidates, optimiser: Optimiser) -> Fitness:
    """Return the fitness of which iteration k judges by sample k alone (Qi et al. 2025, eq. (28)).

    Candidates step from the recorded state; where not every state was recorded, from where the best points so far have
    carried the model: each sample is left with the best point of its own iteration, as a model that is identified while
    it runs. After the last sample its step is repeated.
    """
    carried: list[Array] = []

    def state_at(step: int) -> Array:
        while len(carried) <= step:
            here = candidates.given_state(len(carried))
            if here is None:
                here = candidates.advanced_state(optimiser.best[0], len(carried) - 1, carried[-1])
            carried.append(here)
        return carried[step]

    def fitness(points: Array) -> Array:
        step = min(len(optimiser.history), candidates.step_count - 1)
        return candidates.step_rms(points, step, state_at(step))

    return fitness


# One search with random numbers of its own, as often as it is repeated.

AnyOptimiser = TypeVar("AnyOptimiser", bound=Optimiser)


@dataclass(frozen=True, eq=False)
class FinishedSearch:
    """What one search found.

    Attributes:
        trace: best point after each iteration, (iterations, unknowns).
        cpu_s: processor time of the search [s].
    """

    solution: Solution
    trace: Array
    cpu_s: float


def run_search(
    box: Box,
    create: Callable[[Box, np.random.Generator], AnyOptimiser],
    fitness_of: Callable[[AnyOptimiser], Fitness],
    seed: int,
    restart: int,
    report_progress: Callable[[int, float], None] | None = None,
) -> FinishedSearch:
    """Return one search of a box; its random numbers come from the seed and the number of the restart alone.

    Args:
        create: makes the optimiser.
        fitness_of: makes the fitness, which may change with the optimiser's iteration.
        report_progress: called after each iteration with the number of evaluations and the best fitness.

    Raises:
        SearchError: a fitness that the optimiser cannot take.
    """
    optimiser = create(box, np.random.default_rng([seed, restart]))
    began = time.process_time()
    solution = search(optimiser, fitness_of(optimiser), report_progress)
    return FinishedSearch(solution, optimiser.trace, time.process_time() - began)


# A search that judges by one sample after the other, as they come, and the motion it tracks on the way.


class SampleSearch:
    """Feed with `process`; iteration k judges by sample k alone (Qi et al. 2025, eq. (28)), as `one_sample_fitness`.

    Once its iterations are spent the coefficients stay, and the motion is tracked on with them.
    """

    def __init__(self, optimiser: Optimiser) -> None:
        self._optimiser = optimiser
        self._states: list[Array] = []
        self._trace: list[Array] = []
        self._evaluations, self._cpu_s = 0, 0.0

    @property
    def step_count(self) -> int:
        """Number of steps processed."""
        return len(self._states)

    @property
    def best(self) -> Array:
        """Present coefficients, (unknowns,)."""
        return self._optimiser.best[0]

    def process(self, candidates: Candidates, first_step: int = 0) -> None:
        """Process the steps of the candidates that are new.

        first_step: number of steps that come before the candidates' first; at most those processed.
        """
        began = time.process_time()
        for step in range(self.step_count - first_step, candidates.step_count):
            state = candidates.given_state(step)
            if state is None:
                state = candidates.advanced_state(self.best, step - 1, self._states[-1])
            self._states.append(state)
            if not self._optimiser.done:
                points = self._optimiser.ask()
                self._optimiser.tell(candidates.step_rms(points, step, state))
                self._evaluations += len(points)
            self._trace.append(self.best)
        self._cpu_s += time.process_time() - began

    @property
    def tracked_states(self) -> Array:
        """State at the start of each step, carried by the coefficients of that moment, (steps, states)."""
        return np.array(self._states)

    @property
    def trace(self) -> Array:
        """Coefficients after each step, (steps, unknowns)."""
        return np.array(self._trace)

    def finished(self, seed: int) -> FinishedSearch:
        """Return what it found so far, as a search that was run at once."""
        point, value = self._optimiser.best
        history = self._optimiser.history
        solution = Solution(point, value, self._optimiser.status, self._evaluations, history, seed)
        return FinishedSearch(solution, self._optimiser.trace, self._cpu_s)


# Candidates of a model, simulated all at once or one by one, and the runs by which they are judged.

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
        total = linear_one_sample_fitness(A, B, run.forcing, sample, state, measured, self.sigma, self.channels)
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
