"""Course changes of simulated logs: found, predicted with weather, and the coefficient that was wrong named."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.control.verification.autopilot_logs import DEMAND, GAINS, K, T, autopilot_task, course_log, ship

from seatrial.control.verification.course_changes import followed_gains, logged_changes, verify_changes
from seatrial.control.verification.verify import refitted_coefficients, verify
from seatrial.core.values import InputError, Record
from seatrial.physics.loops import Sampling
from seatrial.physics.loops.structures import notch, with_filters

LOOP, VALUES = autopilot_task().loop, np.array(list(GAINS.values()))


def test_each_change_is_found_from_its_order_on() -> None:
    changes = logged_changes([course_log(1)], LOOP, DEMAND)
    assert [one.change for one in changes] == pytest.approx(np.array([1, 1, -1, -1]) * DEMAND.change)
    assert [one.start for one in changes] == pytest.approx([119.5, 239.5, 359.5, 479.5])
    assert all(one.is_step and one.demand[0] == 0.0 for one in changes)
    assert changes[0].background(80.0).shape == (round(40.0 / 0.5) + 1, 2)


def test_an_order_that_was_filtered_is_followed_as_it_is() -> None:
    record = course_log(1)
    slow = np.concatenate([np.zeros(240), np.linspace(0.0, 0.35, 40), np.full(len(record) - 280, 0.35)])
    ramp = record.with_channel("psi_ref", record.channel("psi_ref").with_values(slow))
    (change,) = logged_changes([ramp], LOOP, DEMAND)
    assert not change.is_step
    assert change.change == pytest.approx(0.35)


def test_without_weather_the_log_is_what_the_model_does() -> None:
    """The same law simulated by the loop's own controller: overshoot and settling to the noise of the sensors."""
    log = verify_changes(autopilot_task(), VALUES, [course_log(2, weather=0.0)])
    for change in log.changes:
        assert change.overshoot == pytest.approx(change.predicted_overshoot, abs=0.01)
        assert change.settling == pytest.approx(change.predicted_settling, abs=1.5)
        assert np.max(np.abs(change.measured - change.predicted)) < 0.01
        assert np.max(np.abs(change.moved - change.predicted_moved)) < 0.01


def test_a_ship_as_modelled_lies_inside_as_often_as_intervals_say() -> None:
    """Ships drawn from the fit; 12 quantities, each outside once in twenty: three or fewer with 99.8 %."""
    rng, outside = np.random.default_rng(7), 0
    for seed in range(3):
        gain, lag = rng.normal((K, T), (0.01, 0.5))
        log = verify_changes(autopilot_task(), VALUES, [course_log(100 + seed, gain, lag)])
        outside += sum(not q.is_inside for q in log.quantities)
    assert outside <= 3


def test_a_rudder_that_does_less_is_named() -> None:
    result = verify(autopilot_task(), GAINS, [course_log(1, gain=0.13)])
    assert "K" in result.moved
    assert "actuator rms" in result.outside
    corrected = result.corrections[0]
    assert corrected.lower < 0.15 < 0.2
    assert not math.isnan(corrected.log)


@pytest.mark.parametrize(("logs", "least"), [(2, 1), pytest.param(8, 6, marks=pytest.mark.long)])
def test_the_model_is_estimated_by_the_log_almost_alone(logs: int, least: int) -> None:
    """The prior leaves 50 %: logs come within 15 %, by intervals of a quarter at most.

    Of eight intervals of 95 % fewer than six hold the gain once in 170 such tests (binomial).
    """
    inside = []
    for seed in range(3, 3 + logs):
        (gain, lag) = refitted_coefficients(ship(), [course_log(seed)], 40.0)
        assert (gain.name, lag.name) == ("K", "T")
        assert gain.log == pytest.approx(K, rel=0.15) and lag.log == pytest.approx(T, rel=0.2)
        assert gain.upper - gain.lower < 0.25 * K
        inside.append(gain.lower < K < gain.upper)
    assert sum(inside) >= least


@pytest.mark.long(every=4)
@pytest.mark.parametrize("seed", range(40, 44))
def test_of_an_unchanged_ship_nothing_is_named(seed: int) -> None:
    assert verify(autopilot_task(), GAINS, [course_log(seed)]).findings == ()


def test_other_gains_are_named() -> None:
    others = {"KP": 2.0 * GAINS["KP"], "KD": 0.5 * GAINS["KD"]}
    assert "gains-differ" in [f.code for f in verify(autopilot_task(), others, [course_log(52)]).findings]


@pytest.mark.long
def test_what_changed_is_named() -> None:
    """The gain halved, the time constant doubled."""
    assert "K" in verify(autopilot_task(), GAINS, [course_log(50, gain=0.5 * K)]).moved
    assert "T" in verify(autopilot_task(), GAINS, [course_log(51, lag=2.0 * T)]).moved


def test_a_controller_that_samples_is_predicted_as_it_samples() -> None:
    """A dead time of a second and a half behind samples of half a second."""
    sampling = Sampling(0.5, dead_time=1.5)
    log = course_log(2, weather=0.0, sampling=sampling)
    for one in verify_changes(autopilot_task(sampling), VALUES, [log]).changes:
        assert np.max(np.abs(one.moved - one.predicted_moved)) < 0.002


def test_the_loop_of_the_log_is_recognised() -> None:
    task = autopilot_task()
    notched = with_filters(task.loop, notch(0.5, 0.5, 0.1))
    log = course_log(60)
    alone, other = (followed_gains(task, one.with_gains(VALUES), logged_changes([log], LOOP, DEMAND))
                    for one in (task.loop, notched))  # fmt: skip
    assert alone.coherence > 0.95 > other.coherence
    with_both = replace(task, loop=notched, extended_structures=(task.loop,))
    assert verify_changes(with_both, VALUES, [log]).gains.followed == alone


@pytest.mark.parametrize(
    ("record", "words"),
    [
        (course_log(1).without("psi_ref"), "no channel 'psi_ref'"),
        (course_log(1).between(0.0, 100.0), "holds no change of 'psi_ref'"),
        (course_log(1).between(0.0, 150.0), "holds no change of 'psi_ref'"),
        (course_log(1).between(0.0, 170.0), "end before they settle"),
    ],
)
def test_logs_without_a_change_are_refused(record: Record, words: str) -> None:
    with pytest.raises(InputError, match=words):
        verify_changes(autopilot_task(), VALUES, [record])
