"""Whether a craft holds a straight course by itself: a ship at its approach, a craft with thrusters at equal orders."""

import math
from collections.abc import Mapping

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Stability
from seatrial.core.results.identifiability import COURSE_UNSTABLE
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, InputError, Severity
from seatrial.estimation.information.stability import stability
from seatrial.physics.simulate.thrust import DEFAULT_AHEAD, settled_yaw_rate, straight_by_thrusters


def course_stability(
    model: Model, covariance: Array, degrees_of_freedom: float, approach: Mapping[str, float], length: float,
    ahead: float = DEFAULT_AHEAD,
) -> Stability | None:  # fmt: skip
    """Return the stability of the straight course; None where there is no yaw rate or no steady speed ahead.

    Args:
        covariance: of the free coefficients, (n, n).
        approach: steady speed u [m/s] and inputs of the trials, SI, notation signs; length: m.
        ahead: of a craft with thrusters, share of full command at which it runs; its speed follows from that.
    """
    if model.equations.layout:
        try:
            run = straight_by_thrusters(model, ahead, approach)
        except InputError:  # it has no steady speed ahead
            return None
        return stability(model, covariance, degrees_of_freedom, run.speed, run.inputs, length)
    speed = approach.get("u", 0.0)
    if speed <= 0.0:
        return None
    inputs = np.array(
        [
            0.0 if i.name == "delta" else (-1.0 if i.is_reversed else 1.0) * approach.get(i.name, 0.0)
            for i in model.inputs
        ]
    )
    return stability(model, covariance, degrees_of_freedom, speed, inputs, length)


def course_finding(
    model: Model, course: Stability | None, approach: Mapping[str, float], ahead: float = DEFAULT_AHEAD
) -> tuple[Finding, ...]:
    """Return a note `course-unstable` where a deviation grows beyond doubt; else nothing."""
    if course is None or not course.is_unstable:
        return ()
    return (Finding(
        Severity.INFO, COURSE_UNSTABLE, course.text,
        f"C = {significant(course.index, 2)} [{significant(course.lower, 2)}, {significant(course.upper, 2)}]"
        + _turn_text(model, approach, ahead),
        "steer it in a simulation by a helmsman or an autopilot, and judge predictions by windows",
        "without steering it leaves a straight course, and errors of open-loop predictions grow at that rate",
    ),)  # fmt: skip


def _turn_text(model: Model, approach: Mapping[str, float], ahead: float) -> str:
    """The turn in which a craft with thrusters ends at equal orders; empty for others."""
    if not model.equations.layout:
        return ""
    try:
        turn = abs(math.degrees(settled_yaw_rate(model, straight_by_thrusters(model, ahead, approach))))
    except InputError:  # the simulation diverges
        return ""
    return f"; at equal orders it ends in a turn of {significant(turn, 2)} deg/s"
