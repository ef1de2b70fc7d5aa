"""Runs by which candidates are judged, and the steps from sample to sample in them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.physics.simulate.population import Forcing


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
