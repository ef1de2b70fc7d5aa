"""Orders: what the helmsman is ordered, what the actuators make of it, what is handed over."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.estimation.design.conftest import BOTH, NOZZLE, with_inputs

from seatrial.core.values import RecordKind
from seatrial.estimation.design.manoeuvre_information import (
    actuator_response,
    input_series,
    order_counts,
    order_table,
    orders_at,
    planned_record,
    sample_count,
    simulate_plan,
)
from seatrial.estimation.design.task import DesignTask
from seatrial.physics.simulate.replay import inputs_of

SHARES = st.lists(st.floats(-0.5, 1.5), min_size=12, max_size=12)


@given(shares=SHARES, dt=st.sampled_from([0.2, 1.0, 3.0]))
def test_an_actuator_keeps_its_range_and_rate_and_arrives_where_time_allows(shares: list[float], dt: float) -> None:
    orders = NOZZLE.lower + (NOZZLE.upper - NOZZLE.lower) * np.clip(shares, 0.0, 1.0)
    made = actuator_response(NOZZLE, orders, 0.0, dt, round(180.0 / dt) + 1)
    assert made[0] == 0.0
    assert np.all((made >= NOZZLE.lower) & (made <= NOZZLE.upper))
    assert np.abs(np.diff(made)).max() <= NOZZLE.rate * dt * (1.0 + 1e-9)
    last = round(NOZZLE.hold / dt) * np.arange(1, 13)
    near = np.abs(np.diff(np.concatenate([[0.0], orders]))) <= NOZZLE.rate * (NOZZLE.hold - dt)
    settled = np.cumprod(near).astype(bool)
    assert made[last][settled] == pytest.approx(orders[settled], abs=1e-12)


def test_an_actuator_without_a_rate_jumps() -> None:
    made = actuator_response(replace(NOZZLE, rate=math.inf), np.array([0.5, -0.5, 0.1, 0.0]), 0.0, 5.0, 13)
    assert made.tolist() == [0.5] * 3 + [-0.5] * 3 + [0.1] * 3 + [0.0] * 4


def test_a_point_beyond_an_end_means_that_end(craft: DesignTask) -> None:
    (orders,) = orders_at(craft, np.linspace(-1.0, 2.0, sum(order_counts(craft))))
    assert (orders[0], orders[-1]) == (NOZZLE.lower, pytest.approx(NOZZLE.upper))


def test_the_table_steers_what_was_scored(craft: DesignTask) -> None:
    """From its lines alone, at their times, the same inputs to the bit; equal orders make one line."""
    both = with_inputs(craft, BOTH, {})
    orders = [np.repeat([0.3, -0.3, 0.3, 0.0], 3), np.array([1.4, 2.4, 2.4, 2.4, 1.4, 1.4])]
    lines = order_table(both, orders)
    assert [line.time for line in lines] == [0.0, 30.0, 45.0, 90.0, 120.0, 135.0]
    for j, actuator in enumerate(both.request.actuators):
        order = [[line for line in lines if line.time <= k * actuator.hold][-1] for k in range(order_counts(both)[j])]
        assert [line.values[actuator.name] for line in order] == orders[j].tolist()


def test_the_plan_carries_the_record_s_signs_and_gives_back_the_model_s(craft: DesignTask) -> None:
    made = input_series(craft, [np.full(12, 0.3)], 0.2)
    planned = planned_record(craft, made, 0.2)
    assert planned.kind is RecordKind.PLANNED
    assert set(planned.channels) == set(craft.model.input_names)
    assert planned.channel("delta").values[-1] == pytest.approx(0.3)
    assert made[-1, craft.model.input_names.index("delta")] == pytest.approx(-0.3)
    assert np.array_equal(inputs_of(craft.model, planned), made)
    assert len(planned) == sample_count(craft, 0.2)


def test_a_nozzle_to_starboard_in_the_plan_turns_the_craft_to_starboard(craft: DesignTask) -> None:
    made = input_series(craft, [np.full(12, 0.2)], 0.2)
    sailed = simulate_plan(craft, planned_record(craft, made, 0.2), "designed")
    turned = sailed.channel("psi").values[-1]
    assert sailed.name == "designed"
    assert turned * _turn_of_a_positive_record_angle(craft) > 0.1


def _turn_of_a_positive_record_angle(task: DesignTask) -> float:
    """Steered by the house's helmsman: a circle to starboard has this sign of the recorded angle."""
    from seatrial.physics.manoeuvres.programme import programme
    from seatrial.physics.simulate.steer import manoeuvre

    circle = manoeuvre(
        task.model, programme("turning-circle:10"), dt=0.2, duration=60.0, inputs=dict(task.request.held)
    )
    return float(np.sign(circle.channel("psi").values[-1] * circle.channel("delta").values[-1]))


@pytest.mark.parametrize("hold", [1.0 / 3.0, 2.0 / 7.0, 0.7, 1.2])
def test_no_order_is_left_out_of_the_table_whatever_the_hold(craft: DesignTask, hold: float) -> None:
    task = replace(craft, request=craft.request.with_hold(hold))
    wanted = np.linspace(-0.5, 0.5, order_counts(task)[0])
    assert [line.values["delta"] for line in order_table(task, [wanted])] == wanted.tolist()
