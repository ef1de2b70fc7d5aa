"""One scale for how well a run is predicted: its error as a share of the motion itself."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.reporting.test_course import unstable, with_course

from seatrial.cli.next_steps import after_fit
from seatrial.core.results import ChannelScore, Divergence, Fit, Prediction, WindowScore
from seatrial.core.results.prediction import motion_spreads
from seatrial.core.values import Record
from seatrial.reporting.verdict import (
    ErrorShare,
    Grade,
    error_scale,
    error_shares,
    graded_errors,
    is_disturbed,
    is_missed,
    judged_share,
    judging_window,
    largest_error_share,
    longest_judged,
    run_error,
    verdict,
    window_shares,
    worst_share,
)


def test_the_largest_share_over_quantities_and_runs_counts(fit: Fit) -> None:
    p = fit.validation[0]
    spread = math.degrees(float(np.nanstd(p.measured["psi"])))
    half, more = (replace(p, rms={"psi_deg": share * spread}) for share in (0.49, 0.51))
    largest = largest_error_share(half)
    assert largest is not None and largest.share == pytest.approx(0.49) and largest.grade is Grade.ROUGHLY
    worst = worst_share(replace(fit, predictions=(half, more)))
    assert worst is not None and worst.share == pytest.approx(0.51)
    assert largest_error_share(replace(p, rms={})) is None and worst_share(replace(fit, predictions=())) is None


def test_error_motion_and_grade_stand_together(fit: Fit) -> None:
    p = fit.validation[0]
    spread = math.degrees(float(np.nanstd(p.measured["psi"])))
    half = replace(fit, predictions=(replace(p, rms={"psi_deg": 0.51 * spread}),))
    assert graded_errors(half) == f"{0.51 * spread:.0f}° of {spread:.0f}° in heading: roughly"
    assert graded_errors(replace(fit, predictions=())) == ""
    assert " in heading and " in graded_errors(fit) and " in position" in graded_errors(fit)


@pytest.mark.parametrize(("share", "grade", "is_marked"), [
    (0.1, Grade.CLOSELY, False), (0.3, Grade.WELL, False), (0.7, Grade.ROUGHLY, True), (1.0, Grade.POORLY, True),
    (1.001, Grade.NOT, True), (math.inf, Grade.NOT, True),
])  # fmt: skip
def test_each_limit_belongs_to_the_better_grade(share: float, grade: Grade, *, is_marked: bool) -> None:
    error = ErrorShare("psi_deg", share, 1.0)
    assert error.grade is grade and error.needs_attention is is_marked


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
    assert graded_errors(replace(fit, predictions=(p,))) == "80° of 100° in heading: poorly"


def test_a_motion_that_is_noise_of_its_sensor_decides_no_grade(fit: Fit) -> None:
    assert fit.noise_model is not None
    time = np.arange(0.0, 60.0, 0.1)
    place = 0.3 * np.sin(time)
    run = Record.from_arrays("spin", time, {"psi": 1.5 * time, "x0": place, "y0": place})  # spreads by 0.3 m
    p = replace(fit.validation[0], measured=run, rms={"psi_deg": 1.0, "position_m": 0.4})
    ship = replace(fit.ship, particulars={})

    def graded(noise: float) -> Fit:
        seen = replace(fit.noise_model, measurement={"x0": noise, "y0": noise})
        return replace(fit, ship=ship, predictions=(p,), noise_model=seen)

    near, far = (worst_share(graded(noise)) for noise in (0.16, 0.05))
    assert near is not None and near.name == "psi_deg" and near.grade is Grade.CLOSELY
    assert far is not None and far.name == "position_m" and far.grade is Grade.NOT
    alone = replace(graded(0.16), predictions=(replace(p, rms={"position_m": 0.4}),))
    assert worst_share(alone) is not None  # nothing else to judge by


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
    course = with_course(fit, unstable(2.0))  # grows a hundredfold in 9.2 s
    by_windows = replace(course, predictions=(missed,))
    longest = longest_judged(by_windows)
    assert longest == pytest.approx(9.21, abs=0.01) and judging_window(missed, longest) is missed.windows[0]
    share = judged_share(missed, error_scale(by_windows))
    assert share is not None and share.window == "5 s" and share.grade is Grade.CLOSELY
    assert longest_judged(replace(course, predictions=(kept,))) is None
    whole = replace(fit, predictions=(missed,))
    assert longest_judged(whole) is None
    assert judging_window(missed, 92.0) is missed.windows[1]
    assert judging_window(missed, 0.5) is missed.windows[0]  # all are too long: the shortest
    assert longest_judged(replace(course, predictions=(replace(missed, windows=()),))) is None
    worst = worst_share(whole)
    assert worst is not None and worst.grade is Grade.NOT and not worst.window


def test_windows_judge_a_craft_that_the_estimated_disturbance_carries_off(fit: Fit) -> None:
    assert fit.noise_model is not None
    missed = replace(ramp_in_windows(fit, 40.0, (5.0, 0.1), (30.0, 8.0)), noise_floor={})
    gusty = replace(fit, predictions=(missed,), noise_model=replace(fit.noise_model, disturbance="white"))
    assert longest_judged(gusty) == math.inf  # its floor would exceed the error, and is not stored
    for floor, longest in ((29.0, math.inf), (27.0, None)):
        assert longest_judged(replace(gusty, predictions=(replace(missed, noise_floor={"psi_deg": floor}),))) == longest
    calm = replace(gusty, noise_model=replace(fit.noise_model, disturbance="none"))
    assert longest_judged(calm) is None
    shown = replace(fit.noise_model, disturbance="waves on the sensors", process={})
    assert longest_judged(replace(gusty, noise_model=shown)) is None  # they carry no craft off


def test_a_miss_that_the_disturbance_leaves_is_said_to_be_so(fit: Fit, tmp_path: Path) -> None:
    assert fit.noise_model is not None
    missed = replace(ramp_in_windows(fit, 40.0, (30.0, 80.0)), noise_floor={"psi_deg": 39.0})
    gusty = replace(fit, predictions=(missed,), noise_model=replace(fit.noise_model, disturbance="white"))
    calm = replace(gusty, noise_model=replace(fit.noise_model, disturbance="none"))
    assert verdict(gusty).endswith("; the estimated disturbance alone leaves most of that.")
    assert after_fit(gusty, tmp_path).endswith("judge the model over short windows")
    assert "disturbance" not in verdict(calm)
    assert after_fit(calm, tmp_path).endswith("correct the fit before it is used")


def test_a_disturbance_excuses_no_error_of_which_it_has_no_floor(fit: Fit) -> None:
    assert fit.noise_model is not None
    gusty = replace(fit, noise_model=replace(fit.noise_model, disturbance="white"))
    (run, *_) = fit.validation
    bare = replace(run, noise_floor={})
    assert is_disturbed(gusty, bare, ErrorShare("psi_deg", 5.0, 4.0))
    assert not is_disturbed(gusty, bare, ErrorShare("phi_deg", 5.0, 4.0))


def test_a_run_is_as_bad_as_the_largest_share_of_its_motions_and_worst_where_it_diverges(fit: Fit) -> None:
    p = fit.validation[0]
    spread = motion_spreads({"psi_deg": 0.0}, p.measured)["psi_deg"]
    assert run_error(replace(p, rms={"psi_deg": 0.2 * spread})) == pytest.approx(0.2)
    assert run_error(replace(p, divergence=Divergence(70.0, 65.0, "r"))) == math.inf
    assert run_error(replace(p, rms={})) == 0.0


def test_an_error_that_is_noise_of_the_sensor_is_called_so(fit: Fit) -> None:
    assert fit.noise_model is not None
    noisy = replace(fit, noise_model=replace(fit.noise_model, measurement={"psi": math.radians(1.0)}))
    (p,) = fit.validation
    for error, text in ((1.4, " in heading (sensor noise 1.0°): "), (1.5, " in heading: ")):
        assert text in graded_errors(replace(noisy, predictions=(replace(p, rms={"psi_deg": error}),)))
