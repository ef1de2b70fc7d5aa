"""Searches of a population by the whole record or sample by sample, restarted: what one iteration judges by."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, Optimiser, Solution, search

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
