"""Declarations of a page: every figure has a counterpart or a reason, and every counterpart is on the page."""

import pytest

from seatrial_studies.declarations import Assumption, Declarations, Deviation, FigureCounterpart, Symbol


def declared(*figures: FigureCounterpart) -> Declarations:
    return Declarations(
        (Symbol("m", "mass", "kg", "1"),), (Assumption("h", "lost", "2 m"),), (Deviation("eq. 1", "+", "-", "sign"),),
        figures,
    )  # fmt: skip


def test_a_figure_needs_a_counterpart_or_a_reason() -> None:
    with pytest.raises(ValueError, match="Figure 3 has neither"):
        declared(FigureCounterpart("Figure 3", "a block diagram"))


def test_all_four_tables_are_on_the_page_with_the_note_below_the_assumptions() -> None:
    made = declared(FigureCounterpart("Figure 3", "a block diagram", reason="It shows no result."))
    titles = {table.title: table for table in made.tables("Two runs.")}
    assert list(titles) == ["Figures of the paper", "Symbols", "Assumed", "Deviations from the print"]
    assert titles["Assumed"].note == "Two runs."
    assert titles["Figures of the paper"].rows == (("Figure 3", "a block diagram", "It shows no result."),)


def test_a_counterpart_that_is_not_on_the_page_is_named() -> None:
    made = declared(FigureCounterpart("Figure 1", "heave", ("Heave", "Pitch")))
    assert made.missing_counterparts(["Pitch"]) == ("Heave",)
    assert made.missing_counterparts(["Heave", "Pitch"]) == ()
