"""Sentences of every result can be read: as they stand on a page, values in their places."""

import re
from collections.abc import Iterable
from dataclasses import replace
from statistics import median

import pytest
from tests.conventions.test_prose import FORMULA, MOST_WORDS, SENTENCE_END
from tests.reporting.complete_fit import baselines, complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_comparison import fabricated_comparison
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin
from tests.reporting.test_campaign import fabricated_campaign
from tests.reporting.test_roll_chapter import KNOWN
from tests.reporting.test_ticks import CLEAN, Result, facts
from tests.reporting.test_verification import LEGS, TURNS

from seatrial.core.results import Comparison, Design, Fit, Study
from seatrial.core.results.campaign import CampaignSummary
from seatrial.core.results.tuning import Tuning
from seatrial.core.results.verification import Verification
from seatrial.reporting import campaign, comparison, design, page, study, tuning, tuning_text, verification
from seatrial.reporting.key_facts import operators_sentence
from seatrial.reporting.section import Section
from seatrial.reporting.verdict import verdict as fit_verdict

MEDIAN_WORDS, VERDICT_WORDS = 18, 25  # chosen
TAG = re.compile(r"<[^>]*>")
RESULTS: dict[str, Result] = {
    "fit": complete_fit(fabricated_fit()),
    "roll": replace(complete_fit(fabricated_fit()), roll=KNOWN),
    "plain fit": replace(fabricated_fit(), baselines=baselines(fabricated_fit())),
    "fin": fabricated_fin(),
    "fin by linear theory": replace(fabricated_fin(), seaway_simulations=()),
    "autopilot": fabricated_autopilot(),
    "autopilot by demands": replace(fabricated_autopilot(), chosen=replace(fabricated_autopilot().chosen, rms={})),
    "unstable": fabricated_bare(),
    "design": fabricated_design(),
    "legs": LEGS,
    "turns": TURNS,
    "campaign": fabricated_campaign(),
    "comparison": fabricated_comparison(),
    "study": CLEAN["study"](),
}


def sections(result: Result) -> Iterable[Section]:
    match result:
        case Fit():
            return page.sections(result)
        case Tuning():
            return tuning.sections(result)
        case Design():
            return design.sections(result)
        case Verification():
            return verification.sections(result)
        case CampaignSummary():
            return campaign.sections(result)
        case Comparison():
            return comparison.sections(result)
        case Study():
            return study.sections(result)


def verdict(result: Result) -> str:
    """Empty of a study, whose answer its author writes."""
    match result:
        case Fit():
            return fit_verdict(result)
        case Tuning():
            return tuning_text.verdict(result)
        case Design():
            return design.verdict(result)
        case Verification():
            return verification.verdict(result)
        case CampaignSummary():
            return campaign.first_screen(result).verdict
        case Comparison():
            return comparison.first_screen(result).verdict
        case Study():
            return ""


def texts(parts: Iterable[Section]) -> Iterable[str]:
    for part in parts:
        yield from map(str, (*part.sentences, *part.points, part.note, *(p.caption for p in part.pictures)))
        yield from texts(part.parts)


def sentences(result: Result) -> list[str]:
    of_fit = [operators_sentence(result)] if isinstance(result, Fit) else []
    every = [*of_fit, *(fact.text for fact in facts(result)), *texts(sections(result))]
    parts = [part for text in every for part in SENTENCE_END.split(TAG.sub("", text)) if part]
    return [part for part in parts if not FORMULA.search(part)]


@pytest.mark.parametrize("kind", RESULTS)
def test_sentences_of_a_result_are_short(kind: str) -> None:
    every = sentences(RESULTS[kind])
    assert [s for s in every if len(s.split()) > MOST_WORDS] == []
    assert median(len(s.split()) for s in every) <= MEDIAN_WORDS


@pytest.mark.parametrize("kind", RESULTS)
def test_a_verdict_has_two_clauses_at_most(kind: str) -> None:
    text = verdict(RESULTS[kind])
    assert len(text.split()) <= VERDICT_WORDS and text.count(";") <= 1, text
