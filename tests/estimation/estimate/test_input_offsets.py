"""A steering angle that moves has a zero to be estimated, one that was not recorded none."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.estimate.input_offsets import with_input_offsets
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import replay


@pytest.mark.parametrize(("amplitude", "zeros"), [(0.3, ["delta"]), (0.0, [])])
def test_an_angle_that_never_moves_gets_no_zero(amplitude: float, zeros: list[str]) -> None:
    model = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
    time = 0.5 * np.arange(81)
    delta = amplitude * np.sign(np.sin(0.12 * time))
    truth = replay(model, Record.from_arrays("a", time, {"delta": delta}), {"r": 0.02})
    problem = OutputError(model, cut_segments(model, [truth], ("r", "psi"), None), np.array([0.005, 0.01]), workers=1)
    start = levenberg_marquardt(problem, problem.start(), problem.measured_initial_states())
    wider = with_input_offsets(PointEstimate(problem, start)).problem
    assert [one.correction.input for one in wider.nuisances] == zeros
