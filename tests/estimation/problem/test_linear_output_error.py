"""The lean output error of one linear record says what the general one says."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.estimation.problem.linear_output_error import LinearOutputError
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import Segments, cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models.heave_pitch import heave_pitch, heave_pitch_zoh
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.published import physical_start_values
from seatrial.physics.simulate.linear import LinearBatch
from seatrial_studies.seaway import SeawayScenario, simulate_seaway_run

NOISE = np.array([0.01, 3.5e-4])
LOCAL = np.array([[0.1, 0.05, 0.01, -0.01]])


def data_of(model, **voyage):
    made = simulate_seaway_run(SeawayScenario(135, duration=30.0, **voyage), np.random.default_rng(3))
    truth = model.with_parameters(made.truth.parameters)
    return truth, cut_segments(truth, [made.record], ("z", "theta"), None)


@pytest.mark.parametrize(
    ("model", "voyage"),
    [
        (heave_pitch, {"dt": 0.1, "motion_stride": 5}),
        (heave_pitch_zoh, {"dt": 0.5}),
        (heave_pitch, {"dt": 0.5, "has_waves": False}),
    ],
)
@pytest.mark.parametrize("starts", [(), ("z", "theta_dot"), ("z", "z_dot", "theta", "theta_dot")])
def test_cost_gradient_and_hessian_are_those_of_the_general_problem(model, voyage, starts):
    truth, data = data_of(model(), **voyage)
    general = OutputError(truth, data, NOISE, workers=1)
    places = [truth.states.index(s) for s in starts]
    lean = LinearOutputError(truth, data, NOISE, LOCAL[0], starts)
    shared = lean.start() * (1.0 + 0.2 * np.random.default_rng(0).standard_normal(len(COEFFICIENTS)))
    expected, found = general.normal(shared, LOCAL), lean.normal(shared, LOCAL[:, places])
    scale = np.sqrt(np.diag(expected.hessian))
    local_scale = np.sqrt(np.diag(expected.local_hessian[0]))[places]
    assert lean.cost(shared, LOCAL[:, places]) == pytest.approx(general.cost(shared, LOCAL), rel=1e-10)
    assert found.cost == pytest.approx(expected.cost, rel=1e-10)
    root = np.sqrt(expected.cost)
    np.testing.assert_allclose(found.gradient / scale, expected.gradient / scale, rtol=0, atol=1e-10 * root)
    by_scale = np.outer(scale, scale)
    np.testing.assert_allclose(found.hessian / by_scale, expected.hessian / by_scale, rtol=0, atol=1e-10)
    wanted = expected.local_gradient[:, places] / local_scale
    np.testing.assert_allclose(found.local_gradient / local_scale, wanted, rtol=0, atol=1e-10 * root)
    across = np.outer(scale, local_scale)
    np.testing.assert_allclose(found.cross[0] / across, expected.cross[0][:, places] / across, rtol=0, atol=1e-10)
    inner = np.outer(local_scale, local_scale)
    expected_local = expected.local_hessian[0][np.ix_(places, places)]
    np.testing.assert_allclose(found.local_hessian[0] / inner, expected_local / inner, rtol=0, atol=1e-10)


def from_rest() -> tuple[LinearOutputError, np.ndarray]:
    """The papers' discretisation without noise, from the physics start."""
    truth, data = data_of(heave_pitch_zoh(), dt=0.5)
    batch = LinearBatch(truth, data.inputs, data.offsets, data.dt, data.outputs)
    run, _ = batch.simulate(0, 1, np.zeros((1, 4)), truth.parameters.values[None], np.empty((1, 0)))
    known = dict(zip(truth.parameters.names, truth.parameters.values, strict=True))
    start = truth.with_values(physical_start_values(known))
    wanted = np.array([known[n] for n in COEFFICIENTS])
    return LinearOutputError(start, replace(data, measured=run), NOISE, np.zeros(4)), wanted


def test_the_truth_is_found_from_the_physics_start():
    problem, wanted = from_rest()
    found = levenberg_marquardt(problem, problem.start(), problem.given_initial_states(), negligible=1e-12)
    assert found.solution.status.is_success
    np.testing.assert_allclose(found.solution.point, wanted, rtol=1e-9)


def test_slopes_kept_from_a_trial_step_are_those_of_the_point_asked_about():
    problem, wanted = from_rest()
    local, other = problem.given_initial_states(), 1.1 * wanted
    expected = problem.normal(wanted, local)
    problem.cost(other, local)
    np.testing.assert_array_equal(problem.normal(wanted, local).hessian, expected.hessian)
    assert problem.normal(other, local).cost == problem.cost(other, local) > 0.0


def test_a_run_beyond_all_bounds_costs_infinitely_much():
    problem, wanted = from_rest()
    wild = wanted * [1, 1, 1, 1, -1e3, 1, -1e3, 1]
    assert problem.cost(wild, problem.given_initial_states()) == np.inf
    assert problem.normal(wild, problem.given_initial_states()).cost == np.inf


def test_what_is_not_measured_does_not_count():
    truth, data = data_of(heave_pitch(), dt=0.1, motion_stride=5)
    silent = replace(data, measured=np.full_like(data.measured, np.nan))
    problem = LinearOutputError(truth, silent, NOISE, np.zeros(4))
    normal = problem.normal(problem.start(), problem.given_initial_states())
    assert normal.cost == problem.cost(problem.start(), problem.given_initial_states()) == 0.0
    assert not normal.hessian.any()


def twice(data: Segments) -> Segments:
    """The same segment two times."""
    return data.selected(np.array([0, 0]))


def test_problems_of_another_kind_are_refused_in_one_sentence():
    truth, data = data_of(heave_pitch(), dt=0.1)
    with pytest.raises(InputError, match="2 segments, not one whole record"):
        LinearOutputError(truth, twice(data), NOISE, np.zeros(4))
    with pytest.raises(InputError, match="initial state must be 4 finite values"):
        LinearOutputError(truth, data, NOISE, np.zeros(3))
    with pytest.raises(InputError, match="channel 'zeta' is no state"):
        LinearOutputError(truth, replace(data, outputs=("z", "zeta")), NOISE, np.zeros(4))
    with pytest.raises(InputError, match="noise must be positive"):
        LinearOutputError(truth, data, np.array([0.01, 0.0]), np.zeros(4))
