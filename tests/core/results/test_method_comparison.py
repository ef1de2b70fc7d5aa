"""A published method beside the package's own estimate, as tables of text."""

from dataclasses import replace

import pytest
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.published_fit import published

from seatrial.core.results import Fit
from seatrial.core.results.comparison import (
    coefficient_comparison,
    cost_comparison,
    count_inside_own_intervals,
    inside_own_intervals,
    pooled_rms,
)


@pytest.fixture(scope="module")
def fit() -> Fit:
    return published(fabricated_fit())


def test_each_coefficient_stands_with_the_own_interval_and_the_difference(fit: Fit) -> None:
    assert fit.reference is not None
    table = coefficient_comparison(fit, fit.reference)
    c = next(c for c in fit.reference.coefficients if not c.fixed)
    assert c.standard_error is not None
    row = dict(zip(table.header, table.rows[0], strict=True))
    assert row["coefficient"] == c.name
    expected = 0.02 * c.estimate / c.standard_error
    assert float(row["difference/s.e."].replace("\u2212", "-")) == pytest.approx(expected, rel=0.05)


def test_what_was_done_and_what_lies_inside_is_said_in_words(fit: Fit) -> None:
    assert fit.reference is not None and fit.search is not None
    assert fit.search.effort == "2 restarts of 120 evaluations"
    uneven = replace(fit.search, restarts=(replace(fit.search.restarts[0], evaluations=118), fit.search.restarts[1]))
    assert uneven.effort == "2 restarts of 118 to 120 evaluations"
    free = sum(not c.fixed for c in fit.coefficients)
    count = count_inside_own_intervals(fit, fit.reference)
    assert inside_own_intervals(fit, fit.reference) == (
        f"{count} of the {free} coefficients of iwho lie inside the 95 % intervals of seatrial"
    )


def test_without_intervals_there_are_no_columns_for_them(fit: Fit) -> None:
    assert fit.reference is not None
    bare = tuple(replace(c, standard_error=None, lower=None, upper=None) for c in fit.reference.coefficients)
    table = coefficient_comparison(fit, replace(fit.reference, coefficients=bare))
    assert not {"std. error", "95 % from", "to", "difference/s.e."} & set(table.header)
    assert all(len(row) == len(table.header) for row in table.rows)


def test_effort_stands_with_the_errors_of_runs_held_out(fit: Fit) -> None:
    assert fit.reference is not None
    table = cost_comparison(fit, fit.reference)
    assert table.header[:4] == ("estimate", "evaluations", "CPU s", "weighted rms")
    assert all(name.startswith("held-out ") for name in table.header[4:])
    assert [row[:4] for row in table.rows] == [("iwho", "240", "1.0", "0.2"), ("seatrial", "7", "0.25", "0.1")]


def test_without_a_search_there_is_no_weighted_rms(fit: Fit) -> None:
    assert fit.reference is not None
    method = replace(fit.method, settings={"processor time, s": 1.5}, name="svr")
    plain = replace(fit, search=None, method=method)
    table = cost_comparison(plain, fit.reference)
    assert "weighted rms" not in table.header
    assert table.rows[0][0] == "svr"
    assert table.rows[0][2] == "1.5"


def test_values_inside_the_own_intervals_are_counted(fit: Fit) -> None:
    assert fit.reference is not None
    free = [c for c in fit.reference.coefficients if not c.fixed]
    near = [c for c in free if c.lower is not None and c.upper is not None and c.lower <= 1.02 * c.estimate <= c.upper]
    assert count_inside_own_intervals(fit, fit.reference) == len(near)


def test_errors_of_runs_are_pooled_by_their_squares() -> None:
    errors = {"a": {"r": 3.0, "u": 1.0}, "b": {"r": 4.0}, "c": {"r": 100.0}}
    assert pooled_rms(errors, ["a", "b", "missing"]) == {"r": pytest.approx(12.5**0.5), "u": 1.0}
