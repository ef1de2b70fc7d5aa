"""Estimates outside physics are refused in a sentence; directions that no record can tell are named."""

import math
from dataclasses import replace

import numpy as np
import pytest
from standard_craft import NOMOTO

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Prior, Record
from seatrial.data.example_series import SENSOR_NOISE, with_sensor_noise
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.plausibility import (
    implausible_coefficients,
    refuse_implausible,
    refuse_singular,
    weakest_direction,
    with_plausible_start,
)
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import Optimum, Solution, Status
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.steer import manoeuvre
from seatrial.problems.disturbed_craft import Disturbance, independent_nomoto

LENGTH, ERRORS = 50.0, np.array([0.01, 1.0])


def at(k: float, t: float, *, cost: float = 1.0, prior: Prior | None = None) -> PointEstimate:
    """A Nomoto craft, K 0.1 and T 10 of its own, estimated at these values."""
    time = 0.1 * np.arange(100)
    channels = {"delta": np.sin(time), "r": 0.1 * np.cos(time), "u": 5.0 + 0.0 * time}
    model = nomoto().with_values({"K": 0.1, "T": 10.0})
    if prior is not None:
        model = model.with_parameters(model.parameters.with_priors({"T": prior}))
    runs = Runs.one_session_each([Record.from_arrays("run", time, channels)], LENGTH)
    problem = output_error_problem(model, runs, np.inf, EstimateSettings(), 1)
    point = np.array([k, t])
    solution = Solution(point, cost, Status.CONVERGED, 1)
    return PointEstimate(
        problem, Optimum(solution, np.zeros((1, 1)), problem.normal(problem.start(), np.zeros((1, 1))))
    )


def test_what_ships_have_is_accepted() -> None:
    refuse_implausible(at(0.3, -40.0), ERRORS)


@pytest.mark.parametrize(
    ("estimate", "errors", "named"),
    [
        (at(-6e9, -3e11), np.array([1e12, 1e14]), "K -6e+09, T -3e+11, standard error 1e+12, 1e+14"),
        (at(0.1, np.nan), ERRORS, "T nan, standard error 1"),
        (at(0.1, 10.0), np.array([np.nan, 1.0]), "K 0.1, standard error nan"),
    ],
)
def test_a_lost_search_is_one_sentence_with_what_to_try(
    estimate: PointEstimate, errors: np.ndarray, named: str
) -> None:
    with pytest.raises(InputError) as caught:
        refuse_implausible(estimate, errors)
    assert str(caught.value) == (
        f"the search ended outside physics: {named}; fix some of these under [model.fixed], give priors under "
        "[model.priors], or leave out the runs that differ most in speed or orders"
    )


def test_a_large_value_that_the_record_determines_is_no_lost_search() -> None:
    """A thousand times the start, to a tenth; not a million times, nor where it is known to no better than itself."""
    errors = np.array([0.01, 2e3])
    assert implausible_coefficients(at(0.1, 2e4), errors) == ""
    assert implausible_coefficients(at(0.1, 2e4), 10.0 * errors) == "T 2e+04, standard error 2e+04"
    assert implausible_coefficients(at(0.1, 2e7), errors) == "T 2e+07, standard error 2e+03"


def test_a_prior_that_expects_large_values_allows_them() -> None:
    refuse_implausible(at(0.1, 5e4, prior=Prior(4e4, 1e4, "a hulk")), ERRORS)


def test_a_model_that_diverges_is_judged_by_its_runs() -> None:
    refuse_implausible(at(-6e9, 1.0, cost=np.inf), ERRORS)


def test_only_a_lost_search_begins_at_the_model_s_own_values() -> None:
    near, lost = at(0.3, 40.0), at(0.3, 4e9)
    assert with_plausible_start(near) is near
    assert with_plausible_start(lost).common_parameters.tolist() == [0.1, 10.0]


@pytest.fixture(scope="module")
def gusty_minute() -> Record:
    """Sixty seconds in gusts that output error takes for a craft without damping."""
    craft = NOMOTO
    runs = independent_nomoto(
        craft, Disturbance(0.5, 5.0), 5, np.random.default_rng([7, 60, 0]), is_closed=False, seconds=60.0
    )
    return runs[1]


def estimated(record: Record, method: EstimateMethod) -> Estimation:
    model = nomoto().with_values({"K": 0.1, "T": 10.0})
    settings = replace(EstimateSettings(), method=method)
    return estimate_model(model, Runs.one_session_each([record], LENGTH), settings, EstimatorOptions(workers=1))


def test_output_error_that_leaves_its_basin_is_refused(gusty_minute: Record) -> None:
    with pytest.raises(InputError, match=r"the search ended outside physics: K .*, T .*; fix some"):
        estimated(gusty_minute, EstimateMethod.MULTIPLE_SHOOTING)


def test_prediction_error_returns_to_the_basin(gusty_minute: Record) -> None:
    found = estimated(gusty_minute, EstimateMethod.AUTO)
    error = found.estimate.common_parameters[:2] - [0.15, 8.0]
    assert np.all(np.abs(error) < 3.5 * found.interval.standard_error[:2])
    assert found.noise_model.disturbance == "first-order Markov on r"


@pytest.mark.parametrize(("names", "is_named"), [(("psi", "x0", "y0"), True), (("psi", "u", "v"), False)])
def test_a_search_lost_without_a_velocity_says_which_channels_show_sway(
    names: tuple[str, ...], *, is_named: bool
) -> None:
    time = 0.1 * np.arange(100)
    ship = {"L": 50.0, "m": 1e6, "x_G": 0.0, "I_z": 1.6e8, "rho": 1025.0, "U_n": 5.0, "X_u": -0.001}
    model = abkowitz(("Y_v", "N_d")).with_values(ship)
    run = Record.from_arrays("run", time, {"delta": np.sin(time), **dict.fromkeys(names, 0.1 * time)})
    problem = output_error_problem(model, Runs.one_session_each([run], LENGTH), np.inf, EstimateSettings(), 1)
    solution = Solution(np.array([-4e3, 500.0]), 1.0, Status.CONVERGED, 1)
    optimum = Optimum(solution, local := np.zeros((1, len(problem.starts))), problem.normal(problem.start(), local))
    with pytest.raises(InputError) as caught:
        refuse_implausible(PointEstimate(problem, optimum), np.array([1e8, 1e7]))
    assert ("declare channels.u and channels.v, or channels.sog and channels.cog" in str(caught.value)) == is_named


@pytest.fixture(scope="module")
def record() -> Record:
    clean = manoeuvre(
        waterjet(), programme("zigzag:20/20"), inputs={"v_j": 1.866}, slew_rate=math.radians(4.0), duration=200.0
    )
    return with_sensor_noise(clean, np.random.default_rng(2), 2)


def curvature(model: Model, record: Record) -> tuple[np.ndarray, tuple[str, ...], np.ndarray]:
    """Information about the coefficients at the truth, initial state unknown."""
    problem = OutputError(
        model, cut_segments(model, [record], tuple(SENSOR_NOISE), None), np.array([*SENSOR_NOISE.values()])
    )
    return (
        problem.normal(problem.start(), problem.measured_initial_states()).without_local()[1],
        problem.free,
        problem.start(),
    )


def freed(*names: str) -> Model:
    model = waterjet()
    return model.with_parameters(model.parameters.freed(*names))


@pytest.mark.parametrize(
    ("extra", "named"),
    [
        (("A_j", "m_x", "m_y", "J_z"), {"A_j", "m_x", "N_v", "N_r", "Y_v"}),
        (("x_T", "J_z"), {"x_T", "J_z", "N_v", "N_r", "N_rr"}),
    ],
)
def test_scalings_of_the_equations_are_found(record: Record, extra: tuple[str, ...], named: set[str]) -> None:
    """All forces and inertias times one number, or the yaw row alone: every trajectory is the same."""
    curved = curvature(freed(*extra), record)
    share, direction = weakest_direction(*curved)
    assert share < 1e-13
    assert named <= set(direction.split()[1::2])
    with pytest.raises(
        InputError, match=r"do not determine the direction .* fix one of these parameters under \[model"
    ):
        refuse_singular(*curved)


@pytest.mark.parametrize("extra", [(), ("A_j",)])
def test_what_can_be_stated_is_not_refused(record: Record, extra: tuple[str, ...]) -> None:
    refuse_singular(*curvature(freed(*extra), record))


def test_relative_changes_along_a_scaling_are_equal(record: Record) -> None:
    direction = weakest_direction(*curvature(freed("x_T", "J_z"), record))[1].split()
    changes = dict(zip(direction[1::2], map(float, direction[::2]), strict=True))
    np.testing.assert_allclose([changes[n] for n in ("N_v", "N_r", "N_rr", "x_T")], 1.0, atol=0.06)


def test_a_parameter_without_influence_is_named_alone() -> None:
    hessian = np.diag([1.0, 0.0, 2.0])
    assert weakest_direction(hessian, ("a", "b", "c"), np.ones(3)) == (0.0, "b")
