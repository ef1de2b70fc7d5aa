"""What a fit of simulated trials tells, against the craft that made them and against fits with wrong assumptions."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import Identifiability
from seatrial.core.values import ForceContent, ForcePoints, Prior, Record
from seatrial.data.example_series import SENSOR_NOISE, simulate_run, true_model, with_sensor_noise
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.identify import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.identify.identifiability import consequences, identifiability, sensitivities
from seatrial.estimation.identify.nonlinear_intervals import CHI_SQUARED_LIMIT, profiles
from seatrial.estimation.information.covariance import directions, inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.numerics.optimise import Optimum, levenberg_marquardt
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.abkowitz import STANDARD, abkowitz
from seatrial.physics.models.published import kvlcc2_l7
from seatrial.physics.simulate import replay
from seatrial.physics.simulate.steer import manoeuvre

RATE, EXECUTES = 2.0, 5
# a course-stable ship of moderate turning, in the L^2 prime system
ABKOWITZ = {
    **dict.fromkeys(STANDARD, 0.0), "X_u": -0.0036, "X_vv": -0.0026, "Y_v": -0.0207, "Y_r": 0.004, "Y_d": -0.004,
    "N_v": -0.0090, "N_r": -0.0042, "N_d": 0.002, "Y_vvv": -0.1056, "N_rrr": -0.00085,
    "X_udot": -0.00145, "Y_vdot": -0.01465, "N_rdot": -0.0007, "U_n": 1.18,
}  # fmt: skip

ONE_WORKER = EstimatorOptions(workers=1)


@pytest.fixture(scope="module")
def record() -> Record:
    """The consecutive zigzags of the demonstration, 2075 s."""
    return with_sensor_noise(
        simulate_run(true_model(), f"consecutive-zigzags:{EXECUTES}").resampled(RATE), np.random.default_rng(3), 3
    )


@pytest.fixture(scope="module")
def found(record: Record) -> Estimation:
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    return estimate_model(true_model(), Runs.one_session_each([record], 9.8), settings, ONE_WORKER)


@pytest.fixture(scope="module")
def answer(found: Estimation) -> Identifiability:
    return identifiability(found, (), {"u": 0.8, "v_j": 1.866}, 9.8)


def test_the_weakest_direction_is_the_one_of_this_craft(answer: Identifiability) -> None:
    """X_rr against X_vv and Y_vr, in relative changes."""
    weakest = answer.directions[0].combination
    assert set(list(weakest)[:3]) == {"X_rr", "Y_vr", "X_vv"}
    assert weakest["X_rr"] * weakest["X_vv"] < 0 and weakest["X_rr"] * weakest["Y_vr"] < 0
    assert answer.directions[0].standard_deviation > 5 * answer.directions[2].standard_deviation
    assert answer.effective_parameters == 11


def test_at_the_truth_the_weakest_direction_is_the_published_one() -> None:
    """-.70 X_rr +.49 X_vv +.47 Y_vr, 26 %, at 10 Hz; at another rate information goes with the number of samples."""
    clean = simulate_run(true_model(), f"consecutive-zigzags:{EXECUTES}").resampled(RATE)
    noise = np.array(list(SENSOR_NOISE.values()))
    problem = OutputError(
        true_model(), cut_segments(true_model(), [clean], tuple(SENSOR_NOISE), None), noise, workers=1
    )
    information = problem.normal(problem.start(), problem.measured_initial_states()).without_local()[1]
    weakest = directions(information, problem.free, problem.start())[0]
    part = weakest.combination
    assert (part["X_rr"], part["X_vv"], part["Y_vr"]) == pytest.approx((0.70, -0.49, -0.47), abs=0.02)
    assert weakest.standard_deviation * np.sqrt(RATE / 10.0) == pytest.approx(0.26, abs=0.015)
    assert weakest.text.startswith("along +0.71 X_rr -0.49 X_vv -0.46 Y_vr")


def test_the_craft_is_stable_on_its_course(answer: Identifiability) -> None:
    assert answer.stability is not None
    assert answer.stability.lower > 0


def test_a_wrong_added_mass_moves_the_estimates_as_foretold(found: Estimation, record: Record) -> None:
    """One Gauss-Newton step against a fit with the wrong value."""
    foretold = next(c for c in consequences(found) if c.parameter == "m_y")
    model = true_model()
    wrong = model.with_values({"m_y": 1.02 * model.parameters["m_y"].value})
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    again = estimate_model(wrong, Runs.one_session_each([record], 9.8), settings, ONE_WORKER)
    for name in ("Y_v", "X_vv", "Y_rr"):
        i = found.estimate.problem.free.index(name)
        moved = (
            again.estimate.common_parameters[i] - found.estimate.common_parameters[i]
        ) / found.estimate.common_parameters[i]
        assert moved == pytest.approx(0.2 * foretold.estimate_changes[name], rel=0.15), name
    assert foretold.estimate_changes["Y_v"] == pytest.approx(0.15, abs=0.02)
    assert "Y_v by +16 %" in foretold.text and "hardly show it" in foretold.text


def _fitted_with(found: Estimation, name: str, factor: float) -> Optimum:
    """The optimum of the same problem with another assumed value."""
    problem = found.estimate.problem
    value = factor * problem.model.parameters[name].value
    wrong = replace(problem, model=problem.model.with_values({name: value}))
    return levenberg_marquardt(wrong, found.estimate.common_parameters, found.estimate.optimum.local)


def test_thrust_five_per_cent_wrong_moves_the_yaw_moment_by_a_quarter(found: Estimation) -> None:
    """Hardly seen: chi squared grows by less than its own scatter, sqrt(2 N)."""
    foretold = next(c for c in consequences(found) if c.parameter == "A_j")
    again = _fitted_with(found, "A_j", 1.05)
    i = found.estimate.problem.free.index("N_v")
    moved = again.solution.point[i] / found.estimate.common_parameters[i] - 1.0
    assert moved == pytest.approx(0.24, abs=0.01)
    assert 0.5 * foretold.estimate_changes["N_v"] == pytest.approx(moved, rel=0.1)
    grown = 2.0 * (again.solution.value - found.estimate.optimum.solution.value)
    assert 0.0 < grown < np.sqrt(2.0 * np.isfinite(found.estimate.problem.data.measured).sum())


def test_the_misfit_is_the_growth_of_chi_squared_apart_from_what_noise_favours(found: Estimation) -> None:
    """Noise prefers one sign of the change; the mean over both signs is what is foretold."""
    foretold = next(c for c in consequences(found) if c.parameter == "x_T")
    least = found.estimate.optimum.solution.value
    both = [2.0 * (_fitted_with(found, "x_T", 1.0 + s).solution.value - least) for s in (0.02, -0.02)]
    assert np.mean(both) == pytest.approx(0.04 * foretold.misfit, rel=0.1)


def _towed(percent: float) -> StaticForces:
    """Hull and jet forces of the craft in drift and rotation, exact, of a stated standard deviation."""
    drift, turn = (a.ravel() for a in np.meshgrid(np.radians([-12.0, -6.0, 0.0, 6.0, 12.0]), [-0.06, 0.0, 0.06]))
    motion = {
        "u": 0.8 * np.cos(drift),
        "v": -0.8 * np.sin(drift),
        "r": turn,
        "delta": 0.0 * turn,
        "v_j": 1.866 + 0 * turn,
    }
    points = ForcePoints("towed", motion, {"N": 0.0 * turn}, {"N": 1.0}, ForceContent.HYDRODYNAMIC, source="simulated")
    moment = StaticForces(true_model(), points).forces(true_model().parameters.values)[:, 2]
    deviation = 0.01 * percent * float(np.max(np.abs(moment)))
    return StaticForces(true_model(), replace(points, forces={"N": moment}, sd={"N": deviation}))


def test_force_points_hold_what_a_wrong_assumption_would_move(found: Estimation) -> None:
    problem = replace(found.estimate.problem, extra_terms=(_towed(1.0),))
    optimum = levenberg_marquardt(problem, found.estimate.common_parameters, found.estimate.optimum.local)
    fused = replace(found, estimate=replace(found.estimate, problem=problem, optimum=optimum))
    alone, foretold = (next(c for c in consequences(f) if c.parameter == "A_j") for f in (found, fused))
    again = _fitted_with(fused, "A_j", 1.02)
    i = problem.free.index("N_v")
    moved = again.solution.point[i] / optimum.solution.point[i] - 1.0
    assert abs(foretold.estimate_changes["N_v"]) < 0.5 * abs(alone.estimate_changes["N_v"])
    assert 0.2 * foretold.estimate_changes["N_v"] == pytest.approx(moved, rel=0.1)


def test_what_defines_the_coefficients_is_not_assumed() -> None:
    """A switch between prime systems and the speed of an expansion are no facts about the ship."""
    model = abkowitz().with_values(ABKOWITZ).with_ship(kvlcc2_l7().ship)
    record = manoeuvre(model, programme("zigzag:20/20"), speed=1.18, slew_rate=np.radians(15.8))
    record = with_sensor_noise(record.resampled(2.0), np.random.default_rng(5), 5)
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    answer = consequences(estimate_model(model, Runs.one_session_each([record], 7.0), settings, ONE_WORKER))
    assert {c.parameter for c in answer} <= {"I_z", "x_G", "X_udot", "Y_vdot", "N_rdot"}
    assert "Y_vdot" in {c.parameter for c in answer}


def test_a_prior_of_an_assumed_value_does_not_show_in_the_misfit(found: Estimation) -> None:
    problem = found.estimate.problem
    known = problem.model.parameters.with_priors({"m_y": Prior(4349.0, 1.0, "not used while m_y is fixed")})
    made = replace(found.estimate, problem=replace(problem, model=problem.model.with_parameters(known)))
    one, other = (
        next(c for c in consequences(f) if c.parameter == "m_y") for f in (found, replace(found, estimate=made))
    )
    assert other.misfit == pytest.approx(one.misfit, rel=1e-9)


def test_sensitivities_are_changes_of_the_simulated_outputs(found: Estimation, record: Record) -> None:
    effect = {s.parameter: s for s in sensitivities(found)}["N_r"]
    model, start = found.model, found.estimate.optimum.local[0]
    initial = dict(zip(found.estimate.problem.starts, start, strict=True))
    value = model.parameters["N_r"].value
    up, down = (replay(model.with_values({"N_r": value * f}), record, initial) for f in (1.001, 0.999))
    noise = dict(zip(found.estimate.problem.data.outputs, found.estimate.problem.noise, strict=True))
    for output in ("r", "psi"):
        slope = np.sqrt(np.mean(((up[output] - down[output]) / 0.002) ** 2)) / noise[output]
        assert effect.outputs[output] == pytest.approx(0.1 * slope, rel=1e-2)


def test_the_profile_of_a_well_known_coefficient_is_its_interval(found: Estimation) -> None:
    (profile,) = profiles(found.estimate, found.interval.standard_error, ["N_rr"])
    i = found.estimate.problem.free.index("N_rr")
    centre, half = found.estimate.common_parameters[i], found.interval.half_width[i]
    assert profile.lower == pytest.approx(centre - half, abs=0.15 * half)
    assert profile.upper == pytest.approx(centre + half, abs=0.15 * half)
    assert np.all(np.diff(profile.values) > 0) and min(profile.costs) == 0.0 and max(profile.costs) > CHI_SQUARED_LIMIT


def test_a_profile_counts_the_prior_of_what_it_holds(found: Estimation) -> None:
    """With a prior three of its deviations off, profile and information still agree, about the same minimum."""
    problem, i = found.estimate.problem, found.estimate.problem.free.index("N_rr")
    spread = float(found.interval.standard_error[i])
    prior = Prior(float(found.estimate.common_parameters[i]) + 3.0 * spread, spread, "off")
    model = problem.model.with_parameters(problem.model.parameters.with_priors({"N_rr": prior}))
    held = replace(problem, model=model)
    optimum = levenberg_marquardt(held, found.estimate.common_parameters, found.estimate.optimum.local)
    (profile,) = profiles(PointEstimate(held, optimum), found.interval.standard_error, ["N_rr"])
    half = np.sqrt(CHI_SQUARED_LIMIT * inverse(optimum.normal.without_local()[1])[i, i])
    assert abs(optimum.solution.point[i] - found.estimate.common_parameters[i]) > spread
    assert profile.lower == pytest.approx(optimum.solution.point[i] - half, abs=0.05 * half)
    assert profile.upper == pytest.approx(optimum.solution.point[i] + half, abs=0.05 * half)
    assert profile.costs.count(0.0) == 1 and 5 <= len(profile.values) <= 7


def test_a_profile_ends_at_a_bound(found: Estimation) -> None:
    problem, i = found.estimate.problem, found.estimate.problem.free.index("N_rr")
    edge = float(found.estimate.common_parameters[i] + found.interval.standard_error[i])
    model = problem.model.with_parameters(problem.model.parameters.bounded("N_rr", -np.inf, edge))
    made = replace(found.estimate, problem=replace(problem, model=model))
    (profile,) = profiles(made, found.interval.standard_error, ["N_rr"])
    assert profile.upper is None and max(profile.values) <= edge
    assert profile.lower is not None


def test_prediction_error_has_no_profile_of_output_error(record: Record) -> None:
    """Its cost is another one; a comparison would give an interval of rounding's width."""
    settings = EstimateSettings(method=EstimateMethod.PREDICTION_ERROR)
    short = record.between(0.0, 400.0)
    filtered = estimate_model(true_model(), Runs.one_session_each([short], 9.8), settings, ONE_WORKER)
    assert filtered.has_process_noise
    assert profiles(filtered.estimate, filtered.interval.standard_error, ["N_rr"]) == ()


def test_a_direction_held_by_a_prior_does_not_count_as_stated(found: Estimation) -> None:
    """A prior much tighter than the records takes a parameter from them."""
    problem = found.estimate.problem
    tight = {"X_rr": Prior(0.00414, 1e-7, "tight")}
    model = problem.model.with_parameters(problem.model.parameters.with_priors(tight))
    held = replace(problem, model=model)
    normal = held.normal(found.estimate.common_parameters, found.estimate.optimum.local)
    made = replace(found.estimate, problem=held, optimum=replace(found.estimate.optimum, normal=normal))
    answer = identifiability(replace(found, estimate=made), (), {}, 9.8)
    assert answer.effective_parameters == pytest.approx(10.0, abs=0.1)
    assert answer.stability is None
