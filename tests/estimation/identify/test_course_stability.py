"""Whether a craft holds a straight course: against eigenvalues written by hand, and against its own motion."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from seatrial.core.results import Stability
from seatrial.core.text.numbers import significant
from seatrial.estimation.identify.identifiability import course_finding, course_stability
from seatrial.physics.models import model_named
from seatrial.physics.simulate.thrust import settled_yaw_rate, straight_by_thrusters

LENGTH = 1.8  # m, chosen
LINEAR = {
    "M_v": 2.0, "M_r": 0.4, "X_u": 0.0, "X_uu": -0.4, "Y_v": -0.5, "Y_uv": -0.2, "N_ur": -0.1, "Y_NT": 0.0, "k_J": 0.0,
    "k_4": 0.0,
}  # fmt: skip
NOTHING = np.zeros((21, 21))


def by_hand(u: float, N_uv: float, N_r: float) -> np.ndarray:
    """Sway and yaw of Fossen 2021, eqs. (6.14), (6.40), linearised at v = r = 0 with M_u = 1, per kg of it."""
    p = LINEAR
    return np.array(
        [
            [(p["Y_v"] + p["Y_uv"] * u) / p["M_v"], -u / p["M_v"]],
            [(1.0 - p["M_v"] + N_uv) * u / p["M_r"], (N_r + p["N_ur"] * u) / p["M_r"]],
        ]
    )


@pytest.mark.parametrize(("N_uv", "N_r", "is_unstable"), [(0.0, -0.4, True), (0.9, -0.8, False)])
def test_eigenvalues_are_those_written_by_hand(N_uv: float, N_r: float, is_unstable: bool) -> None:
    craft = model_named("thrusters").with_values({**LINEAR, "N_uv": N_uv, "N_r": N_r})
    covariance = NOTHING[: len(craft.parameters.free), : len(craft.parameters.free)]
    course = course_stability(craft, covariance, math.inf, {}, LENGTH)
    assert course is not None
    assert course.speed is not None
    matrix = by_hand(course.speed, N_uv, N_r)
    assert course.growth_rate == pytest.approx(np.linalg.eigvals(matrix).real.max(), rel=1e-6)
    assert course.index == pytest.approx(np.linalg.det(matrix) * (LENGTH / course.speed) ** 2, rel=1e-6)
    assert course.is_unstable == is_unstable
    findings = course_finding(craft, course, {})
    assert bool(findings) == is_unstable
    verb = "grows" if is_unstable else "dies out"
    assert f"the craft is course {'unstable' if is_unstable else 'stable'} at " in course.text
    assert f"a deviation {verb} by a factor e in " in course.text
    rate = settled_yaw_rate(craft, straight_by_thrusters(craft))
    assert rate > 0.01 if is_unstable else rate == pytest.approx(0.0, abs=1e-9)


def test_a_nudge_grows_as_the_growth_rate_says() -> None:
    """The interval of the growth rate is that of ships drawn with the same spread of one coefficient."""
    craft = model_named("thrusters").with_values({**LINEAR, "N_r": -0.4})
    names = craft.parameters.free_names
    covariance, k = np.zeros((len(names), len(names))), names.index("N_r")
    covariance[k, k] = 0.01**2
    course = course_stability(craft, covariance, math.inf, {}, LENGTH)
    assert course is not None
    assert course.growth_upper is not None
    assert course.growth_rate is not None
    assert course.speed is not None
    ends = [np.linalg.eigvals(by_hand(course.speed, 0.0, -0.4 + d)).real.max() for d in (-0.0196, 0.0196)]
    assert course.growth_upper - course.growth_rate == pytest.approx(0.5 * (ends[1] - ends[0]), rel=0.01)
    assert "s [" in course.text


def test_a_craft_that_cannot_go_ahead_has_no_straight_course() -> None:
    craft = model_named("thrusters").with_values({"k_f": 0.0})
    assert course_stability(craft, NOTHING, math.inf, {}, LENGTH) is None


def test_a_craft_that_loses_its_course_at_speed_is_judged_up_to_the_fastest_of_its_runs() -> None:
    """Sway and yaw are damped by constants, destabilised in proportion to u: unstable above where det(A) vanishes."""
    craft = model_named("thrusters").with_values({**LINEAR, "N_uv": 0.0, "N_r": -1.6, "k_f": 4.0, "k_b": 4.0})
    covariance = NOTHING[: len(craft.parameters.free), : len(craft.parameters.free)]
    limit = brentq(lambda u: np.linalg.det(by_hand(u, 0.0, -1.6)), 0.1, 5.0)

    def course(fastest: float) -> Stability:
        found = course_stability(craft, covariance, math.inf, {}, LENGTH, ahead=0.05, fastest=fastest)
        assert found is not None and found.speed is not None
        return found

    below, beyond = course(0.9 * limit), course(1.2 * limit)
    assert (
        below.is_stable and f"up to {significant(0.9 * limit, 2)} m/s, the fastest of the training runs" in below.text
    )
    assert beyond.is_unstable and beyond.speed == pytest.approx(1.2 * limit, rel=1e-5)
    assert beyond.stable_below == pytest.approx(limit, abs=2e-3)
    assert f"below about {significant(limit, 2)} m/s it is course stable" in beyond.text
    assert "ends in a turn of" in course_finding(craft, beyond, {})[0].evidence


@pytest.mark.parametrize(("T", "is_unstable"), [(-60.0, True), (60.0, False)])
def test_a_model_of_steering_alone_is_judged_without_a_speed(T: float, is_unstable: bool) -> None:
    ship = model_named("nomoto").with_values({"K": math.copysign(0.03, T), "T": T})
    course = course_stability(ship, np.diag([1e-4, 1.0]) ** 2, math.inf, {}, 300.0)
    assert course is not None and course.speed is None
    assert course.growth_rate == pytest.approx(-1.0 / T)
    assert course.is_unstable == is_unstable
    assert [f.evidence[:11] for f in course_finding(ship, course, {})] == ["growth rate"] * is_unstable
