"""One scale for how well a run is predicted: its error as a share of the motion itself."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.test_course import unstable

from seatrial.core.results import ChannelScore, Divergence, Fit, Prediction, WindowScore
from seatrial.core.values import Record
from seatrial.reporting.grades import (
    ErrorShare,
    Grade,
    error_shares,
    is_missed,
    judged_share,
    judging_course,
    judging_window,
    largest_error_share,
    share_sentence,
    window_shares,
    worst_share,
)


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
    assert text.startswith(
        "share of the standard deviation of the motion itself: 0.51 in heading, roughly (closely to "
    )
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


def test_turning_on_the_spot_hides_no_error_of_heading(fit: Fit) -> None:
    time = np.arange(0.0, 60.0, 0.1)
    spins = Record.from_arrays("spins", time, {"psi": 1.5 * time})  # 14 turns, std. dev. 1489 degrees
    p = replace(fit.validation[0], measured=spins, rms={"psi_deg": 80.0})
    (share,) = error_shares(p)
    anywhere = 360.0 / math.sqrt(12.0)  # std. dev. of a uniform distribution over a turn
    assert share.share == pytest.approx(80.0 / anywhere) and share.grade is Grade.POORLY
    assert "(104° for a heading that turns on and on): 0.77 in heading, poorly" in share_sentence([p])


def test_both_heading_and_position_are_named_where_a_run_has_them(fit: Fit) -> None:
    p = fit.validation[0]
    text = share_sentence([p])
    shares = {one.name: one.share for one in error_shares(p)}
    assert set(shares) == {"psi_deg", "position_m"}
    assert text.startswith("shares of the standard deviation of the motion itself: ") and " in heading and " in text


def ramp_in_windows(fit: Fit, whole: float, *inside: tuple[float, float]) -> Prediction:
    """A heading that climbs 1 deg/s for 60 s; its error over the whole run, and over windows: seconds, error [deg]."""
    time = np.arange(0.0, 60.0, 0.1)
    climb = Record.from_arrays("climb", time, {"psi": np.radians(time)})
    windows = tuple(
        WindowScore(f"{seconds:g} s", seconds, round(60.0 / seconds), {"psi_deg": ChannelScore(error, 0.0, 0.0)})
        for seconds, error in inside
    )
    return replace(fit.validation[0], measured=climb, rms={"psi_deg": whole}, windows=windows)


def test_a_share_over_windows_is_that_of_the_motion_inside_them(fit: Fit) -> None:
    p = ramp_in_windows(fit, 30.0, (10.0, 1.0))
    (share,) = window_shares(p, p.windows[0])
    assert share.share == pytest.approx(1.0 / (10.0 / math.sqrt(12.0)), rel=1e-3) and share.window == "10 s"


def test_windows_judge_an_unstable_craft_that_leaves_its_run_and_no_other(fit: Fit) -> None:
    missed, kept = (ramp_in_windows(fit, error, (5.0, 0.1), (30.0, 8.0)) for error in (40.0, 1.0))
    course = unstable(2.0)  # grows a hundredfold in 9.2 s
    assert judging_course([missed], course) is course and judging_window(missed, course) is missed.windows[0]
    share = judged_share(missed, course)
    assert share is not None and share.window == "5 s" and share.grade is Grade.CLOSELY
    assert judging_course([kept], course) is None and judging_course([missed], None) is None
    slow = judging_window(missed, unstable(20.0))
    assert slow is missed.windows[1]
    assert judging_window(missed, unstable(0.1)) is missed.windows[0]  # all are too long: the shortest
    assert judging_course([replace(missed, windows=())], course) is None
    worst = worst_share([missed], None)
    assert worst is not None and worst.grade is Grade.NOT and not worst.window
