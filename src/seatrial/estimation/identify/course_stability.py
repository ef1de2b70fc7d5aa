"""Whether a craft holds a straight course by itself: a ship at its approach, a craft with thrusters at equal orders."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from seatrial.core.equations import Model
from seatrial.core.results import Stability
from seatrial.core.results.fit import COURSE_UNSTABLE
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, InputError, Severity
from seatrial.estimation.information.stability import growth_rate, stability
from seatrial.physics.simulate.thrust import (
    DEFAULT_AHEAD,
    StraightRun,
    settled_yaw_rate,
    straight_at_speed,
    straight_by_thrusters,
)

_SPEED_STEP = 1e-3  # m/s, to which the speed is found from which on a craft is unstable; chosen


def course_stability(
    model: Model, covariance: Array, degrees_of_freedom: float, approach: Mapping[str, float], length: float,
    ahead: float = DEFAULT_AHEAD, fastest: float = math.inf,
) -> Stability | None:  # fmt: skip
    """Return the stability of the straight course; None without a yaw rate, or a speed ahead that counts.

    Args:
        covariance: of the free coefficients, (n, n).
        approach: steady speed u [m/s] and inputs of the trials, SI, notation signs; length: m.
        ahead: of a craft with thrusters, share of full command at which it runs; its speed follows from that.
        fastest: of a craft with thrusters, speed [m/s] up to which it is judged, too; without it at `ahead` only.
    """

    def judged(run: StraightRun) -> Stability | None:
        return stability(model, covariance, degrees_of_freedom, run.speed, run.inputs, length)

    if model.equations.layout:
        try:
            run = straight_by_thrusters(model, ahead, approach)
            top = straight_at_speed(model, fastest, approach) if math.isfinite(fastest) else run
            slow = top if top.speed < run.speed else run
            return _over_speeds(model, approach, judged(slow), judged(top))
        except InputError:  # it has no steady speed ahead
            return None
    speed = approach.get("u", 0.0)
    if speed <= 0.0 and "u" in model.states:
        return None
    inputs = np.array(
        [
            0.0 if i.name == "delta" else (-1.0 if i.is_reversed else 1.0) * approach.get(i.name, 0.0)
            for i in model.inputs
        ]
    )
    return stability(model, covariance, degrees_of_freedom, speed if speed > 0.0 else None, inputs, length)


def _over_speeds(
    model: Model, approach: Mapping[str, float], slow: Stability | None, fast: Stability | None
) -> Stability | None:
    """The stability at the faster of two speeds where the craft is unstable there, else at the slower."""
    if slow is None or fast is None or slow.speed == fast.speed:
        return slow
    assert slow.speed is not None and slow.growth_rate is not None
    assert fast.speed is not None and fast.growth_rate is not None
    top = f"{significant(fast.speed, 2)} m/s, the fastest of the training runs"
    if fast.growth_rate <= 0.0:
        if slow.is_stable and fast.is_stable:
            return replace(slow, text=f"{slow.text}; and so it is up to {top}")
        known = "it is course stable" if fast.is_stable else "that cannot be determined"
        return replace(slow, text=f"{slow.text}; at {top}, {known}")
    if slow.growth_rate >= 0.0:
        return replace(fast, text=f"{fast.text}; so it is at {significant(slow.speed, 2)} m/s")

    def growth(speed: float) -> float:
        run = straight_at_speed(model, speed, approach)
        return growth_rate(model, run.speed, run.inputs)

    limit = float(brentq(growth, slow.speed, fast.speed, xtol=_SPEED_STEP))
    text = f"{fast.text}; below about {significant(limit, 2)} m/s it is course stable"
    return replace(fast, text=text, stable_below=limit)


def course_finding(model: Model, course: Stability | None, approach: Mapping[str, float]) -> tuple[Finding, ...]:
    """Return a note `course-unstable` where a deviation grows beyond doubt; else nothing."""
    if course is None or not course.is_unstable:
        return ()
    return (Finding(
        Severity.INFO, COURSE_UNSTABLE, course.text,
        _index_text(course)
        + _turn_text(model, approach, course.speed),
        "steer it in a simulation by a helmsman or an autopilot, and judge predictions by windows",
        "without steering it leaves a straight course, and errors of open-loop predictions grow at that rate",
    ),)  # fmt: skip


def _index_text(course: Stability) -> str:
    """The index C; without the speed that makes it a number, the growth rate."""
    if course.speed is not None or course.growth_rate is None:
        return f"C = {significant(course.index, 2)} [{significant(course.lower, 2)}, {significant(course.upper, 2)}]"
    low, high = (significant(end or 0.0, 2) for end in (course.growth_lower, course.growth_upper))
    return f"growth rate {significant(course.growth_rate, 2)} 1/s [{low}, {high}]"


def _turn_text(model: Model, approach: Mapping[str, float], speed: float | None) -> str:
    """The turn in which a craft with thrusters ends at equal orders; empty for others."""
    if not model.equations.layout or speed is None:
        return ""
    try:
        turn = abs(math.degrees(settled_yaw_rate(model, straight_at_speed(model, speed, approach))))
    except InputError:  # the simulation diverges
        return ""
    return f"; at equal orders it ends in a turn of {significant(turn, 2)} deg/s"
