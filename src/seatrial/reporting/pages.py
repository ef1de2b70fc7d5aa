"""The page of each kind of result; only the modules that render that kind are imported."""

from seatrial.core.results import Comparison, Design, Fit, Study
from seatrial.core.results.campaign import Benchmark, CampaignSummary
from seatrial.core.results.tuning import Tuning
from seatrial.core.results.verification import Verification


def report_page(
    result: Fit | Design | Tuning | Study | Comparison | Verification | CampaignSummary | Benchmark,
) -> str:
    """Return the self-contained HTML page of a result; nothing is computed."""
    match result:
        case Fit():
            from seatrial.reporting import page

            return page.html(result)
        case Design():
            from seatrial.reporting import design

            return design.html(result)
        case Tuning():
            from seatrial.reporting import tuning

            return tuning.html(result)
        case Study():
            from seatrial.reporting import study

            return study.html(result)
        case Comparison():
            from seatrial.reporting import comparison

            return comparison.html(result)
        case CampaignSummary():
            from seatrial.reporting import campaign

            return campaign.html(result)
        case Benchmark():
            from seatrial.reporting import benchmark

            return benchmark.html(result)
        case Verification():
            from seatrial.reporting import verification

            return verification.html(result)
