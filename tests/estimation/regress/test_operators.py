"""Operators and weak form: exact where theory says so, features as the equations have them, nothing across a gap."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.estimation.regress.linear import zigzags

from seatrial.core.equations import Model, Sheet
from seatrial.core.values import InputError, Prior, Record
from seatrial.estimation.regress.operators import (
    Central,
    Centred,
    DerivativeOperator,
    Differenced,
    Euler,
    RegressionMotion,
    RegressionRows,
    Smoothed,
    Weak,
    WeakForm,
    features,
    window_bounds,
    window_function,
)
from seatrial.numerics.optimise import Status, levenberg_marquardt
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import DRAUGHT, LENGTH, MASS, RHO, TABLE_2, waterjet

TRUE = np.array([p.value for p in waterjet().parameters.free])


def left(rows: RegressionRows) -> np.ndarray:
    """What the true coefficients leave of surge, sway and yaw."""
    return (rows.target - rows.slope @ TRUE)[:, :3]


def test_central_differences_are_of_second_order_where_euler_is_of_first() -> None:
    """Half the step: a quarter of the error, half of Euler's; away from the corners of the nozzle angle."""
    craft = waterjet()
    sizes = {}
    for rate in (5.0, 10.0):
        motion = RegressionMotion.from_record(craft, zigzags().between(62.0, 70.0).resampled(rate))
        for operator in (Euler(), Central()):
            sizes[operator, rate] = float(np.max(np.abs(left(operator.rows(craft, motion))[:, 1])))
    assert sizes[Euler(), 5.0] / sizes[Euler(), 10.0] == pytest.approx(2.0, rel=0.1)
    assert sizes[Central(), 5.0] / sizes[Central(), 10.0] == pytest.approx(4.0, rel=0.2)


@pytest.mark.parametrize("operator", [Euler(), Central(), Smoothed(2.0), Weak(10.0)])
def test_true_coefficients_leave_little(operator: DerivativeOperator) -> None:
    """Less than a twentieth of the sway accelerations."""
    craft, motion = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    rows = operator.rows(craft, motion)
    assert np.std(left(rows)[:, 1]) < 0.05 * np.std(rows.target[:, 1])


def test_a_quasi_difference_is_the_row_less_rho_times_the_one_before() -> None:
    """Song et al. 2025, eq. (17)."""
    craft, motion = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    plain, quasi = Euler().rows(craft, motion), Differenced(Euler(), 0.9).rows(craft, motion)
    np.testing.assert_allclose(quasi.target, plain.target[1:] - 0.9 * plain.target[:-1])
    np.testing.assert_allclose(quasi.slope, plain.slope[1:] - 0.9 * plain.slope[:-1])


def test_centred_rows_have_no_mean() -> None:
    """Song et al. 2025, eq. (18); what is constant becomes zero, not rounding."""
    craft, motion = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    rows = Centred(Euler()).rows(craft, motion)
    np.testing.assert_allclose(rows.slope.mean(axis=0), 0.0, atol=1e-12)
    still = RegressionMotion(motion.time, np.tile(motion.states[100], (len(motion.time), 1)), motion.inputs)
    assert not Centred(Euler()).rows(craft, still).slope.any()


@pytest.mark.parametrize("operator", [Euler(), Central(), Smoothed(2.0), Weak(4.0), Differenced(Euler())])
def test_no_row_reaches_across_a_gap(operator: DerivativeOperator) -> None:
    """Two stretches give the rows of each, whatever lies between them."""
    craft, whole = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    first, second = whole.rows(slice(0, 400)), whole.rows(slice(700, 1500))
    both = RegressionMotion(
        np.concatenate([first.time, second.time]),
        np.concatenate([first.states, second.states]),
        np.concatenate([first.inputs, second.inputs]),
    )
    parts = [operator.rows(craft, m).target for m in (first, second)]
    np.testing.assert_allclose(operator.rows(craft, both).target, np.concatenate(parts), rtol=1e-9, atol=1e-12)


def test_the_weak_form_is_exact_for_windows_of_any_polynomial_motion() -> None:
    """Known terms alone: with x = t^2 the window's mean rate is 2 t at its middle."""
    craft, motion = waterjet(), RegressionMotion.from_record(waterjet(), zigzags())
    time = motion.time
    states = motion.states.copy()
    states[:, 4] = time**2
    moved = RegressionMotion(time, states, motion.inputs)
    rows = Weak(5.0).rows(craft, moved)
    known = np.interp(rows.time, time, features(craft, moved).known_rates[:, 4])
    assert np.max(np.abs(rows.target[:, 4] + known - 2.0 * rows.time)) < 0.1


def test_rates_are_known_terms_plus_features_times_coefficients() -> None:
    """Known terms do not change with the coefficients."""
    craft, other = waterjet(), waterjet().with_values({"Y_v": -0.1, "N_rr": 0.0})
    motion = RegressionMotion.from_record(craft, zigzags())
    one, two = features(craft, motion), features(other, motion)
    np.testing.assert_allclose(one.known_rates, two.known_rates, atol=1e-14)
    rates = one.known_rates + one.slope @ np.array(list(TABLE_2.values()))
    middle = np.gradient(motion.states[:, 1], motion.dt)
    np.testing.assert_allclose(rates[50:-50, 1], middle[50:-50], atol=2e-4)


def test_the_published_features_come_out_of_the_equations() -> None:
    """Song et al. 2025, eq. (14), sway: [v U, r U L, v|v|, |v| r L, r|r| L^2] rho L d / 2 over the mass."""
    craft, record = waterjet(), zigzags()
    motion = RegressionMotion.from_record(craft, record)
    u, v, r = (record[s] for s in "uvr")
    speed, r_L = np.hypot(u, v), LENGTH * r
    by_hand = np.stack([v * speed, r_L * speed, v * abs(v), abs(v) * r_L, r_L * abs(r_L)], axis=1)
    by_hand *= 0.5 * RHO * LENGTH * DRAUGHT / (MASS * 1.785)
    places = [craft.parameters.free_names.index(n) for n in ("Y_v", "Y_r", "Y_vv", "Y_vr", "Y_rr")]
    np.testing.assert_allclose(features(craft, motion).slope[:, 1, places], by_hand, atol=1e-9)


def test_a_coefficient_that_is_not_linear_is_named() -> None:
    """The time constant of Nomoto's equation divides the gain."""
    ship = nomoto()
    record = Record.from_arrays(
        "run",
        np.arange(20.0),
        {"u": np.ones(20), "r": np.sin(np.arange(20.0)), "psi": np.zeros(20), "delta": np.ones(20)},
    )
    with pytest.raises(InputError, match="model 'nomoto' is not linear in K, T"):
        features(ship.with_values({"T": 8.0, "K": 0.1}), RegressionMotion.from_record(ship, record))


def test_stretches_end_where_samples_were_taken_away() -> None:
    """A gap of two samples parts the motion."""
    motion = RegressionMotion.from_record(waterjet(), zigzags())
    kept = np.r_[0:40, 42:90]
    cut = RegressionMotion(motion.time[kept], motion.states[kept], motion.inputs[kept])
    assert cut.gapless_slices() == [slice(0, 40), slice(40, 88)]


def test_a_sample_without_a_value_is_named_and_two_samples_are_too_few() -> None:
    """Cleaning takes it away; regression does not guess."""
    record = zigzags()
    v = record["v"].copy()
    v[30] = np.nan
    with pytest.raises(InputError, match=r"channel .v. has no value at sample 31; use regress\.cleaning"):
        RegressionMotion.from_record(waterjet(), record.with_channel("v", record.channel("v").with_values(v)))
    with pytest.raises(InputError, match="has 2 samples; regression needs at least three"):
        RegressionMotion.from_record(waterjet(), record.rows(slice(0, 2)))


Array = NDArray[np.float64]
DT = 0.1


@cache
def oscillator() -> Model:
    """x' = -a x + b w, w' = -b x - c w: two rates, linear in a, b, c."""
    sheet = Sheet("decay")
    x, w = sheet.states("x w")
    force = sheet.input("force")
    a, b, c = (sheet.parameter(n, v, free=True) for n, v in (("a", 0.05), ("b", 0.9), ("c", 0.02)))
    sheet.rate(x, -a * x + b * w + force)
    sheet.rate(w, -b * x - c * w)
    return sheet.model()


def exact_states(time: Array) -> Array:
    """The solution from (1, 0) without force."""
    a, b, c = 0.05, 0.9, 0.02
    matrix = np.array([[-a, b], [-b, -c]])
    values, vectors = np.linalg.eig(matrix)
    weights = np.linalg.solve(vectors, np.array([1.0, 0.0]))
    return np.real(np.exp(np.outer(time, values)) * weights @ vectors.T)


@pytest.fixture
def weak() -> WeakForm:
    time = DT * np.arange(600)
    x = np.ascontiguousarray(exact_states(time))
    return WeakForm(oscillator(), (x,), (np.zeros((600, 1)),), DT, 5.0, np.ones(2))


def test_a_weak_form_is_linearised_once_at_a_point(weak: WeakForm) -> None:
    point = np.array([p.value for p in weak.model.parameters.free])
    residuals, jacobian = weak.linearised(point)
    louder = weak.weighted(2.0 * weak.residual_sd)
    assert louder.linearised(point)[0] is residuals and louder.cost(point, np.zeros((0, 0))) > 0.0
    moved = weak.linearised(point + 0.1)[0]
    assert not np.array_equal(moved, residuals)
    shorter = replace(weak, states=(weak.states[0][:300],), inputs=(weak.inputs[0][:300],))
    assert len(shorter.linearised(point)[0]) < len(residuals)
    np.testing.assert_array_equal(weak.linearised(point)[1], jacobian)


def test_windows_cover_the_record_half_overlapping() -> None:
    found = window_bounds(101, 20)
    assert found[0] == (0, 40)
    assert {b - a for a, b in found} == {40}
    assert found[-1][1] == 100
    assert {b - a for a, b in zip([f[0] for f in found], [f[0] for f in found][1:], strict=False)} == {10}
    assert window_bounds(30, 100) == [(0, 28), (14, 42)][:1]


def test_window_vanishes_with_its_slope_at_the_ends() -> None:
    w, slope = window_function(50, DT)
    assert w[0] == w[-1] == slope[0] == slope[-1] == 0.0
    assert w[50] == 1.0
    np.testing.assert_allclose(slope[1:-1], np.gradient(w, DT)[1:-1], atol=2e-3)
    assert abs(np.sum(slope)) < 1e-12


def test_true_parameters_leave_no_residual(weak: WeakForm) -> None:
    """Up to the trapezoidal rule's error, sixth order in the sample interval for this window."""
    errors = []
    for rate in (1, 2):
        time = DT / rate * np.arange(600 * rate)
        x = np.ascontiguousarray(exact_states(time))
        finer = replace(weak, states=(x,), inputs=(np.zeros((len(x), 1)),), dt=DT / rate)
        errors.append(np.max(np.abs(finer.linearised(np.array([0.05, 0.9, 0.02]))[0])))
        wrong = np.max(np.abs(finer.linearised(np.array([0.05, 0.8, 0.02]))[0]))
        assert errors[-1] < 2e-6 * wrong
    assert errors[0] / errors[1] > 10.0


def test_one_step_from_zero_recovers_what_enters_linearly(weak: WeakForm) -> None:
    found = levenberg_marquardt(weak, np.zeros(3), np.zeros((0, 0))).solution
    np.testing.assert_allclose(found.point, [0.05, 0.9, 0.02], rtol=1e-5)
    assert found.status is Status.CONVERGED


def test_jacobian_and_gradient_against_differences(weak: WeakForm) -> None:
    weak = replace(weak, residual_sd=np.array([0.5, 2.0]))
    point, none = np.array([0.1, 0.5, 0.3]), np.zeros((0, 0))
    jacobian, normal = weak.linearised(point)[1], weak.normal(point, none)
    assert normal.cost == pytest.approx(weak.cost(point, none))
    for i, h in enumerate(1e-5 * np.eye(3)):
        column = (weak.linearised(point + h)[0] - weak.linearised(point - h)[0]) / 2e-5
        np.testing.assert_allclose(jacobian[:, :, i], column, atol=1e-9)
        slope = (weak.cost(point + h, none) - weak.cost(point - h, none)) / 2e-5
        assert normal.gradient[i] == pytest.approx(slope, rel=1e-6)


def test_offsets_of_states_do_not_matter_to_the_window() -> None:
    """A record far from the origin: position-like states lose no digits."""
    sheet = Sheet("drift")
    (x,) = sheet.states("x")
    sheet.rate(x, sheet.parameter("k", 1.0, free=True))
    model, time, found = sheet.model(), DT * np.arange(200), []
    for origin in (0.0, 1e6):
        states = np.ascontiguousarray(origin + 0.3 * time[:, None])
        weak = WeakForm(model, (states,), (np.zeros((200, 0)),), DT, 4.0, np.ones(1))
        found.append(levenberg_marquardt(weak, np.zeros(1), np.zeros((0, 0))).solution.point[0])
    assert found[0] == pytest.approx(0.3, rel=1e-5)
    assert found[1] == pytest.approx(found[0], rel=1e-8)


def test_noise_is_averaged_not_differentiated(weak: WeakForm, rng: np.random.Generator) -> None:
    """Against regression on central differences of the same noisy states."""
    noisy = weak.states[0] + 0.01 * rng.standard_normal(weak.states[0].shape)
    found = levenberg_marquardt(replace(weak, states=(noisy,)), np.zeros(3), np.zeros((0, 0))).solution.point
    rates = np.gradient(noisy, DT, axis=0)
    x, w, zero = noisy[:, 0], noisy[:, 1], np.zeros(len(noisy))
    features = np.concatenate([np.stack([-x, w, zero], axis=1), np.stack([zero, -x, -w], axis=1)])
    naive = np.linalg.lstsq(features, rates.T.ravel())[0]
    truth = np.array([0.05, 0.9, 0.02])
    assert np.max(np.abs(found - truth)) < 2e-3
    assert np.max(np.abs(found - truth)) < 0.5 * np.max(np.abs(naive - truth))


def test_priors_and_bounds_come_from_the_parameters(weak: WeakForm) -> None:
    parameters = weak.model.parameters.with_priors({"a": Prior(0.2, 1e-6)}).bounded("c", 0.1, 1.0)
    weak = replace(weak, model=weak.model.with_parameters(parameters), residual_sd=np.full(2, 1e-3))
    found = levenberg_marquardt(weak, np.array([0.0, 0.0, 0.5]), np.zeros((0, 0))).solution.point
    assert found[0] == pytest.approx(0.2, abs=1e-3)
    assert found[2] == pytest.approx(0.1)


def test_several_runs_count_together(weak: WeakForm) -> None:
    double = replace(weak, states=weak.states * 2, inputs=weak.inputs * 2)
    point, none = np.zeros(3), np.zeros((0, 0))
    assert double.cost(point, none) == pytest.approx(2 * weak.cost(point, none))


def test_a_held_input_is_integrated_as_it_acts(rng: np.random.Generator) -> None:
    """The state of x' = -a x + u, u constant between samples, in closed form; straight lines would put u half a
    sample early."""
    sheet = Sheet("held")
    x = sheet.states("x")[0]
    force = sheet.input("force", is_held=True)
    a, b = (sheet.parameter(n, 1.0, free=True) for n in ("a", "b"))
    sheet.rate(x, -a * x + b * force)
    force_values, decay = rng.standard_normal(2000), np.exp(-0.3 * DT)
    states = np.zeros(2000)
    for k in range(1999):
        states[k + 1] = decay * states[k] + 2.0 * (1.0 - decay) / 0.3 * force_values[k]
    weak = WeakForm(sheet.model(), (states[:, None],), (force_values[:, None],), DT, 5.0, np.ones(1))
    solution = levenberg_marquardt(weak, np.ones(2), np.zeros((0, 0))).solution
    np.testing.assert_allclose(solution.point, [0.3, 2.0], rtol=2e-3)
