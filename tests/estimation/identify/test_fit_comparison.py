"""What two fits differ in: coefficients, ship, model, criterion and records."""

from dataclasses import replace

from tests.reporting.fabricated import fabricated_fit

from seatrial.core.results import Fit
from seatrial.core.values import Ship
from seatrial.estimation.identify.fit_result import changes, coefficient_differences, compared_fit, findings


def other_day(fit: Fit) -> Fit:
    """The fit with a coefficient moved by five standard errors, another draught, and records of its own."""
    moved = tuple(
        replace(c, estimate=c.estimate + 5.0 * c.standard_error, lower=c.lower + 5.0 * c.standard_error,
                upper=c.upper + 5.0 * c.standard_error)
        if c.name == "N_r" and c.standard_error and c.lower is not None and c.upper is not None else c
        for c in fit.coefficients
    )  # fmt: skip
    ship = Ship(fit.ship.name, dict(fit.ship.particulars) | {"d": 0.6}, fit.ship.source)
    records = tuple(r.rows(slice(5, None)).renamed(f"{r.name}_b") for r in fit.records)
    method = replace(fit.method, criterion="prediction error")
    return replace(fit, coefficients=moved, ship=ship, records=records, method=method, predictions=())


def test_the_coefficient_that_moved_is_significant() -> None:
    first = fabricated_fit()
    rows, test = coefficient_differences(first, other_day(first))
    assert [r.name for r in rows if r.is_significant] == ["N_r"]
    assert len(rows) == sum(not c.fixed for c in first.coefficients)
    assert test is not None
    assert test.p < 0.05
    same, test = coefficient_differences(first, first)
    assert all(r.difference == 0.0 for r in same)
    assert test is not None
    assert (test.statistic, test.p) == (0.0, 1.0)


def test_what_else_changed_is_named() -> None:
    first = fabricated_fit()
    texts = changes(first, other_day(first))
    assert "criterion: output error over whole runs → prediction error" in texts
    assert "particulars: d 0.71 → 0.6" in texts
    assert any(
        text.startswith("training runs: zigzag_10_10, zigzag_20_20, zigzag_30_30 → zigzag_10_10_b") for text in texts
    )
    assert changes(first, first) == ()
    assert compared_fit(first, "a").records == ("zigzag_10_10", "zigzag_20_20", "zigzag_30_30")


def test_shared_records_are_a_warning() -> None:
    first = fabricated_fit()
    assert [f.code for f in findings(first, first)] == ["shared-records"]
    assert findings(first, other_day(first)) == ()
