"""The chapter on other estimators: who comes nearest, who fails, what trajectories prove."""

import re
from dataclasses import replace

import pytest
from tests.reporting.complete_fit import baselines as fabricated
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.section_text import header, part

from seatrial.core.results import Fit
from seatrial.core.results.prediction import NO_COMPARISON
from seatrial.core.values import Finding, Severity
from seatrial.reporting.baselines import baseline_section, baseline_sentences
from seatrial.reporting.page import html


@pytest.fixture(scope="module")
def fit() -> Fit:
    """A fit of a craft that is known, beside four others."""
    plain = fabricated_fit()
    return replace(plain, baselines=fabricated(plain))


def unknown(fit: Fit) -> Fit:
    """The same where nobody knows the truth."""
    return replace(fit, baselines=tuple(replace(r, error={}) for r in fit.baselines))


def test_sentences_name_the_nearest_the_failed_and_what_proves_nothing(fit: Fit) -> None:
    first, second = baseline_sentences(fit)
    assert "4 regressions on the same training runs" in first
    assert "One of them fails: “pipeline”." in first
    assert "One gives coefficients with which a simulated run diverges: “Euler”." in first
    assert "Nearest to the known values comes “weak form”: 5.0 % off in the median" in first
    assert "held-out runs" in second and "“ridge” are 60 % off in the median" in second and "0.980 or better" in second


def test_where_the_truth_is_not_known_the_fit_is_the_measure(fit: Fit) -> None:
    first, second = baseline_sentences(unknown(fit))
    assert "Nearest to the fit comes “weak form”" in first and "from the fit in the median" in second
    (first_part, *_) = baseline_section(unknown(fit)).parts
    assert "known" not in header(first_part.table) and "difference from the fit" in first_part.pictures[0].draw()


def test_the_fit_without_offsets_is_the_measure_of_headings(fit: Fit) -> None:
    worse = replace(fit.baselines[0], name="this fit, its offsets set to zero",
                    validation=replace(fit.baselines[0].validation, rms={"psi_deg": 99.0}))  # fmt: skip
    both = replace(fit, baselines=(fit.baselines[0], worse, *fit.baselines[1:]))
    assert "fit’s, its offsets set to zero: 2 of the 2 that simulate the held-out runs" in baseline_sentences(both)[1]
    names = header(part(baseline_section(both), "Coefficients").table)
    assert fit.baselines[0].name in names and "weak form" in names and worse.name not in names


def test_gaps_are_marked_in_words(fit: Fit) -> None:
    table = part(baseline_section(fit), "Coefficients").table
    assert table is not None
    for name, distance in (("weak form", "near"), ("ridge", "off"), ("Euler", "far")):
        column = header(table).index(name)
        assert {row.cells[column].under.partition(":")[0] for row in table.rows} == {distance}


def test_the_page_shows_everything_once(fit: Fit) -> None:
    page = html(fit)
    assert len(re.findall('id="baselines"', page)) == 1
    text = page[page.index('id="baselines"') :]
    for words in ("Held-out runs", "Training runs", "CC of v", "pipeline failed: run a is too short",
                  "ridge: Lasso drops N_r", "the simulation of zigzag_25_25 diverges"):  # fmt: skip
        assert words in text
    assert "NaN" not in text and ">nan<" not in text


def test_a_refusal_is_one_sentence_and_silence_stays_silent(fit: Fit) -> None:
    plain = replace(fit, baselines=())
    assert not baseline_section(plain) and 'id="baselines"' not in html(plain)
    why = Finding(Severity.INFO, NO_COMPARISON, "no other estimators to compare: model 'nomoto' is not linear in K")
    page = html(replace(plain, findings=(why,)))
    section = page[page.index('id="baselines"') :].partition("</section>")[0]
    assert "No other estimators to compare" in section and "<table" not in section
