"""The page of two fits compared."""

from dataclasses import replace

from tests.reporting.fabricated_comparison import fabricated_comparison
from tests.reporting.section_text import cells

from seatrial.core.figures.chart import Line
from seatrial.reporting.comparison import (
    difference_forest,
    difference_table,
    manoeuvre_section,
    outcome,
)
from seatrial.reporting.pages import report_page


def test_the_summary_names_what_differs() -> None:
    comparison = fabricated_comparison()
    assert outcome(comparison) == [
        "Taken together, the 2 coefficients differ (χ² 18.2 with 2 degrees of freedom, p < 0.001).",
        "Significant one by one: K 0.15 → 0.19.",
        "Turning circle with 35° to port: tactical diameter in still water 3.10 → 2.80 L.",
    ]
    (turn, *others) = comparison.manoeuvres
    diameter = next(d for d in turn.measures if d.is_significant)
    vaguer = replace(diameter, name="advance_L", lower=-3.0, upper=-0.1)
    both = replace(comparison, manoeuvres=(replace(turn, measures=(vaguer, *turn.measures)), *others))
    assert outcome(both)[-1].endswith(f"3.10 → 2.80 L and 1 more of {len(turn.measures) + 1} values.")
    alike = replace(comparison, coefficients=(), joint_test=None, manoeuvres=())
    assert outcome(alike) == ["No single quantity differs significantly."]
    assert comparison.significant == ("K", "tactical_diameter_L of turning-circle:35:port")
    assert "K" in str(comparison.summary())


def test_tables_have_the_digits_that_intervals_allow() -> None:
    comparison = fabricated_comparison()
    assert cells(difference_table(comparison.coefficients)) == [
        ("K, 1/s", "0.15", "0.19", "0.040", "0.020", "0.060", "differs"),
        ("T, s", "8.0", "7.6", "−0.4", "−2.4", "1.6", ""),
    ]
    turn, failed = (manoeuvre_section(m) for m in comparison.manoeuvres)
    assert cells(turn.table)[1] == ("steady drift angle, deg", "12.00", "12.50", "0.50", "", "", "")
    assert not failed.table and failed.sentences == ("It diverges.",)
    assert turn.title == "Turning circle with 35° to port"


def test_the_page_has_every_section_and_the_figure_a_line_for_each_coefficient() -> None:
    comparison = fabricated_comparison()
    page = report_page(comparison)
    for text in ("What else changed", "particulars: d 0.71 → 0.55", "Zigzag", "shared-records", "results/ballast"):
        assert (text in page) == (text != "Zigzag")
    chart = difference_forest(comparison.coefficients)
    assert chart is not None
    assert sum(isinstance(mark, Line) for mark in chart.panels[0].marks) == 2
    assert difference_forest(()) is None
    bare = report_page(replace(comparison, coefficients=(), changes=(), findings=(), manoeuvres=()))
    assert 'href="#changes"' not in bare
