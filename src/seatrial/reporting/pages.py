"""The page of each kind of result."""

from collections.abc import Callable, Mapping
from typing import Any

from seatrial.core.results import Design, Fit, Study
from seatrial.core.results.tuning import Tuning
from seatrial.reporting import design, page, study, tuning

PAGES: Mapping[type, Callable[[Any], str]] = {
    Fit: page.html,
    Design: design.html,
    Tuning: tuning.html,
    Study: study.html,
}


def report_page(result: Fit | Design | Tuning | Study) -> str:
    """Return the self-contained HTML page of a result; nothing is computed."""
    return PAGES[type(result)](result)
