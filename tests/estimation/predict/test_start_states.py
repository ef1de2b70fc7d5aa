"""Initial states estimated from first seconds: how they follow an assumed offset, and how far they are off."""

import numpy as np
import pytest

from seatrial.core.values import Prior, Record
from seatrial.estimation.predict.windows import Windows, start_states
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models import model_named
from seatrial.physics.simulate.batch import InputCorrection
from seatrial.physics.simulate.replay import replay


def test_states_follow_the_assumed_rudder_zero_as_estimating_them_again_does() -> None:
    time = 0.5 * np.arange(121)
    planned = Record.from_arrays("run", time, {"delta": 0.3 * np.sign(np.sin(0.12 * time + 0.3))})
    model = model_named("nomoto").with_values({"K": 0.15, "T": 8.0})
    record = replay(model, planned, {"r": 0.01})
    zero = Nuisance(InputCorrection("delta", "zero"), Prior(0.0, 0.02, ""), "rad")
    data = cut_segments(model, [record], ("r", "psi"), None)
    problem, windows = OutputError(model, data, np.array([0.01, 0.1]), (zero,)), Windows.cut([record], 15.0)
    step = 0.01
    expected, shifted = (start_states(problem, model, windows, np.array([[x]]), 4.0) for x in (0.0, step))
    np.testing.assert_allclose(expected.by_offsets[:, :, 0] * step, shifted.values - expected.values, atol=1e-7)
    assert np.abs(expected.by_offsets[:, model.states.index("r"), 0]).min() > 0.01
    as_measured = start_states(problem, model, windows, np.array([[0.0]]), 0.0)
    assert not as_measured.by_offsets.any()


@pytest.mark.parametrize(("memory", "error_share"), [(0.0, 0.1), (0.8, 0.25)], ids=["white", "coloured"])
def test_errors_of_states_have_the_covariance_that_is_said(memory: float, error_share: float) -> None:
    """300 windows with noise of its own each; `memory`: correlation from sample to sample.

    Residuals of a short beginning hide a part of their colour, so that coloured noise counts for a fifth too little.
    """
    count, rng = 300, np.random.default_rng(4)
    time = 0.2 * np.arange(50 * count + 1)
    planned = Record.from_arrays("run", time, {"delta": 0.3 * np.sign(np.sin(0.12 * time + 0.3))})
    model = model_named("nomoto").with_values({"K": 0.15, "T": 8.0})
    clean = replay(model, planned, {"r": 0.01})
    sizes, noise = np.array([2e-3, 2e-2]), np.zeros((len(time), 2))
    for k, white in enumerate(rng.standard_normal((len(time), 2))):
        noise[k] = memory * noise[k - 1] + np.sqrt(1.0 - memory**2) * white
    record = clean
    for channel, error in zip(("r", "psi"), (noise * sizes).T, strict=True):
        record = record.with_channel(channel, record.channel(channel).with_values(clean[channel] + error))
    data = cut_segments(model, [record], ("r", "psi"), None)
    windows = Windows.cut([record], 10.0)
    starts = start_states(OutputError(model, data, sizes), model, windows, np.zeros((1, 0)), 10.0)
    for channel in ("r", "psi"):
        place = model.states.index(channel)
        error = starts.values[:, place] - clean[channel][windows.first]
        expected = np.sqrt(np.mean(starts.covariance[:, place, place]))
        assert expected == pytest.approx(np.sqrt(np.mean(error**2)), rel=error_share)
