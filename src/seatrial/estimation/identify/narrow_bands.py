"""Held-out runs that leave their 95 % bands far more often than chance would: intervals that promise too much."""

from collections.abc import Sequence

from seatrial.core.results import Prediction
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, Severity

LEAST_INSIDE = 0.7
"""Share of the samples of held-out runs inside a 95 % band below which the band is too narrow; chosen."""


def narrow_band_findings(predictions: Sequence[Prediction]) -> tuple[Finding, ...]:
    """Return a warning with the held-out runs and channels of which too little lies inside the band.

    Over the longest windows of each run, as on the first screen of the report.
    """
    outside = list[str]()
    for p in (one for one in predictions if one.role == "validation" and one.windows):
        longest = max(p.windows, key=lambda w: w.seconds)
        outside += [
            f"{100.0 * score.inside_band:.0f} % of {name} in {p.record}"
            for name, score in longest.scores.items()
            if score.inside_band is not None and score.inside_band < LEAST_INSIDE
        ]
    if not outside:
        return ()
    return (
        Finding(
            Severity.WARNING, "narrow-band",
            "held-out samples lie outside their 95 % band more often than chance explains",
            f"inside are {enumeration(outside)}",
            "take the intervals of predictions and coefficients for too narrow; exchange the runs that are fitted and "
            "held out and compare, look for what differed between them, and fit four runs or more: their spread then "
            "makes the intervals",
        ),
    )  # fmt: skip
