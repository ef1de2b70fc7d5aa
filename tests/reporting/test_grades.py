"""One scale for how well a run is predicted: its error as a share of the motion itself."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import Divergence, Fit
from seatrial.reporting.grades import ErrorShare, Grade, is_missed, largest_error_share, share_sentence, worst_share


def test_the_largest_share_over_quantities_and_runs_counts(fit: Fit) -> None:
    p = fit.validation[0]
    spread = math.degrees(float(np.nanstd(p.measured["psi"])))
    half, more = (replace(p, rms={"psi_deg": share * spread}) for share in (0.49, 0.51))
    largest = largest_error_share(half)
    assert largest is not None and largest.share == pytest.approx(0.49) and largest.grade is Grade.ROUGHLY
    worst = worst_share([half, more])
    assert worst is not None and worst.share == pytest.approx(0.51)
    assert largest_error_share(replace(p, rms={})) is None and worst_share([]) is None


def test_grade_and_scale_stand_with_the_share(fit: Fit) -> None:
    p = fit.validation[0]
    spread = math.degrees(float(np.nanstd(p.measured["psi"])))
    text = share_sentence([replace(p, rms={"psi_deg": 0.51 * spread})])
    assert text.startswith("in heading 0.51 of the standard deviation of the motion itself: roughly (closely to 0.1, ")
    assert share_sentence([]) == ""


@pytest.mark.parametrize(("share", "grade", "is_marked"), [
    (0.1, Grade.CLOSELY, False), (0.3, Grade.WELL, False), (0.7, Grade.ROUGHLY, True), (1.0, Grade.POORLY, True),
    (1.001, Grade.NOT, True), (math.inf, Grade.NOT, True),
])  # fmt: skip
def test_each_limit_belongs_to_the_better_grade(share: float, grade: Grade, *, is_marked: bool) -> None:
    one = ErrorShare("psi_deg", share)
    assert one.grade is grade and one.needs_attention is is_marked


def test_a_run_whose_mean_is_nearer_and_one_that_diverges_are_missed(fit: Fit) -> None:
    p = fit.validation[0]
    spread = math.degrees(float(np.nanstd(p.measured["psi"])))

    def predicted(share: float) -> Fit:
        return replace(fit, predictions=(replace(p, rms={"psi_deg": share * spread}),))

    assert is_missed(predicted(1.1)) and not is_missed(predicted(0.9))
    assert is_missed(replace(fit, predictions=(replace(p, divergence=Divergence(70.0, 65.0, "r")),)))
    assert not is_missed(replace(fit, predictions=()))
