"""What the first screen says of a craft that does not hold a straight course."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import ChannelScore, Fit, Stability, WindowScore
from seatrial.reporting.key_facts import key_facts
from seatrial.reporting.measures import course_facts, growth_clause, growth_time, unstable_course
from seatrial.reporting.verdict import is_missed, verdict


def unstable(seconds: float) -> Stability:
    """A craft whose deviations grow by a factor e in so many seconds, the rate known to 10 %."""
    rate = 1.0 / seconds
    return Stability(-0.5, -0.6, -0.4, "the craft is course unstable at 1.4 m/s", 1.4, rate, 0.9 * rate, 1.1 * rate)


def with_course(fit: Fit, course: Stability) -> Fit:
    assert fit.identifiability is not None
    return replace(fit, identifiability=replace(fit.identifiability, stability=course))


def leaving(fit: Fit, share_in_windows: float, runs: int = 1) -> Fit:
    """The fit with held-out runs missed by twice the motion whole, and by that share of it in windows of 5 s."""
    (p,) = fit.validation
    rate = 1.0  # deg/s of a heading that climbs, so that windows of 5 s spread by 5/sqrt(12) degrees
    time = p.measured.time - p.measured.time[0]
    climb = p.measured.with_channel("psi", p.measured.channel("psi").with_values(np.radians(rate * time)))
    spread = math.degrees(float(np.nanstd(climb["psi"])))
    error = share_in_windows * 5.0 / math.sqrt(12.0)
    window = WindowScore("5 s", 5.0, 40, {"psi_deg": ChannelScore(error, 0.0, 0.0)})
    held = replace(p, measured=climb, rms={"psi_deg": 2.0 * spread}, windows=(window,))
    training = tuple(replace(one, rms={"psi_deg": 1000.0}) for one in fit.predictions if one.role == "training")
    more = tuple(replace(held, record=f"run_{k}") for k in range(1, runs))
    return replace(fit, predictions=(*training, held, *more))


def test_only_a_craft_unstable_beyond_its_interval_has_the_row(fit: Fit) -> None:
    assert course_facts(fit) == () and unstable_course(fit) is None  # its interval contains 0
    stable = replace(unstable(1.5), index=0.5, lower=0.4, upper=0.6, growth_rate=-0.7, growth_lower=-0.8)
    assert course_facts(with_course(fit, stable)) == ()
    # the index is a product of two rates: open, though the one that decides is known
    by_rate = replace(unstable(1.3), index=-3.9, lower=-10.0, upper=2.3)
    assert course_facts(with_course(fit, by_rate)) and not course_facts(
        with_course(fit, replace(by_rate, growth_lower=-0.1))
    )
    assert course_facts(replace(fit, identifiability=None)) == ()
    (fact,) = course_facts(with_course(fit, unstable(1.5)))
    assert fact.text == "course unstable: a deviation grows by a factor e in 1.5 s [1.4, 1.7] at 1.4 m/s"
    assert fact in key_facts(with_course(fit, unstable(1.5)))
    (limited,) = course_facts(with_course(fit, replace(unstable(1.5), stable_below=1.1)))
    assert limited.text.endswith("at 1.4 m/s, course stable below about 1.1 m/s")


@pytest.mark.parametrize(("low", "text"), [(0.5, "in 1.0 s [0.67, 2.0]"), (-0.1, "in 1.0 s"), (None, "in 1.0 s")])
def test_an_interval_of_the_time_needs_a_rate_of_one_sign(low: float | None, text: str) -> None:
    course = replace(unstable(1.0), growth_lower=low, growth_upper=1.5)
    assert growth_clause(course).endswith(text)


def test_without_a_rate_no_time_is_given() -> None:
    course = replace(unstable(1.0), growth_rate=None)
    assert growth_clause(course) == "course unstable" and math.isinf(growth_time(course))


def test_windows_decide_the_verdict_of_an_unstable_craft_that_leaves_its_run(fit: Fit) -> None:
    good, bad = (with_course(leaving(fit, share), unstable(2.0)) for share in (0.2, 1.2))
    assert verdict(good).endswith(" well: 0.29° in heading over 5 s.")
    assert not is_missed(good) and is_missed(bad)
    assert verdict(bad).startswith("Does not predict ") and verdict(bad).endswith(": 1.7° in heading over 5 s.")
    assert verdict(leaving(fit, 0.2)).startswith("Does not predict ")


def test_of_several_runs_windows_decide_too(fit: Fit) -> None:
    text = verdict(with_course(leaving(fit, 0.2, runs=2), unstable(2.0)))
    assert text == "Predicts 2 held-out runs well or better, zigzag_25_25 worst: 0.29° in heading over 5 s."
    assert verdict(with_course(leaving(fit, 1.2, runs=2), unstable(2.0))).startswith("Does not predict 2 of 2 held-out")


def test_a_fitted_run_that_an_unstable_craft_leaves_is_no_model_error(fit: Fit) -> None:
    def row(one: Fit) -> str:
        return next(fact.text for fact in key_facts(one) if fact.name == "Error, fitted")

    assert "; model error: " in row(leaving(fit, 0.2))
    assert row(with_course(leaving(fit, 0.2), unstable(2.0))).endswith("; a course-unstable craft leaves any whole run")
