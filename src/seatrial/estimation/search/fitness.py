"""What one iteration of a search judges candidates by: the whole record, or one sample.

Qi et al. 2025 print both: eq. (27), the root mean square over the record, and eq. (28), of which iteration k takes
sample k alone.
"""

from collections.abc import Callable
from typing import Protocol

from seatrial.core.values import Array
from seatrial.numerics.optimise import Optimiser

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
