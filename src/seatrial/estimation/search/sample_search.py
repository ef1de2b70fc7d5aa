"""A search that judges by one sample after the other, as they come, and the motion it tracks on the way."""

import time

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.search.fitness import Candidates
from seatrial.estimation.search.restarts import FinishedSearch
from seatrial.numerics.optimise import Optimiser, Solution


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
