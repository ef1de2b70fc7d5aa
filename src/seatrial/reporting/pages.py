"""The page of each kind of result; only the modules that render that kind are imported."""

from typing import TYPE_CHECKING

from seatrial.core import results

if TYPE_CHECKING:
    from seatrial.data.folder.result_folder import Result


def report_page(result: "Result | results.CampaignSummary | results.Benchmark") -> str:
    """Return the self-contained HTML page of a result; nothing is computed."""
    match result:
        case results.Fit():
            from seatrial.reporting import page

            return page.html(result)
        case results.Design():
            from seatrial.reporting import design

            return design.html(result)
        case results.Tuning():
            from seatrial.reporting import tuning

            return tuning.html(result)
        case results.Study():
            from seatrial.reporting import study

            return study.html(result)
        case results.Comparison():
            from seatrial.reporting import comparison

            return comparison.html(result)
        case results.CampaignSummary():
            from seatrial.reporting import campaign

            return campaign.html(result)
        case results.Benchmark():
            from seatrial.reporting import benchmark

            return benchmark.html(result)
        case results.Verification():
            from seatrial.reporting import verification

            return verification.html(result)
