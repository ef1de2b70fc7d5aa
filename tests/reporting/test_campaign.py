"""The page of a campaign: sections for what there is, texts escaped, status in words."""

import pytest
from tests.reporting.section_text import cells

from seatrial.core.results.campaign import (
    CampaignStatus,
    CampaignSummary,
    FailureReason,
    KeyMap,
    RepeatedCoefficient,
    RepeatedScore,
)
from seatrial.core.values import Finding, Severity
from seatrial.reporting.campaign import coefficient_section, coverage_chart, error_histograms, outcome, status_sentence
from seatrial.reporting.pages import report_page


def coefficient(name: str = "Y_v", covered: int = 95) -> RepeatedCoefficient:
    counts = (0,) * 8 + (2, 5, 12, 18, 26, 18, 12, 5, 2) + (0,) * 8
    quantiles = (-0.4, -0.3, -0.28, -0.25, -0.2)
    return RepeatedCoefficient(name, "1", 100, -0.28, 0.01, quantiles, -0.2767, 0.0105, 1.03, 100, covered,
                               (0.887, 0.984), counts)  # fmt: skip


def fabricated_campaign() -> CampaignSummary:
    """A campaign with everything its page can show."""
    return CampaignSummary(
        "Do <zigzags> suffice?", "montecarlo", CampaignStatus(102, 100, 1, 2.0),
        (coefficient(), coefficient("N_r", 90)), (RepeatedScore("rms psi_deg", "deg", 3, 1.0, 1.2, 2.0),),
        (FailureReason("speed … m/s", 1, "speed <3> m/s", "abcd"),),
        (KeyMap("median rms psi_deg, deg", "estimate.rate", "fold", ("1.0", "2.0"), ("a", "b"),
                ((1.0, 2.0), (None, 4.0))),),
        (Finding(Severity.WARNING, "incomplete", "1 of 102 tasks are not done yet"),), ("a processor",), ("a library",),
        {"seatrial": "0.1.0"},
    )  # fmt: skip


@pytest.fixture
def summary() -> CampaignSummary:
    return fabricated_campaign()


def test_the_page_has_a_section_for_all_there_is(summary: CampaignSummary) -> None:
    page = report_page(summary)
    assert "Do &lt;zigzags&gt; suffice?" in page
    assert "speed &lt;3&gt; m/s" in page
    for title in (
        "coverage of the intervals",
        "92.5 % of 200 cases",
        "Distributions of the errors",
        "Over the keys",
        "Failures",
        "incomplete",
    ):
        assert title in page


def test_sentences(summary: CampaignSummary) -> None:
    assert outcome(summary) == [
        "100 of 102 tasks done, 1 failed, 1 left: about 2.00 s of one worker.",
        "Root-mean-square errors are 1.03 to 1.03 times the Cramér-Rao bound.",
        "The 95 % intervals hold the truth in 92.5 % of 200 cases.",
    ]
    assert status_sentence(CampaignStatus(1, 0, 0, None)) == "0 of 1 task done, 1 left."


def test_charts_without_content_are_none_and_the_table_gives_per_cent() -> None:
    assert coverage_chart([]) is None
    assert error_histograms([]) is None
    assert cells(coefficient_section([coefficient()]).table)[0][-2:] == ("95.0", "88.7 to 98.4")
