"""Levenberg-Marquardt against certified values, bounds, and eliminated local unknowns against the joint problem."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from seatrial.numerics.optimise import (
    NormalEquations,
    Optimum,
    Status,
    bounded_step,
    levenberg_marquardt,
    predicted_decrease,
)

Array = NDArray[np.float64]
NONE = np.zeros((0, 0))


@dataclass
class Curve:
    """Residuals and their Jacobian as a problem without local unknowns."""

    residuals: Callable[[Array], Array]
    jacobian: Callable[[Array], Array]
    lower: Array = field(default_factory=lambda: np.array(-np.inf))
    upper: Array = field(default_factory=lambda: np.array(np.inf))

    def cost(self, shared: Array, local: Array) -> float:
        assert local.size == 0
        with np.errstate(all="ignore"):
            e = self.residuals(shared)
        return 0.5 * float(e @ e) if np.all(np.isfinite(e)) else np.inf

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        assert local.size == 0
        with np.errstate(all="ignore"):
            e, j = self.residuals(shared), self.jacobian(shared)
        empty = np.zeros((0, len(shared), 0))
        return NormalEquations(0.5 * float(e @ e), j.T @ e, j.T @ j, np.zeros((0, 0)), np.zeros((0, 0, 0)), empty)


def solved(problem: Curve, start: list[float], evaluations: int = 200) -> Optimum:
    return levenberg_marquardt(problem, np.array(start), NONE, evaluations=evaluations, tolerance=1e-12)


# NIST StRD nonlinear regression: Misra1a (Misra 1978), certified values
MISRA_X = np.array([77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0])
MISRA_Y = np.array([10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78])
MISRA = Curve(
    lambda b: b[0] * (1 - np.exp(-b[1] * MISRA_X)) - MISRA_Y,
    lambda b: np.stack([1 - np.exp(-b[1] * MISRA_X), b[0] * MISRA_X * np.exp(-b[1] * MISRA_X)], axis=1),
)

# NIST StRD: Thurber (electron mobility against logarithm of density), higher difficulty, certified values
THURBER_X = np.array([
    -3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481, -2.363, -2.322, -1.501, -1.460,
    -1.274, -1.212, -1.100, -1.046, -0.915, -0.714, -0.566, -0.545, -0.400, -0.309, -0.109, -0.103, 0.010, 0.119,
    0.377, 0.790, 0.963, 1.006, 1.115, 1.572, 1.841, 2.047, 2.200,
])  # fmt: skip
THURBER_Y = np.array([
    80.574, 84.248, 87.264, 87.195, 89.076, 89.608, 89.868, 90.101, 92.405, 95.854, 100.696, 101.060, 401.672,
    390.724, 567.534, 635.316, 733.054, 759.087, 894.206, 990.785, 1090.109, 1080.914, 1122.643, 1178.351, 1260.531,
    1273.514, 1288.339, 1327.543, 1353.863, 1414.509, 1425.208, 1421.384, 1442.962, 1464.350, 1468.705, 1447.894,
    1457.628,
])  # fmt: skip
THURBER_CERTIFIED = [
    1.2881396800e03, 1.4910792535e03, 5.8323836877e02, 7.5416644291e01,
    9.6629502864e-01, 3.9797285797e-01, 4.9727297349e-02,
]  # fmt: skip


def _thurber(b: Array) -> tuple[Array, Array]:
    powers = THURBER_X[:, None] ** np.arange(4)
    top, bottom = powers @ b[:4], 1 + powers[:, 1:] @ b[4:]
    jacobian = np.concatenate([powers, -powers[:, 1:] * (top / bottom)[:, None]], axis=1) / bottom[:, None]
    return top / bottom - THURBER_Y, jacobian


THURBER = Curve(lambda b: _thurber(b)[0], lambda b: _thurber(b)[1])


@pytest.mark.parametrize("start", [[500.0, 1e-4], [250.0, 5e-4]])
def test_misra1a(start: list[float]) -> None:
    found = solved(MISRA, start).solution
    np.testing.assert_allclose(found.point, [2.3894212918e02, 5.5015643181e-04], rtol=1e-8)
    assert 2 * found.value == pytest.approx(1.2455138894e-01, rel=1e-9)
    assert found.status is Status.CONVERGED


@pytest.mark.parametrize(
    "start", [[1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03], [1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05]]
)
def test_thurber(start: list[float]) -> None:
    found = solved(THURBER, start).solution
    np.testing.assert_allclose(found.point, THURBER_CERTIFIED, rtol=1e-6)
    assert 2 * found.value == pytest.approx(5.6427082397e03, rel=1e-9)
    assert found.status is Status.CONVERGED


def test_standard_errors_from_the_normal_equations() -> None:
    """Certified standard deviations of Misra1a's estimates."""
    found = solved(MISRA, [250.0, 5e-4])
    variance = 2 * found.solution.value / (len(MISRA_X) - 2)
    errors = np.sqrt(np.diag(np.linalg.inv(found.normal.without_local()[1])) * variance)
    np.testing.assert_allclose(errors, [2.7070075241e00, 7.2668688436e-06], rtol=1e-6)


def _rosenbrock(
    lower: tuple[float, float] = (-np.inf, -np.inf), upper: tuple[float, float] = (np.inf, np.inf)
) -> Curve:
    return Curve(
        lambda x: np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]),
        lambda x: np.array([[-20 * x[0], 10.0], [-1.0, 0.0]]),
        np.array(lower),
        np.array(upper),
    )


@pytest.mark.parametrize("start", [[-1.2, 1.0], [6.3, -4.0], [-8.0, 30.0]])
def test_rosenbrock(start: list[float]) -> None:
    np.testing.assert_allclose(solved(_rosenbrock(), start).solution.point, [1.0, 1.0], rtol=1e-8)


def test_a_bound_across_a_curved_valley() -> None:
    """With x <= 0.5 the minimum lies at (0.5, 0.25)."""
    found = solved(_rosenbrock(upper=(0.5, np.inf)), [-1.2, 1.0])
    np.testing.assert_allclose(found.solution.point, [0.5, 0.25], rtol=1e-6)
    assert found.solution.status is Status.CONVERGED


def test_bounds_of_a_linear_problem(rng: np.random.Generator) -> None:
    matrix, right = rng.standard_normal((30, 6)), rng.standard_normal(30)
    limits = (np.full(6, -0.05), np.full(6, 0.05))
    problem = Curve(lambda x: matrix @ x - right, lambda _: matrix, *limits)
    expected = lsq_linear(matrix, right, limits, tol=1e-14)
    assert np.any(expected.active_mask)
    np.testing.assert_allclose(solved(problem, [0.04] * 6).solution.point, expected.x, atol=1e-6)


def test_a_start_outside_is_moved_to_the_bound() -> None:
    found = solved(_rosenbrock(lower=(2.0, -5.0), upper=(3.0, 5.0)), [100.0, 100.0]).solution
    np.testing.assert_allclose(found.point, [2.0, 4.0], rtol=1e-5)


class Separate:
    """Each block: y = a exp(-b t) + c_s + d_s t with shared a, b and local c, d; or all unknowns shared."""

    def __init__(self, rng: np.random.Generator, blocks: int = 4) -> None:
        self.t = np.linspace(0.0, 3.0, 25)
        offsets = rng.standard_normal((blocks, 2))
        self.y = 2.0 * np.exp(-0.7 * self.t) + offsets[:, :1] + offsets[:, 1:] * self.t
        self.y += 0.05 * rng.standard_normal(self.y.shape)
        self.lower, self.upper = np.full(2, -np.inf), np.full(2, np.inf)

    def _parts(self, shared: Array, local: Array) -> tuple[Array, Array, Array]:
        decay = np.exp(-shared[1] * self.t)
        e = shared[0] * decay + local[:, :1] + local[:, 1:] * self.t - self.y
        return e, np.stack([decay, -shared[0] * self.t * decay], axis=1), np.stack([np.ones(25), self.t], axis=1)

    def cost(self, shared: Array, local: Array) -> float:
        return 0.5 * float(np.sum(self._parts(shared, local)[0] ** 2))

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        e, j, k = self._parts(shared, local)
        count = len(local)
        return NormalEquations(
            0.5 * float(np.sum(e**2)), j.T @ e.sum(axis=0), count * j.T @ j, e @ k,
            np.tile(k.T @ k, (count, 1, 1)), np.tile(j.T @ k, (count, 1, 1)),
        )  # fmt: skip

    def joint(self) -> Curve:
        """The same with every unknown shared."""
        count = len(self.y)

        def residuals(x: Array) -> Array:
            return self._parts(x[:2], x[2:].reshape(count, 2))[0].ravel()

        def jacobian(x: Array) -> Array:
            _, j, k = self._parts(x[:2], x[2:].reshape(count, 2))
            return np.concatenate([np.tile(j, (count, 1)), np.kron(np.eye(count), k)], axis=1)

        return Curve(residuals, jacobian)


def test_eliminated_blocks_equal_the_joint_problem(rng: np.random.Generator) -> None:
    problem = Separate(rng)
    apart = levenberg_marquardt(problem, np.array([1.0, 1.0]), np.zeros((4, 2)), tolerance=1e-14)
    joint = solved(problem.joint(), [1.0, 1.0] + [0.0] * 8)
    np.testing.assert_allclose(apart.solution.point, joint.solution.point[:2], rtol=1e-6)
    np.testing.assert_allclose(apart.local.ravel(), joint.solution.point[2:], rtol=1e-5, atol=1e-8)
    assert apart.solution.value == pytest.approx(joint.solution.value, rel=1e-12)
    everything = np.linalg.inv(joint.normal.hessian)[:2, :2]
    np.testing.assert_allclose(np.linalg.inv(apart.normal.without_local()[1]), everything, rtol=1e-5)


def test_reduced_gradient_is_that_of_the_profile(rng: np.random.Generator) -> None:
    problem, point = Separate(rng), np.array([1.5, 0.5])

    def profile(shared: Array) -> float:
        held = problem.normal(shared, np.zeros((4, 2)))
        local = -np.linalg.solve(held.local_hessian, held.local_gradient[:, :, None])[:, :, 0]
        return problem.cost(shared, local)

    local = np.zeros((4, 2))
    made = problem.normal(point, local)
    local = local - np.linalg.solve(made.local_hessian, made.local_gradient[:, :, None])[:, :, 0]
    differences = [(profile(point + h) - profile(point - h)) / 2e-6 for h in 1e-6 * np.eye(2)]
    np.testing.assert_allclose(problem.normal(point, local).without_local()[0], differences, rtol=1e-6)


def test_a_block_without_a_measurement_says_nothing() -> None:
    """A segment in which a sensor was silent: its local unknowns stay, shared ones are those of the other segments."""
    shared, silent = np.eye(1), np.zeros((1, 1))
    normal = NormalEquations(
        1.0, np.ones(1), 2.0 * shared, np.array([[1.0], [0.0]]), np.array([shared, silent]), np.array([shared, silent])
    )
    gradient, hessian = normal.without_local()
    np.testing.assert_allclose(gradient, [0.0], atol=1e-9)
    np.testing.assert_allclose(hessian, [[1.0]], rtol=1e-9)


def test_status_says_what_to_do() -> None:
    assert (
        solved(THURBER, [1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03], evaluations=3).solution.status
        is Status.EXHAUSTED
    )
    assert "raise it" in Status.EXHAUSTED
    broken = Curve(lambda x: np.array([np.nan * x[0]]), lambda _: np.ones((1, 1)))
    assert solved(broken, [1.0]).solution.status is Status.FAILED
    assert "start values" in Status.FAILED
    assert [s for s in Status if s.is_success] == [Status.CONVERGED]


def test_a_step_within_bounds_promises_what_the_residuals_show(rng: np.random.Generator) -> None:
    """SciPy's solver of bounded linear least squares as the other code."""
    j, e = rng.standard_normal((30, 5)), rng.standard_normal(30)
    low, high = -np.array([0.01, 1.0, 0.0, 1.0, 0.02]), np.array([1.0, 0.01, 1.0, 0.0, 1.0])
    normal = Curve(lambda _: e, lambda _: j).normal(np.zeros(5), NONE)
    step = bounded_step(normal, low, high)
    np.testing.assert_allclose(step, lsq_linear(j, -e, (low - 1e-300, high + 1e-300), tol=1e-14).x, atol=1e-9)
    assert np.sum((step == low) | (step == high)) >= 2
    gained = 0.5 * (e @ e - np.sum((e + j @ step) ** 2))
    assert predicted_decrease(normal, step, NONE) == pytest.approx(gained, rel=1e-12)


def test_a_wrong_jacobian_stalls() -> None:
    found = solved(Curve(lambda x: np.array([x[0] - 3.0]), lambda _: -np.ones((1, 1))), [1.0])
    assert found.solution.status is Status.STALLED
    kinked = Curve(lambda x: np.array([1.0 + abs(x[0])]), lambda _: 0.01 * np.ones((1, 1)))
    promise = 0.5  # by hand: the model's minimum is at a residual of 0
    for sufficient, status in ((1.01 * promise, Status.CONVERGED), (0.99 * promise, Status.STALLED)):
        at_kink = levenberg_marquardt(kinked, np.array([0.0]), NONE, sufficient=sufficient)
        assert at_kink.solution.status is status
    assert found.solution.point[0] == 1.0


def test_a_step_where_the_model_cannot_be_evaluated_is_shortened() -> None:
    """log(x) is undefined at the first full step from 10."""
    found = solved(Curve(lambda x: np.log(x) - 0.5, lambda x: (1 / x)[:, None]), [10.0])
    np.testing.assert_allclose(found.solution.point, np.exp(0.5), rtol=1e-10)


def test_a_flat_direction_leaves_the_unknown_where_it_is() -> None:
    flat = Curve(lambda x: np.array([x[0] - 3.0, 2 * x[0]]), lambda _: np.array([[1.0, 0.0], [2.0, 0.0]]))
    np.testing.assert_allclose(solved(flat, [1.0, 7.0]).solution.point, [0.6, 7.0])


def test_history_never_rises_and_bits_repeat() -> None:
    start = [1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03]
    one, two = solved(THURBER, start).solution, solved(THURBER, start).solution
    assert np.all(np.diff(one.history) <= 0)
    np.testing.assert_array_equal(one.point, two.point)


def test_what_is_negligible_ends_the_search() -> None:
    exact = Curve(lambda x: np.array([x[0] ** 3 - 8.0]), lambda x: 3 * x[:, None] ** 2)
    costs = levenberg_marquardt(exact, np.array([5.0]), NONE, negligible=1e-4).solution
    assert costs.status is Status.CONVERGED
    assert costs.evaluations < levenberg_marquardt(exact, np.array([5.0]), NONE).solution.evaluations
    assert costs.point[0] == pytest.approx(2.0, abs=1e-4)


def test_a_sufficient_promise_counts_where_evaluations_run_out() -> None:
    """One step before the end of Misra1a, whose promise is measured first."""
    point, evaluations = np.array([250.0, 5e-4]), 6
    before = levenberg_marquardt(MISRA, point, NONE, evaluations=evaluations, tolerance=1e-12)
    assert before.solution.status is Status.EXHAUSTED
    step = np.linalg.solve(before.normal.hessian, -before.normal.gradient)
    promise = float(-0.5 * before.normal.gradient @ step)
    for factor, status in ((1.01, Status.CONVERGED), (0.99, Status.EXHAUSTED)):
        after = levenberg_marquardt(
            MISRA, point, NONE, evaluations=evaluations, tolerance=1e-12, sufficient=factor * promise
        )
        assert after.solution.status is status
        np.testing.assert_array_equal(after.solution.point, before.solution.point)


def test_pinned_unknowns_stay_while_local_ones_move(rng: np.random.Generator) -> None:
    problem, own = Separate(rng), np.array([2.0, 0.7])
    problem.lower = problem.upper = own
    found = levenberg_marquardt(problem, own, np.zeros((4, 2)))
    np.testing.assert_array_equal(found.solution.point, own)
    assert found.solution.status is Status.CONVERGED
    decay, line = own[0] * np.exp(-own[1] * problem.t), np.stack([np.ones(25), problem.t], axis=1)
    expected = np.linalg.lstsq(line, (problem.y - decay).T)[0].T
    np.testing.assert_allclose(found.local, expected, rtol=1e-8)


def test_a_curved_valley_is_followed_without_overreaching_at_every_step() -> None:
    """Rosenbrock's valley with a residual that cannot vanish: bold steps only after steps that needed no damping."""
    valley = Curve(
        lambda p: np.array([100.0 * (p[1] - p[0] ** 2), 1.0 - p[0], 0.3 * (p[0] + 2.0)]),
        lambda p: np.array([[-200.0 * p[0], 100.0], [-1.0, 0.0], [0.3, 0.0]]),
    )
    found = solved(valley, [-1.2, 1.0], evaluations=1000).solution
    assert found.status is Status.CONVERGED
    assert found.point[0] == pytest.approx((1.0 - 0.3 * 0.6) / 1.09, abs=1e-6)
    assert found.evaluations < 200


@pytest.mark.parametrize("damping", [1e-4, 0.1, 1.0])
def test_the_first_step_is_damped_as_required(damping: float) -> None:
    line = Curve(lambda b: b - 1.0, lambda b: np.eye(len(b)))
    found = levenberg_marquardt(line, np.zeros(1), NONE, evaluations=2, damping=damping)
    assert found.solution.point == pytest.approx(1.0 / (1.0 + damping))
