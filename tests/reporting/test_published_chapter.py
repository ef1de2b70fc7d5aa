"""The chapter on a published method: one table with the package's own estimate, effort, and what the search did."""

from dataclasses import replace

import pytest
from tests.reporting.complete_fit import with_bounds
from tests.reporting.published_fit import published
from tests.reporting.section_text import cells, header

from seatrial.core.results import Fit
from seatrial.core.values import RecordKind
from seatrial.reporting.pages import report_page
from seatrial.reporting.published_chapter import published_section
from seatrial.reporting.runs import reading_note

TITLE = "The published method and the package’s own estimate"


@pytest.fixture
def search_fit(fit: Fit) -> Fit:
    return published(fit)


def test_both_estimates_stand_in_one_table_with_effort_below(search_fit: Fit) -> None:
    chapter = published_section(search_fit)
    coefficients, effort = (one.table for one in chapter.parts[:2])
    assert header(coefficients)[1:4] == ("iwho", "scatter", "seatrial")
    assert [row[:2] for row in cells(effort)] == [("iwho", "240"), ("seatrial", "7")]
    assert "after 240 and 7 evaluations" in chapter.sentences[-1]


def test_a_search_over_the_record_shows_convergence_waterfall_and_scatter(search_fit: Fit) -> None:
    pictures = published_section(search_fit).parts[-1].pictures
    assert [picture.caption.split()[0] for picture in pictures] == ["Best", "Weighted", "Values"]


def test_sample_by_sample_the_coefficients_are_drawn_over_the_iterations(fit: Fit) -> None:
    captions = [picture.caption for picture in published_section(published(fit, "sample")).parts[-1].pictures]
    assert sum("Best value after each iteration" in caption for caption in captions) >= 1
    assert "the best may rise" in captions[0]


def test_the_page_has_the_chapter_and_claims_no_significance(fit: Fit, search_fit: Fit) -> None:
    text = report_page(search_fit)
    assert TITLE in text
    assert "The method gives no intervals." in text
    assert TITLE not in report_page(fit)


def test_the_page_of_a_search_says_what_it_did_and_has_no_empty_columns(fit: Fit, search_fit: Fit) -> None:
    text = report_page(search_fit)
    assert "2 restarts of 120 evaluations" in text and "scatter over the restarts by up to" in text
    assert "did not converge" not in text and "slow directions" not in text and "nothing to warn of" not in text
    interval = '<th class="num">95 % from</th>'
    columns = text.partition('id="coefficients"')[2].partition("</thead>")[0]
    assert interval not in columns and interval in report_page(fit).partition('id="coefficients"')[2]


def test_a_simulated_record_is_not_called_measured(fit: Fit) -> None:
    predictions = tuple(replace(p, measured=replace(p.measured, kind=RecordKind.SIMULATED)) for p in fit.predictions)
    text = report_page(replace(fit, predictions=predictions))
    assert "Broad grey line: the reference, itself simulated." in text and "inputs as measured" not in text
    assert "inputs as measured" in report_page(fit)


def test_only_of_a_craft_that_sails_is_a_track_spoken_of(fit: Fit) -> None:
    banded = with_bounds(fit.predictions[0])
    still = replace(
        banded, measured=banded.measured.without("x0", "y0"), simulated=banded.simulated.without("x0", "y0")
    )
    assert "track" not in reading_note([still]) and "Pale: 95 % band of the" in reading_note([still])
    assert "of a track on all sides" in reading_note([banded]) and "Ships" in reading_note([banded])
