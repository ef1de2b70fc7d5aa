"""A schedule beside one set of gains for all, over the conditions of the published fins."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.control.fin_tasks import KNOT, PUBLISHED, VARIANCES, fin_task

from seatrial.control.schedule import schedule, schedule_conditions
from seatrial.control.task import Effectiveness, ScheduleGrid

SPEEDS = tuple(kn * KNOT for kn in (14.0, 18.0, 22.0))
HEADINGS = tuple(math.radians(d) for d in (45.0, 90.0, 135.0))
PLAN = ScheduleGrid(SPEEDS, HEADINGS, (2.0, 3.3, 4.5))


@pytest.fixture(scope="module")
def made():
    task = replace(fin_task(), effectiveness=Effectiveness.SPEED_SQUARED)
    return schedule(task, PLAN, {"published": PUBLISHED}, 0, lambda _: None)


def test_every_condition_is_kept_and_the_mean_cost_falls_by_two_fifths(made):
    assert len(made) == 27
    assert all(slot.is_feasible for slot in made)
    own, published = (
        np.mean([f(s) for s in made]) for f in (lambda s: s.cost, lambda s: s.baseline_costs["published"])
    )
    assert own <= 0.6 * published


@pytest.mark.parametrize("beta", HEADINGS)
def test_no_heading_is_worse_than_with_the_published_gains(made, beta):
    here = [slot for slot in made if slot.beta == beta]
    assert np.mean([s.cost for s in here]) <= np.mean([s.baseline_costs["published"] for s in here])


def test_a_schedule_is_never_worse_than_one_set_of_gains_that_keeps_the_restrictions(made):
    assert all(slot.cost <= slot.baseline_costs["one for all"] * (1.0 + 1e-9) for slot in made)


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
