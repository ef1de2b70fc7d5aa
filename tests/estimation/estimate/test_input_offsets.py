"""What each session has of its own: the zero of a steering angle that moves, the heel at which it comes to rest."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.data.trial import EstimateSettings, load_trial
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.estimate.plausibility import with_input_offsets
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.identify import estimate_model
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models import model_named
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


RESTS = (0.02, -0.01, 0.005)
"""Heel at which each decay comes to rest, rad."""


def decays_of_other_heels(rng: np.random.Generator) -> Runs:
    """Linear decays in closed form, 60 s at 5 Hz, of a period of 8 s and b_1 = 0.04 1/s."""
    time = np.arange(0.0, 60.0, 0.2)
    swing = 0.2 * np.exp(-0.02 * time) * np.cos(np.sqrt(0.6169 - 0.02**2) * time)
    noisy = [rest + swing + 1e-3 * rng.standard_normal(len(time)) for rest in RESTS]
    return Runs.one_session_each([Record.from_arrays(f"d{k}", time, {"phi": phi}) for k, phi in enumerate(noisy)], 40.0)


def test_decays_that_rest_at_other_heels_share_all_else(rng: np.random.Generator) -> None:
    """One heel for all makes the interval of damping a hundred times as wide."""
    model = model_named("roll")
    model = model.with_parameters(model.parameters.only_free(("b_1", "c_1", "phi_0")))
    runs = decays_of_other_heels(rng)
    shared, apart = (estimate_model(model, runs, EstimateSettings(offsets=offsets)) for offsets in ({}, {"phi": None}))
    assert apart.estimate.problem.free == ("b_1", "c_1")
    np.testing.assert_allclose(apart.estimate.session_offsets[:, 0], RESTS, atol=5e-4)
    assert apart.interval.half_width[0] < 0.05 * shared.interval.half_width[0]
    assert abs(apart.estimate.common_parameters[0] - 0.04) < 1.5 * apart.interval.half_width[0]


def test_a_state_without_a_rest_has_none(tmp_path: Path) -> None:
    """Of a steered ship, psi is no offset; the angle of rest of a roll is not free beside those of the sessions."""
    file = tmp_path / "t.toml"
    lines = (
        '[ship]', 'name = "a"', 'L = 10', '[model]', 'name = "nomoto"', '[estimate]', 'offsets = ["psi"]',
        '[[records]]', 'files = ["a.csv"]', 'channels.psi = { column = "psi", unit = "deg" }',
    )  # fmt: skip
    file.write_text("\n".join(lines))
    with pytest.raises(InputError, match=r"unknown name .psi."):
        load_trial(file)
    runs = decays_of_other_heels(np.random.default_rng(0))
    problem = output_error_problem(model_named("roll"), runs, np.inf, EstimateSettings(offsets={"phi": 0.03}))
    assert problem.session_unknowns == ("phi_0",) and "phi_0" not in problem.free
