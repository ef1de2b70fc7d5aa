"""Shares of windows within their bands, counted by hand."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.estimation.information.discrepancy import HoldoutError
from seatrial_studies.alexandersson2022.reproduction import MissedWindows, band_coverage

T = 1.96
ROWS = 100


def miss(run: str, inside: int, size: float = 3.0) -> HoldoutError:
    """The first samples well inside a foreseen deviation of one, the others `size` of it away."""
    error = np.where(np.arange(ROWS) < inside, 0.1, size)
    return HoldoutError(run, 0.1, {"psi": error}, {"psi": np.ones(ROWS)})


def held(*misses: HoldoutError) -> float:
    """Share of one run's windows, against training runs too few to show a discrepancy."""
    return band_coverage(MissedWindows(((miss("a", ROWS),),), (misses,), np.inf))[1][0].shares["psi"]


def test_shares_are_those_of_samples() -> None:
    assert held(miss("b", 80)) == pytest.approx(0.8)
    assert held(miss("b", 80), miss("b", 40)) == pytest.approx(0.6)


def test_bands_end_at_students_quantile() -> None:
    assert held(miss("b", 0, T - 0.01)) == 1.0
    assert held(miss("b", 0, T + 0.01)) == 0.0


def test_samples_that_were_not_measured_count_neither_way() -> None:
    gap = miss("b", 80)
    gap.errors["psi"][:60] = np.nan
    assert held(gap) == pytest.approx(0.5)
    nothing = replace(gap, errors={"psi": np.full(ROWS, np.nan)})
    assert held(gap, nothing) == pytest.approx(0.5)


def test_a_run_is_judged_by_what_other_runs_missed() -> None:
    """One of many runs is far off: the bands of the others know of it, its own do not."""
    runs = tuple((miss(f"{i}", 0, 0.1),) for i in range(9))
    within, _ = band_coverage(MissedWindows((*runs, (miss("far", 0, 8.0),)), (), np.inf))
    assert [c.shares["psi"] for c in within] == [1.0] * 9 + [0.0]
