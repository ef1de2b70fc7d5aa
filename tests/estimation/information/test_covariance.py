"""Intervals, directions, differences and consequences of assumed values, against exact results of linear problems."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy import stats
from scipy.signal import lfilter
from scipy.stats import chi2, norm

from seatrial.estimation.information.covariance import (
    Interval,
    QuantityInterval,
    RunScores,
    bootstrap,
    collinearity,
    condition_number,
    consequence_text,
    differences,
    directions,
    effective_parameters,
    estimate_shifts,
    excess_spread,
    from_information,
    inverse,
    jackknife,
    joint_test,
    relative_information,
    sandwich,
    with_prior,
)

Array = NDArray[np.float64]
RUNS, ROWS, UNKNOWNS = 12, 40, 3


@pytest.fixture
def runs(rng: np.random.Generator) -> tuple[Array, Array]:
    """Matrices (runs, rows, unknowns) and right sides of a linear problem."""
    matrices = rng.standard_normal((RUNS, ROWS, UNKNOWNS)) * np.array([1.0, 5.0, 0.01])
    return matrices, matrices @ np.array([1.0, -2.0, 300.0]) + rng.standard_normal((RUNS, ROWS))


def normal_equations(matrices: Array, right: Array, point: Array) -> tuple[Array, Array]:
    gradients = np.einsum("srk,sr->sk", matrices, matrices @ point - right)
    return gradients, np.einsum("sri,srj->sij", matrices, matrices)


def solve(matrices: Array, right: Array) -> Array:
    return np.linalg.lstsq(matrices.reshape(-1, UNKNOWNS), right.ravel())[0]


def test_one_step_is_exact_where_the_problem_is_linear(runs: tuple[Array, Array]) -> None:
    matrices, right = runs
    gradients, hessians = normal_equations(matrices, right, solve(matrices, right))
    refits = np.array([solve(np.delete(matrices, i, 0), np.delete(right, i, 0)) for i in range(RUNS)])
    exact = (RUNS - 1) / RUNS * (refits - refits.mean(axis=0)).T @ (refits - refits.mean(axis=0))
    steps = RunScores.from_normals(hessians.sum(axis=0), gradients, hessians).left_out_steps
    interval = jackknife(steps, "one-step")
    np.testing.assert_allclose(interval.covariance, exact, rtol=1e-8)
    assert interval.degrees_of_freedom == RUNS - 1
    assert interval.half_width[0] == pytest.approx(stats.t.ppf(0.975, RUNS - 1) * np.sqrt(exact[0, 0]))


def test_what_one_run_alone_identifies_gets_the_error_of_the_information_matrix(runs: tuple[Array, Array]) -> None:
    """One run has an unknown to itself, as the only one with astern commands has; the others keep theirs."""
    matrices, right = runs
    matrices[1:, :, 2] = 0.0
    right = right + 300.0 * (matrices[:, :, 2] - runs[0][:, :, 2])
    gradients, hessians = normal_equations(matrices, right, solve(matrices, right))
    gradients[0, 2] += 1e-9  # rounding of a gradient that is zero at the optimum; divided by rounding before
    information = hessians.sum(axis=0)
    interval = RunScores.from_normals(information, gradients, hessians).interval("over runs")
    assert interval.standard_error[2] == pytest.approx(from_information(information).standard_error[2], rel=0.1)
    others = [np.delete(matrices[:, :, :2], i, 0).reshape(-1, 2) for i in range(RUNS)]
    ends = [np.linalg.lstsq(a, np.delete(right, i, 0).ravel())[0] for i, a in enumerate(others[1:], 1)]
    assert np.all(interval.standard_error[:2] < 2.0 * np.std(ends, axis=0) * np.sqrt(RUNS - 1))


def test_spread_over_runs_is_unbiased_where_one_run_holds_most_of_the_information(rng: np.random.Generator) -> None:
    """White noise of unit size, so that the true covariance is H^-1; the jackknife's is far too wide there."""
    matrices = rng.standard_normal((4, ROWS, UNKNOWNS)) * np.array([[5.0], [1.0], [1.0], [1.0]])[:, :, None]
    hessians = np.einsum("sri,srj->sij", matrices, matrices)
    information = hessians.sum(axis=0)
    unbiased, left_out = [], []
    for _ in range(2000):
        right = rng.standard_normal((4, ROWS))
        gradients, _ = normal_equations(matrices, right, solve(matrices, right))
        scores = RunScores.from_normals(information, gradients, hessians)
        unbiased.append(np.diag(scores.interval("").covariance))
        left_out.append(np.diag(jackknife(scores.left_out_steps, "").covariance))
    true = np.diag(np.linalg.inv(information))
    np.testing.assert_allclose(np.mean(unbiased, axis=0) / true, 1.0, atol=0.06)  # 3 standard errors of 2000 draws
    assert np.all(np.mean(left_out, axis=0) > 3.0 * true)


def test_spread_over_runs_of_equal_weight_is_the_jackknifes(runs: tuple[Array, Array]) -> None:
    matrices, right = np.repeat(runs[0][:1], RUNS, axis=0), runs[1]
    gradients, hessians = normal_equations(matrices, right, solve(matrices, right))
    scores = RunScores.from_normals(hessians.sum(axis=0), gradients, hessians)
    by_jackknife = jackknife(scores.left_out_steps, "").covariance
    np.testing.assert_allclose(scores.interval("").covariance, by_jackknife, rtol=1e-9)


def test_information_matrix_of_white_noise(runs: tuple[Array, Array]) -> None:
    matrices, _ = runs
    joint = matrices.reshape(-1, UNKNOWNS)
    interval = from_information(joint.T @ joint)
    np.testing.assert_allclose(interval.covariance, np.linalg.inv(joint.T @ joint), rtol=1e-9)
    assert interval.half_width[1] == pytest.approx(1.959964 * interval.standard_error[1])


def test_sandwich_sees_the_colour_that_the_information_matrix_misses(rng: np.random.Generator) -> None:
    """Slow regressors under first-order autoregressive noise, true spread from many repeats."""
    blocks, rows, phi, repeats = 40, 50, 0.9, 400
    time = np.arange(blocks * rows)
    matrix = np.stack([np.ones(len(time)), np.sin(2 * np.pi * time / 500)], axis=1)
    noise = lfilter([np.sqrt(1 - phi**2)], [1, -phi], rng.standard_normal((repeats, len(time) + 200)))[:, 200:]
    hessian = matrix.T @ matrix
    estimates = noise @ matrix @ np.linalg.inv(hessian)
    true = estimates.std(axis=0)
    errors_stated = []
    for e, estimate in zip(noise, estimates, strict=True):
        left = (matrix @ estimate - e).reshape(blocks, rows)
        gradients = np.einsum("br,brk->bk", left, matrix.reshape(blocks, rows, 2))
        errors_stated.append(sandwich(hessian, gradients).standard_error)
    np.testing.assert_allclose(np.mean(errors_stated, axis=0), true, rtol=0.2)
    assert np.all(from_information(hessian).standard_error < 0.35 * true)


def test_inverse_where_scales_differ_widely(rng: np.random.Generator) -> None:
    matrix = rng.standard_normal((8, 4)) * np.array([1e-9, 1.0, 1e6, 1e3])
    hessian = matrix.T @ matrix
    scale = np.sqrt(np.diag(hessian))
    correlation = hessian / np.outer(scale, scale)
    np.testing.assert_allclose(inverse(hessian) * np.outer(scale, scale), np.linalg.inv(correlation), rtol=1e-9)


def test_a_singular_direction_gets_a_huge_error_not_zero() -> None:
    hessian = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    error = from_information(hessian).standard_error
    assert np.all(error[:2] > 1e5)
    assert error[2] == pytest.approx(1.0)


def test_a_parameter_without_influence_overflows_nothing() -> None:
    error = from_information(np.diag([1.0, 0.0])).standard_error
    assert error[0] == pytest.approx(1.0)
    assert np.isfinite(error[1])
    assert error[1] > 1e40


def test_a_coefficient_held_by_its_prior_keeps_the_priors_error() -> None:
    prior = np.array([1e6, 1e-12])
    hessian = np.diag(prior) + np.diag([1e-6, 1e3])
    silent = Interval(np.zeros((2, 2)), 11, "one-step jackknife over 12 runs")
    assert with_prior(silent, hessian, np.diag(prior)).standard_error[0] == pytest.approx(1e-3, rel=1e-6)
    assert with_prior(silent, hessian, np.diag(prior)).standard_error[1] < 1e-6


def test_the_jackknife_of_a_mean_is_its_variance(rng: np.random.Generator) -> None:
    values = rng.standard_normal((15, 2)) * [1.0, 30.0]
    without = np.array([np.delete(values, k, 0).mean(axis=0) for k in range(15)])
    np.testing.assert_allclose(jackknife(without, "").covariance, np.cov(values.T) / 15, rtol=1e-9)


def test_the_bootstrap_of_a_mean_is_its_variance(rng: np.random.Generator) -> None:
    values = rng.standard_normal((8, 1))
    drawn = values[rng.integers(0, 8, (20000, 8))].mean(axis=1)
    interval = bootstrap(drawn, 8, "")
    np.testing.assert_allclose(interval.covariance, np.atleast_2d(np.cov(values.T)) / 8, rtol=0.04)
    assert interval.degrees_of_freedom == 7


def test_the_spread_beyond_errors_is_that_of_known_numbers() -> None:
    """Values 1, 3 and 5 with errors of 1: variance 4, of which 1 is their error's."""
    chance, spread = excess_spread(np.array([1.0, 3.0, 5.0, np.nan]), np.array([1.0, 1.0, 1.0, 1.0]))
    assert spread == pytest.approx(np.sqrt(3.0))
    assert chance == pytest.approx(np.exp(-4.0))


@given(seed=st.integers(0, 1000), step=st.floats(-3.0, 3.0))
def test_the_answer_is_that_of_a_regression_with_the_wrong_value(seed: int, step: float) -> None:
    """Data without noise made by four columns; the third is assumed, `step` wrong."""
    rng = np.random.default_rng(seed)
    matrix, truth = rng.standard_normal((40, 4)), rng.standard_normal(4)
    fitted = np.array([0, 1, 3])
    data = matrix @ truth - matrix[:, 2] * (truth[2] + step)
    expected, left, *_ = np.linalg.lstsq(matrix[:, fitted], data)
    moves, misfit = estimate_shifts(matrix.T @ matrix, fitted, step * np.eye(4)[2])
    np.testing.assert_allclose(moves, expected - truth[fitted], atol=1e-9)
    assert misfit == pytest.approx(float(left[0]), abs=1e-9)


def test_an_assumed_value_that_a_fitted_one_can_replace_leaves_no_trace() -> None:
    matrix = np.array([[1.0, 2.0], [2.0, 4.0], [0.5, 1.0]])
    moves, misfit = estimate_shifts(matrix.T @ matrix, np.array([0]), np.array([0.0, 0.1]))
    assert moves[0] == pytest.approx(-0.2)
    assert misfit == pytest.approx(0.0, abs=1e-12)


def test_what_the_information_does_not_determine_stays() -> None:
    matrix = np.array([[1.0, 0.0, 2.0], [2.0, 0.0, 4.0], [0.5, 0.0, 1.5]])
    moves, misfit = estimate_shifts(matrix.T @ matrix, np.array([0, 1]), np.array([0.0, 0.0, 0.1]))
    assert moves[0] < 0.0
    assert moves[1] == 0.0
    assert misfit > 0.0


@pytest.mark.parametrize(
    ("misfit", "says"), [(2.0, "hardly show it (they would grow by 0.1 %, chi squared by 2)"), (300.0, "would show it")]
)
def test_words_say_whether_the_residuals_show_it(misfit: float, says: str) -> None:
    text = consequence_text("m_y", 0.1, {"Y_v": 0.1532, "N_v": -0.032, "N_r": 0.001}, misfit, 1000.0)
    assert text.startswith("were m_y 10 % larger, the estimates would shift, Y_v by +15 %, N_v by -3.2 %, and")
    assert says in text and "N_r" not in text


def test_words_when_nothing_shifts() -> None:
    assert consequence_text("x_G", 0.1, {"Y_v": 0.001}, 0.0, 1.0) == (
        "were x_G 10 % larger, no estimate would shift by half a per cent"
    )


def quantity(value: float | None, below: float = 0.0, above: float = 0.0) -> QuantityInterval:
    if value is None:
        return QuantityInterval("K", "1/s", None)
    return QuantityInterval("K", "1/s", value, value - below, value + above)


def test_symmetric_intervals_add_in_squares_and_others_side_by_side() -> None:
    (row,) = differences([quantity(1.0, 0.3, 0.3)], [quantity(2.0, 0.4, 0.4)])
    assert (row.difference, row.lower, row.upper) == pytest.approx((1.0, 0.5, 1.5))
    (row,) = differences([quantity(1.0, 0.3, 0.0)], [quantity(2.0, 0.4, 1.2)])
    assert row.lower == pytest.approx(1.0 - np.hypot(0.4, 0.0))
    assert row.upper == pytest.approx(1.0 + np.hypot(1.2, 0.3))


def test_joint_intervals_are_wider_for_more_rows() -> None:
    """A difference of 2.5 standard errors: significant alone, and among twenty not (Bonferroni: 3.02)."""
    half = norm.ppf(0.975)
    pair = quantity(0.0, half, half), quantity(2.5, 0.0, 0.0)
    others = [(quantity(0.0, half, half), quantity(0.0, 0.0, 0.0))] * 19
    assert differences([pair[0]], [pair[1]])[0].is_significant
    joint = differences([pair[0], *(a for a, _ in others)], [pair[1], *(b for _, b in others)])
    assert not joint[0].is_significant
    far = quantity(3.1, 0.0, 0.0)
    assert differences([pair[0], *(a for a, _ in others)], [far, *(b for _, b in others)])[0].is_significant


def test_what_is_not_determined_has_no_interval() -> None:
    known, unknown = quantity(1.0, 0.1, 0.1), QuantityInterval("K", "1/s", 2.0)
    (row,) = differences([known], [unknown])
    assert (row.difference, row.lower, row.is_significant) == (1.0, None, None)
    (row,) = differences([known], [quantity(None)])
    assert row.difference is None


def test_equal_coefficients_are_called_different_in_5_of_100_cases() -> None:
    rng = np.random.default_rng(3)
    root = np.array([[0.2, 0.0, 0.0], [1.0, 0.1, 0.0], [-3.0, 2.0, 4.0]])
    tests = [joint_test(root @ rng.standard_normal(3), root @ root.T) for _ in range(4000)]
    alarms = np.mean([t is not None and t.p < 0.05 for t in tests])
    assert alarms == pytest.approx(0.05, abs=0.012)  # three standard deviations of 4000 trials
    (one,) = [joint_test(np.array([0.2, 1.0, 1.0]), root @ root.T)]
    assert one is not None
    assert one.p == pytest.approx(chi2.sf(one.statistic, 3))


def test_directions_that_nothing_determines_are_left_out() -> None:
    flat = np.array([[1.0, 1.0], [1.0, 1.0]])
    test = joint_test(np.array([1.0, 1.0]), flat)
    assert test is not None
    assert (test.degrees_of_freedom, test.statistic) == (1, pytest.approx(1.0))
    assert joint_test(np.zeros(0), np.zeros((0, 0))) is None
    assert joint_test(np.ones(1), np.array([[np.inf]])) is None
    assert joint_test(np.ones(1), np.zeros((1, 1))) is None


def test_values_that_differ_by_rounding_are_one() -> None:
    """As of a speed that both fits have by definition, whose intervals have no width."""
    (row,) = differences([quantity(6.1)], [quantity(6.1 * (1.0 + 2.2e-16))])
    assert (row.difference, row.is_significant) == (0.0, False)
    (row,) = differences([quantity(6.1)], [quantity(6.1001)])
    assert row.is_significant


NAMES = ("a", "b", "c")


def rotated(deviations: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Information with the given standard deviations along random axes, and the axes as columns."""
    axes = np.linalg.qr(rng.standard_normal((len(deviations), len(deviations))))[0]
    return (axes / deviations**2) @ axes.T, axes


def test_directions_come_weakest_first_with_their_deviations(rng: np.random.Generator) -> None:
    deviations = np.array([2.0, 0.05, 0.001])
    information, axes = rotated(deviations, rng)
    found = directions(information, NAMES, np.ones(3))
    np.testing.assert_allclose([d.standard_deviation for d in found], deviations, rtol=1e-6)
    for direction, axis in zip(found, axes.T, strict=True):
        vector = np.array([direction.combination[n] for n in NAMES])
        assert abs(vector @ axis) == pytest.approx(1.0, abs=1e-6)
        assert list(map(abs, direction.combination.values())) == sorted(map(abs, vector), reverse=True)


def test_sizes_make_changes_relative_with_the_sign_of_the_value() -> None:
    """Known: a to .1 of its 10, b to .2 of its -2: 1 % and 10 % of them."""
    information = np.diag([1 / 0.1**2, 1 / 0.2**2])
    weakest, strongest = directions(information, ("a", "b"), np.array([10.0, -2.0]))
    assert weakest.standard_deviation == pytest.approx(0.1)
    assert weakest.text == "b is determined to 10 %"
    assert strongest.text == "a is determined to 1 %"


@pytest.mark.parametrize(
    ("deviation", "says"),
    [(0.02, "is determined to 2 %"), (0.5, "leave 50 % open"), (3.0, "determine nothing"), (np.inf, "any amount")],
)
def test_words_say_how_well_a_combination_is_known(deviation: float, says: str) -> None:
    axis = np.array([0.8, -0.6])
    across = np.array([0.6, 0.8])
    weight = 0.0 if np.isinf(deviation) else deviation**-2
    information = weight * np.outer(axis, axis) + 1e6 * np.outer(across, across)
    text = directions(information, ("a", "b"), np.ones(2))[0].text
    assert "+0.80 a -0.60 b" in text and says in text


def test_words_say_what_a_prior_leaves_of_an_open_direction() -> None:
    """Two directions the records leave open; a prior of 3 % holds one of them."""
    information = np.diag([1.0, 0.25, 1e6])
    weakest, next_one, third = directions(information, NAMES, np.ones(3), np.diag([0.03**-2, 0.0, 0.01**-2]))
    assert weakest.text == "b is not determined: it may be wrong by 200 %"
    assert next_one.text == ("a is determined vaguely, to 100 %; what is known besides the records holds it to 3 %")
    assert third.text == "c is determined to 0.1 %"
    assert weakest.standard_deviation == pytest.approx(2.0), "of the records alone"


def test_effective_parameters_count_what_data_tell_against_a_prior() -> None:
    information, precision = np.diag([99.0, 1.0, 0.0]), np.diag([1.0, 1.0, 1.0])
    along = directions(information, NAMES, np.ones(3))
    assert effective_parameters(information, precision, along) == pytest.approx(0.99 + 0.5)
    assert effective_parameters(information, np.zeros((3, 3)), along) == 1.0


def test_a_combination_is_no_better_known_than_the_intervals_have_it() -> None:
    """Runs left out scatter by 200 % along a: model error that the information does not know of."""
    information = np.diag([0.01**-2, 0.02**-2, 0.05**-2])
    weakest, *_ = directions(information, NAMES, np.ones(3), covariance=np.diag([4.0, 1e-6, 1e-6]))
    assert weakest.text == "a is not determined: it may be wrong by 200 %"
    along = directions(information, NAMES, np.ones(3), covariance=np.diag([4.0, 1e-6, 1e-6]))
    assert [d.standard_deviation for d in along] == pytest.approx([2.0, 0.05, 0.02])
    assert effective_parameters(information, np.zeros((3, 3)), along) == 2.0


@given(arrays(float, 3, elements=st.floats(0.01, 100.0)))
def test_variance_inflation_and_condition_know_no_units(sizes: np.ndarray) -> None:
    information = np.array([[4.0, 1.9, 0.1], [1.9, 1.0, 0.0], [0.1, 0.0, 9.0]])
    here, there = (collinearity(m, NAMES) for m in (information, relative_information(information, sizes)))
    for one, other in zip(here, there, strict=True):
        assert one.partner == other.partner
        assert one.variance_inflation == pytest.approx(other.variance_inflation, rel=1e-6)
    assert condition_number(relative_information(information, sizes)) == pytest.approx(
        condition_number(information), rel=1e-6
    )


def test_two_almost_equal_columns_are_each_other_s_partners(rng: np.random.Generator) -> None:
    """VIF = 1 / (1 - R^2) of the regression of one column on the others."""
    matrix = rng.standard_normal((400, 3))
    matrix[:, 1] = matrix[:, 0] + 0.1 * matrix[:, 1]
    found = collinearity(matrix.T @ matrix, NAMES)
    others = matrix[:, [1, 2]]
    left = matrix[:, 0] - others @ np.linalg.lstsq(others, matrix[:, 0])[0]
    assert found[0].variance_inflation == pytest.approx(matrix[:, 0] @ matrix[:, 0] / (left @ left), rel=1e-6)
    assert (found[0].partner, found[1].partner) == ("b", "a")
    assert found[0].correlation < -0.9
    assert found[2].variance_inflation < 1.1


def test_a_missing_direction_has_infinite_condition() -> None:
    assert condition_number(np.ones((2, 2))) == np.inf
