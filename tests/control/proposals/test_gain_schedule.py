"""Gains between the conditions of a schedule, and schedules of another craft."""

from dataclasses import replace

import numpy as np
import pytest
from tests.control.proposals.fin_stretches import HEADINGS, SPEEDS, TASK, fin_schedule, points

from seatrial.control.proposals import refuse_other_craft
from seatrial.control.schedule import gain_schedule
from seatrial.core.values import InputError

NAMES = TASK.loop.gains.names


def test_gains_are_those_of_the_conditions_and_linear_between() -> None:
    gains = fin_schedule().gains_at(np.array([[7.0, 0.4, 1.0], [8.0, 1.0, 2.5]]))
    np.testing.assert_allclose(gains, [[14.5, 37.0, 41.6], [13.0, 32.5, 44.0]])


def test_conditions_beyond_the_ends_are_outside() -> None:
    holds = fin_schedule().holds(np.array([[7.0, 0.3, 6.1], [11.5, 2.7, 6.0]]))
    np.testing.assert_array_equal(holds, [[True, False, False], [True, True, True]])


def test_one_speed_holds_for_a_tenth_to_either_side() -> None:
    alone = gain_schedule([p for p in points() if SPEEDS[1] == p.U and p.beta == HEADINGS[1]], NAMES)
    assert alone.limits(0) == pytest.approx((0.9 * SPEEDS[1], 1.1 * SPEEDS[1]))
    np.testing.assert_allclose(alone.gains_at(np.array([[9.0, 1.5, 2.0]]))[0, 1], 34.0)


def test_gains_stand_in_the_order_of_the_loop() -> None:
    turned = [replace(p, gains=dict(reversed(p.gains.items()))) for p in points()]
    condition = np.array([[8.0, 1.0, 2.5]])
    np.testing.assert_array_equal(gain_schedule(turned, NAMES).gains_at(condition), fin_schedule().gains_at(condition))


def test_a_schedule_with_a_hole_is_refused() -> None:
    with pytest.raises(InputError, match="26 points for 3 x 3 x 3 conditions"):
        gain_schedule(points()[1:], NAMES)
    with pytest.raises(InputError, match=r"add \[schedule\] to the loop file"):
        gain_schedule((), NAMES)


def test_a_schedule_of_another_craft_is_refused() -> None:
    refuse_other_craft(TASK, points(), "'gains.toml'")
    other = tuple(replace(p, Ms=1.1 * p.Ms) for p in points())
    with pytest.raises(InputError, match=r"'gains.toml' says Ms .* tuned for another craft"):
        refuse_other_craft(TASK, other, "'gains.toml'")
    renamed = tuple(replace(p, gains={"K_p": 1.0}) for p in points())
    with pytest.raises(InputError, match="has gains K_p, the loop has KP, KI, KD"):
        refuse_other_craft(TASK, renamed, "'gains.toml'")
