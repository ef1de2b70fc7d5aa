"""Numbers and words of a snapshot as people read them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.results.online import CoefficientChange, EstimatorPhase, Snapshot
from seatrial.onboard.table import change_sentence, estimate_rows, phase_meaning, residual_rms, time_text


def one(value: float, error: float, unit: str = "1") -> Snapshot:
    return Snapshot(
        0.0, 1, 1, EstimatorPhase.WINDOW, ("c",), (unit,), np.array([value]), np.array([error]), {"theta": 0.01}
    )


@given(value=st.floats(-1e12, 1e12), error=st.floats(1e-9, 1e12))
def test_text_of_value_and_interval_is_right_within_its_own_digits(value: float, error: float) -> None:
    row = estimate_rows(one(value, error))[0]
    scale = 10.0**row.power
    texts = {
        k: float(getattr(row, k).replace("−", "-").replace("\u202f", "")) * scale
        for k in ("value", "half_width", "lower", "upper")
    }
    last = scale * 10.0 ** -len(row.half_width.partition(".")[2]) if "." in row.half_width else scale
    allowed = max(last, 0.051 * 1.96 * error, 1e-6 * abs(value))
    assert abs(texts["value"] - value) <= allowed
    assert abs(texts["half_width"] - 1.96 * error) <= allowed
    assert abs(texts["lower"] - (value - 1.96 * error)) <= allowed
    assert abs(texts["upper"] - (value + 1.96 * error)) <= allowed
    assert max(len(text) for text in (row.value, row.half_width, row.lower, row.upper)) <= 12


@pytest.mark.parametrize("error", [np.inf, np.nan, 0.0])
def test_without_a_standard_error_there_is_no_interval(error: float) -> None:
    row = estimate_rows(one(2.5, error))[0]
    assert (row.value, row.half_width, row.lower) == ("2.500", "–", "–")


def test_angles_are_degrees_and_squares_are_squares() -> None:
    assert residual_rms(one(1.0, 0.1)) == [("theta", "0.573", "deg")]
    assert estimate_rows(one(2e6, 1e5, "kg m^2"))[0].unit == "10⁶ kg m²"


def test_times() -> None:
    assert time_text(61.04) == "61.0 s" and time_text(1.7e9) == "2023-11-14 22:13:20 UTC" and time_text(np.nan) == "–"


def test_a_change_is_stated_only_when_it_is_one() -> None:
    change = CoefficientChange(
        since=300.0, statistic=31.2, degrees_of_freedom=8, p=1.3e-4, is_significant=True, most_changed="b33"
    )
    assert (
        "since 300.0 s" in change_sentence(change)
        and "b33" in change_sentence(change)
        and "p 0.00013" in change_sentence(change)
    )
    assert (
        change_sentence(CoefficientChange(300.0, 7.0, 8, 0.5, is_significant=False, most_changed="b33")) == ""
        and change_sentence(None) == ""
    )


def test_a_model_without_free_coefficients_does_not_wait_for_samples() -> None:
    waiting = Snapshot(0.0, 9, 1, EstimatorPhase.WAITING, ("c",), ("1",), np.ones(1), np.array([np.inf]))
    assert "too few samples" in phase_meaning(waiting)
    fixed = Snapshot(0.0, 9, 1, EstimatorPhase.WAITING, (), (), np.ones(0), np.ones(0))
    assert phase_meaning(fixed) == "every coefficient is fixed: nothing to estimate"
