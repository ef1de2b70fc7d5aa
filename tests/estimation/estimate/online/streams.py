"""A known ship in a known sea, sample by sample, and the batch fit to compare with."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.estimation.estimate.online.recursive import (
    NO_JUMP,
    Forgetting,
    GaussianState,
    JumpSearch,
    RecursiveFilter,
)
from seatrial.estimation.estimate.online.window import gaussian_state_from_fit
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import Segments, cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE, SeawayScenario, ship, simulate_seaway_run

Array = np.ndarray
NOISE = np.array([HEAVE_NOISE, PITCH_NOISE])
OUTPUTS = ("z", "theta")
DT = 0.1
NAMES = ("a33", "a35", "a55", "a53", "b33", "b35", "b55", "b53")


def truth_of(model: Model) -> Array:
    return np.array([model.parameters[n].value for n in NAMES])


@dataclass(frozen=True, eq=False)
class SeaStream:
    """The whole record without noise; `at` 45 degrees the coefficients are those of 90, assumed."""

    ship: Model
    clean: Segments

    @classmethod
    def from_heading(cls, heading: int, duration: float, seed: int) -> "SeaStream":
        model = ship(90 if heading == 45 else heading)
        made = simulate_seaway_run(
            SeawayScenario(heading, duration=duration), np.random.default_rng([heading, seed]), model
        )
        return cls(model, cut_segments(model, [made.record], OUTPUTS, None))

    def measured(self, seed: int) -> Array:
        noise = NOISE * np.random.default_rng([seed, 1]).standard_normal(self.clean.measured.shape)
        return self.clean.measured + noise

    def batch_state(self, measured: Array, rows: int) -> GaussianState:
        """What the batch knows from the first rows; the search starts at the truth."""
        data = replace(self.clean, inputs=np.ascontiguousarray(self.clean.inputs[:rows]), measured=measured[:rows],
                       offsets=np.array([0, rows]))  # fmt: skip
        problem = OutputError(self.ship, data, NOISE)
        found = levenberg_marquardt(problem, problem.start(), problem.measured_initial_states(), negligible=1e-9)
        return gaussian_state_from_fit(problem, found.solution.point, found.local, found.normal)

    def filter(self, belief: GaussianState, rows: int, forgetting: Forgetting | None = None,
               jumps: JumpSearch = NO_JUMP) -> RecursiveFilter:  # fmt: skip
        """A filter that goes on after the first rows."""
        return RecursiveFilter(self.ship, NAMES, OUTPUTS, NOISE, DT, belief, recent_inputs=self.clean.inputs[:rows],
                         forgetting=forgetting, jumps=jumps)  # fmt: skip

    def run_filter(self, recursive: RecursiveFilter, measured: Array, rows: int, block: int = 10) -> RecursiveFilter:
        """The filter after everything behind the first rows."""
        for row in range(rows, len(measured), block):
            recursive.update(measured[row : row + block], self.clean.inputs[row : row + block])
        recursive.flush()
        return recursive
