"""A schedule beside one set of gains for all, over the conditions of the published fins."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.control.fin_tasks import KNOT, PUBLISHED, VARIANCES, fin_task
from tests.control.loop_files import PATROL_BOAT, write_loop_file

from seatrial.control.loopfile.load import tuning_task
from seatrial.control.schedule import gain_schedule, midpoints, schedule, schedule_conditions
from seatrial.control.task import Effectiveness, ScheduleGrid
from seatrial.core.results.tuning import OperatingPoint
from seatrial.physics.loops import margins

SPEEDS = tuple(kn * KNOT for kn in (14.0, 18.0, 22.0))
HEADINGS = tuple(math.radians(d) for d in (45.0, 90.0, 135.0))
PLAN = ScheduleGrid(SPEEDS, HEADINGS, (2.0, 3.3, 4.5))


@pytest.fixture(scope="module")
def whole():
    task = replace(fin_task(), effectiveness=Effectiveness.SPEED_SQUARED)
    return schedule(task, PLAN, {"published": PUBLISHED}, 0, lambda _: None)


@pytest.fixture(scope="module")
def points(whole):
    return whole.points


def mean_cost(points, name):
    return np.mean([p.cost if name == "schedule" else p.baseline_costs[name] for p in points])


def test_every_condition_keeps_the_restrictions_and_the_mean_cost_falls(points):
    """By two fifths with gains of their own; smooth ones, with K_I within its published bound, by a fifth."""
    assert len(points) == 27
    assert all(point.is_feasible for point in points)
    published = mean_cost(points, "published")
    assert mean_cost(points, "each its own") <= 0.6 * published
    assert mean_cost(points, "schedule") <= 0.8 * published


def test_neighbouring_gains_differ_by_the_largest_step_at_most(points):
    table = np.array([list(p.gains.values()) for p in points]).reshape(3, 3, 3, 3)
    for axis in range(3):
        one, two = np.delete(table, -1, axis), np.delete(table, 0, axis)
        assert np.all(np.minimum(one, two) >= (1.0 - PLAN.largest_step - 1e-9) * np.maximum(one, two))


def test_a_larger_step_costs_less(whole):
    steps, costs = [t.largest_step for t in whole.trades], [t.cost for t in whole.trades]
    assert steps == sorted(steps) and costs == sorted(costs, reverse=True)
    assert steps[0] == 0.0 and math.isinf(steps[-1])


def test_the_restrictions_are_checked_between_conditions_too(whole):
    assert whole.check.conditions == 5**3
    assert whole.check.feasible >= 0.95 * 5**3


@pytest.mark.parametrize("beta", HEADINGS)
def test_no_heading_is_worse_than_with_the_published_gains(points, beta):
    here = [point for point in points if point.beta == beta]
    assert mean_cost(here, "schedule") <= mean_cost(here, "published")


def test_gains_of_a_condition_s_own_are_never_worse_than_one_set_for_all(points):
    for point in points:
        assert point.baseline_costs["each its own"] <= point.baseline_costs["one for all"] * (1.0 + 1e-9)


def test_gains_are_interpolated_straight_along_every_axis():
    conditions = [(U, beta, height) for height in (2.0, 4.0) for U in (7.0, 9.0) for beta in (0.5, 1.0, 2.0)]
    known = [OperatingPoint(*at, {"KP": at[0], "KI": at[1], "KD": at[2]}, 0.5, 1.2, 0.0, {}, True) for at in conditions]
    fine = np.stack(np.meshgrid(midpoints([7.0, 9.0]), midpoints([0.5, 1.0, 2.0]), [2.5], indexing="ij"), axis=-1)
    between = gain_schedule(known, ("KP", "KI", "KD")).gains_at(fine.reshape(-1, 3))
    np.testing.assert_allclose(between, fine.reshape(-1, 3))


def test_without_gains_nothing_is_left_out():
    task = fin_task()
    known = schedule_conditions(task, ScheduleGrid(SPEEDS[:1], HEADINGS[:1], (2.0,)))
    assert known[0].cost(np.zeros((1, 3)))[0] == pytest.approx(1.0)


def test_higher_seas_of_the_same_steepness():
    task = replace(fin_task(), objectives=VARIANCES)
    low, high = schedule_conditions(task, ScheduleGrid(SPEEDS[:1], HEADINGS[1:2], (2.0, 4.0)))
    spectra = [condition.evaluator.task.disturbances[0].spectrum for condition in (low, high)]  # type: ignore[union-attr]
    assert spectra[1].significant_height == pytest.approx(2.0 * spectra[0].significant_height)
    assert spectra[1].modal_frequency == pytest.approx(spectra[0].modal_frequency / math.sqrt(2.0))


SCHEDULED = """
[hull]
L = 40.0
B = 7.5
T = 2.0
[[seas]]
spectrum = "jonswap"
height = 0.7
period = 6.0
heading = { value = 135, unit = "deg" }
[schedule]
speeds = { values = [3, 9], unit = "m/s" }
headings = { values = [90, 135], unit = "deg" }
heights = [0.7]
"""


def test_an_autopilot_is_scheduled_for_the_ship_at_each_speed(tmp_path):
    """By similarity K goes with U and T with 1 / U; from abeam no sea yaws the ship, but its trim is still there."""
    task = tuning_task(write_loop_file(tmp_path, PATROL_BOAT + SCHEDULED))
    slow = task.at_speed(3.0).loop.plant
    assert np.array(slow.num) / slow.den[0] == pytest.approx([0.04 / 9.0])
    assert np.array(slow.den) / slow.den[0] == pytest.approx([1.0, 1.0 / 12.0, 0.0])
    conditions = schedule_conditions(task, task.schedule_grid)
    assert [len(c.evaluator.task.disturbances) for c in conditions] == [1, 2, 1, 2]
    made = schedule(task, task.schedule_grid, {}, 0, lambda _: None).points
    for point in made:
        own = task.at_speed(point.U).loop
        there = replace(task.loop, plant=own.plant, disturbance=own.disturbance)
        assert point.Ms == pytest.approx(margins(there.with_gains(np.array([*point.gains.values()]))).Ms, rel=1e-3)
        assert point.is_feasible == (not point.lacks)
    assert made[0].gains != made[-1].gains
    assert sum(point.is_feasible for point in made) >= 3
