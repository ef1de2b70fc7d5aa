"""What a wrong assumed value does, against linear regression, where one step is exact."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.estimation.information.covariance import consequence_text, estimate_shifts


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
