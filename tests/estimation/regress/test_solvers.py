"""Each method recovers what it should, scales with its columns, and shrinks, selects or swallows as it says."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.linear_model import Lasso as ReferenceLasso
from tests.estimation.regress.linear import COEFFICIENTS, random_system

from seatrial.core.values import InputError
from seatrial.estimation.regress.estimators import (
    Lasso,
    LeastSquaresSvm,
    LinearSolver,
    OrdinaryLeastSquares,
    RegressionSystem,
    Ridge,
    SupportVectors,
    TruncatedSvd,
    scale_system,
    solve_with_instruments,
)
from seatrial.estimation.regress.operators import Differenced, Euler, Smoothed, Weak

METHODS = [OrdinaryLeastSquares(), Ridge(), TruncatedSvd(), LeastSquaresSvm(), Lasso(), SupportVectors(1000.0, 1e-4)]


@pytest.mark.parametrize("method", METHODS)
def test_without_noise_the_truth_is_found(method: LinearSolver) -> None:
    """Columns of very different size; penalties chosen by cross-validation vanish."""
    np.testing.assert_allclose(method.solve(random_system(1)).coefficients, COEFFICIENTS, rtol=2e-3)


@pytest.mark.parametrize("method", METHODS)
@given(factor=st.sampled_from([1e-3, 100.0]))
def test_units_do_not_matter(method: LinearSolver, factor: float) -> None:
    """A column in other units gives the coefficient in its own; the target's units go out of everything."""
    system = random_system(2, 0.3, rows=100)
    columns = np.array([1.0, factor, 1.0])
    other = RegressionSystem(system.equations, system.names, factor * system.matrix / columns, factor * system.target)
    found, again = method.solve(system).coefficients, method.solve(other).coefficients
    np.testing.assert_allclose(again, found * [1.0, factor, 1.0], rtol=1e-4, atol=1e-9 * np.abs(found).max())


def test_ridge_shrinks_with_its_penalty() -> None:
    """Sizes in the scaled units fall as the penalty grows (Hoerl & Kennard 1970, section 3)."""
    system = random_system(3, 1.0)
    columns = scale_system(system).column_scales
    sizes = [np.linalg.norm(columns * Ridge(p).solve(system).coefficients) for p in (0.0, 1.0, 100.0, 1e4)]
    assert sizes == sorted(sizes, reverse=True)
    np.testing.assert_allclose(Ridge(0.0).solve(system).coefficients, OrdinaryLeastSquares().solve(system).coefficients)


def test_lasso_is_scikit_learns_at_the_same_penalty() -> None:
    """lambda / 2n is its alpha."""
    system = random_system(4, 2.0)
    scaled = scale_system(system)
    reference = ReferenceLasso(100.0 / (2 * len(system.target)), fit_intercept=False, tol=1e-12, max_iter=10**6)
    reference.fit(scaled.matrix, scaled.target)
    found = Lasso((100.0,)).solve(system).coefficients
    np.testing.assert_allclose(found, scaled.unscaled(reference.coef_), rtol=1e-6, atol=1e-9)


def test_lasso_drops_what_does_nothing_and_says_so() -> None:
    """Only b acts."""
    system = random_system(5)
    alone = RegressionSystem(system.equations, system.names, system.matrix, -0.5 * system.matrix[:, 1])
    solved = Lasso((50.0,), refit=True).solve(alone)
    np.testing.assert_allclose(solved.coefficients, [0.0, -0.5, 0.0], atol=1e-9)
    assert "drops a, c from the u equation" in solved.findings[0].text


def test_truncation_leaves_out_a_direction_that_is_hardly_there() -> None:
    """Two columns alike but for a hundredth: their sum is determined, not their difference."""
    generator = np.random.default_rng(6)
    common = generator.standard_normal(500)
    matrix = np.stack([common, common + 1e-3 * generator.standard_normal(500)], axis=1)
    system = RegressionSystem(("v",), ("a", "b"), matrix, 2.0 * common + 0.1 * generator.standard_normal(500))
    found = TruncatedSvd(0.03).solve(system)
    assert found.settings["directions"] == 1.0
    np.testing.assert_allclose(found.coefficients, [1.0, 1.0], atol=0.01)
    assert abs(np.diff(OrdinaryLeastSquares().solve(system).coefficients)[0]) > 0.5


def test_least_squares_svm_allows_itself_a_constant() -> None:
    """And reports it."""
    system = random_system(7)
    moved = RegressionSystem(system.equations, system.names, system.matrix, system.target + 4.0)
    solved = LeastSquaresSvm().solve(moved)
    np.testing.assert_allclose(solved.coefficients, COEFFICIENTS, rtol=1e-3)
    assert solved.bias == pytest.approx(4.0, rel=1e-3)


def test_instruments_free_of_noise_take_the_attenuation_away() -> None:
    """Noise as large as the feature halves least squares; instruments give the slope back (Soderstrom & Stoica)."""
    generator = np.random.default_rng(8)
    clean = generator.standard_normal((20_000, 1))
    noisy = RegressionSystem(("r",), ("N_r",), clean + generator.standard_normal(clean.shape), 3.0 * clean[:, 0])
    assert OrdinaryLeastSquares().solve(noisy).coefficients[0] == pytest.approx(1.5, rel=0.05)
    found = solve_with_instruments(noisy, RegressionSystem(("r",), ("N_r",), clean, clean[:, 0])).coefficients[0]
    assert found == pytest.approx(3.0, rel=0.05)


def test_a_tube_wider_than_the_target_returns_zeros_and_is_said_so() -> None:
    """scikit-learn's default tube of .1 against targets of .03."""
    big = random_system(9)
    system = RegressionSystem(big.equations, big.names, 1e-3 * big.matrix, 1e-3 * big.target)
    solved = SupportVectors(is_standardised=False).solve(system)
    assert not solved.coefficients.any()
    assert "returns zeros only: its tube of 0.1 is wider than its target" in solved.findings[0].text
    assert SupportVectors(100.0, 0.01).solve(system).coefficients.all()


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: Ridge(-1.0), "ridge penalty of -1"),
        (lambda: TruncatedSvd(1.5), "share of 1.5"),
        (lambda: LeastSquaresSvm(0.0), "gamma of the least-squares support vectors is 0"),
        (lambda: Lasso(()), "Lasso penalties"),
        (lambda: SupportVectors(-1.0), "penalty C of the support vectors is -1"),
        (lambda: SupportVectors(1.0, float("nan")), "tube of nan"),
        (lambda: Weak(-1.0), "half width of the weak form's window in s is -1"),
        (lambda: Smoothed(0.0), "smoothing window in s is 0"),
        (lambda: Differenced(Euler(), float("nan")), "rho = nan"),
    ],
)
def test_settings_that_mean_nothing_are_refused(made: Callable[[], object], said: str) -> None:
    """One sentence each, before any record is looked at."""
    with pytest.raises(InputError, match=said):
        made()
