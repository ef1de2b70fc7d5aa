"""The curvature that quasi-Newton steps take over from two gradients."""

import numpy as np
import pytest
from scipy.optimize import BFGS

from seatrial.core.values import Array
from seatrial.estimation.estimate import newton_refinement
from seatrial.estimation.estimate.newton_refinement import step_within, with_curvature
from seatrial.numerics.optimise import NormalEquations

BELIEVED = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 2.0]])
STEP = np.array([0.3, -0.2, 0.1])


def by_scipy(change: Array) -> Array:
    known = BFGS(exception_strategy="damp_update", min_curvature=0.2)
    known.initialize(3, "hess")
    known.first_iteration = False  # its own scale of the first matrix is not used
    known.B = BELIEVED.copy()
    known.update(STEP, change)
    return np.asarray(known.get_matrix())


@pytest.mark.parametrize("factor", [3.0, 1.0, 0.25, 0.1, -2.0])
def test_it_is_that_of_scipy_damped_where_the_cost_hardly_curves(factor: float) -> None:
    change = factor * BELIEVED @ STEP + np.array([0.02, 0.0, -0.01])
    curvature = with_curvature(BELIEVED, STEP, change)
    np.testing.assert_allclose(curvature, by_scipy(change), rtol=1e-12)
    assert np.linalg.eigvalsh(curvature)[0] > 0.0


def test_of_a_quadratic_cost_it_becomes_the_true_one() -> None:
    """k conjugate steps give the Hessian (Nocedal & Wright 2006, theorem 6.4)."""
    true, curvature = np.diag([1.0, 5.0, 30.0]), BELIEVED
    for step in np.eye(3):  # conjugate for a diagonal one
        curvature = with_curvature(curvature, step, true @ step)
    np.testing.assert_allclose(curvature, true, atol=1e-12)


def quadratic(hessian: Array) -> NormalEquations:
    """A cost whose gradient is `STEP`, without local unknowns."""
    return NormalEquations(1.0, STEP, hessian, np.zeros((0, 0)), np.zeros((0, 0, 0)), np.zeros((0, 3, 0)))


@pytest.mark.parametrize("entry", [np.inf, np.nan])
def test_where_the_information_overflows_no_step_is_taken_and_the_search_has_not_converged(entry: float) -> None:
    room = np.full(3, -np.inf), np.full(3, np.inf)
    curved = BELIEVED.copy()
    curved[1, 1] = entry
    step, left = step_within(room, quadratic(curved))
    np.testing.assert_array_equal(step, 0.0)
    assert left == np.inf
    step, left = step_within(room, quadratic(BELIEVED))
    np.testing.assert_allclose(step, -np.linalg.solve(BELIEVED, STEP))
    assert left == pytest.approx(0.5 * STEP @ np.linalg.solve(BELIEVED, STEP))


def test_a_step_that_is_none_teaches_nothing() -> None:
    np.testing.assert_array_equal(with_curvature(BELIEVED, np.zeros(3), np.zeros(3)), BELIEVED)


def test_no_step_is_taken_where_the_scaled_information_overflows() -> None:
    """Beside a part of the samples two unknowns may have no curvature left, and a coupling of rounding."""
    hollow = np.array([[0.0, 1e10, 0.0], [1e10, 0.0, 0.0], [0.0, 0.0, 1.0]])
    room = np.full(3, -np.inf), np.full(3, np.inf)
    step, left = step_within(room, quadratic(hollow))
    assert not step.any() and left == np.inf


class NarrowValley:
    """Half the square of the distance from `least` by an information whose axes differ a thousandfold in length."""

    class runs:
        size = 2

    least, lower, upper = np.array([2.0, 1.0]), np.full(2, -np.inf), np.full(2, np.inf)
    axes = np.array([[0.8, -0.6], [0.6, 0.8]])
    information = axes @ np.diag([1e4, 1e-2]) @ axes.T

    def cost(self, point: Array, _: Array) -> float:
        return 0.5 * float((point - self.least) @ self.information @ (point - self.least))

    def normal(self, point: Array, local: Array) -> NormalEquations:
        """A gradient that points the wrong way along the valley, as differences across it may."""
        wrong = 0.5 * self.axes[:, 1]
        gradient = self.information @ (point - self.least) - wrong
        no_local = np.zeros((0, 0)), np.zeros((0, 0, 0)), np.zeros((0, 2, 0))
        return NormalEquations(self.cost(point, local), gradient, self.information, *no_local)


def test_where_the_gradient_errs_in_a_narrow_valley_the_cost_leads_to_its_least() -> None:
    valley, start = NarrowValley(), np.array([2.0, 1.0]) + 30.0 * NarrowValley.axes[:, 1]
    normal = valley.normal(start, np.zeros((0, 0)))
    room = np.full(2, -np.inf), np.full(2, np.inf)
    left = step_within(room, normal)[1]
    stalled = newton_refinement._Descent(start, normal, 3, left)
    end = newton_refinement._along_axes(valley, stalled)  # pyright: ignore[reportArgumentType] # of a problem what is used
    assert normal.cost > 4.0 and left > 1.0
    assert end.normal.cost < 1e-6 and end.decrement < 0.02
    np.testing.assert_allclose(end.point, valley.least, atol=0.02)


@pytest.mark.filterwarnings("error")
def test_a_step_beyond_all_numbers_is_infinite_and_no_warning() -> None:
    coordinates = newton_refinement._Coordinates(np.array([True, False]))
    assert coordinates.moved(np.array([1e-6, 2.0]), np.array([800.0, 1.0])).tolist() == [np.inf, 3.0]
