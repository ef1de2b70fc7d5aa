"""The front against a brute-force grid, the paper's gains, and arithmetic."""

from dataclasses import replace

import numpy as np
import pytest
from tests.control.fins import PAPERS, PUBLISHED, QUICK, VARIANCES, fin_task

from seatrial.control.assess import judge
from seatrial.control.feasible import refuse_infeasible
from seatrial.control.front import Effort, front, grid, spread, thinned
from seatrial.control.press import free_box, pressed, whole
from seatrial.core.results.tuning import Restriction
from seatrial.core.values import InputError
from seatrial.numerics.optimise import hypervolume, non_dominated
from seatrial.physics.loops.fin import Preamplifier

FREE = Restriction(peak=2.0)


def _silent(_: str) -> None:
    pass


@pytest.mark.parametrize("preamplifier", Preamplifier)
@pytest.mark.parametrize("objectives", [VARIANCES, PAPERS])
def test_front_reaches_what_a_grid_of_all_gains_does(preamplifier, objectives):
    one = judge(fin_task(preamplifier, objectives, FREE))
    known = grid(one, (60, 60, 60))
    made = front(one, "three gains", 0, _silent, QUICK)
    nadir = known.max(axis=0)
    assert hypervolume(made.objectives, nadir) >= 0.97 * hypervolume(known, nadir)
    assert np.all(made.peak <= 2.0 * (1.0 + 1e-9))
    assert len(non_dominated(made.objectives)) == len(made.objectives)


def test_all_three_objectives_fall_far_below_the_papers_where_its_loop_is_fragile():
    one = judge(fin_task(Preamplifier.PRINTED, restriction=FREE))
    made = front(one, "three gains", 0, _silent, QUICK)
    published = one.of(PUBLISHED[None])
    assert (made.objectives / published.objectives).max(axis=1).min() <= 0.62
    assert published.peak[0] > 5.0


def test_with_a_washout_the_papers_gains_lie_near_the_front():
    one = judge(fin_task(Preamplifier.WASHOUT, restriction=FREE))
    made = front(one, "three gains", 0, _silent, QUICK)
    ratio = (made.objectives / one.of(PUBLISHED[None]).objectives).max(axis=1).min()
    assert 0.95 <= ratio <= 1.0


def test_same_seed_same_front():
    one = judge(fin_task())
    tiny = Effort(20, 3, 2, 1, 500)
    first, again = (front(one, "", 3, _silent, tiny) for _ in range(2))
    assert np.array_equal(first.gains, again.gains)


def test_pressing_keeps_restrictions_and_ceiling():
    one = judge(fin_task())
    start = np.array([5.0, 5.0, 20.0])
    before = one.of(start[None])
    assert before.is_feasible[0]
    after = one.of(pressed(one, start, before.objectives[0])[None])
    assert after.is_feasible[0] or after.excess.max() < 1e-6
    assert np.all(after.objectives <= before.objectives * (1.0 + 1e-6))


def test_fixed_gains_stay():
    task = fin_task()
    held = replace(task, loop=replace(task.loop, gains=task.loop.gains.fixed("KI")))
    one = judge(held)
    made = front(one, "two gains", 0, _silent, Effort(20, 3, 2, 1, 500))
    assert np.all(made.gains[:, 1] == 0.428)
    assert len(free_box(one)[0]) == 2
    assert whole(one, np.zeros((1, 2)))[0].tolist() == [0.0, 0.428, 0.0]


def test_thinned_keeps_the_extremes():
    one = judge(fin_task())
    made = front(one, "", 0, _silent, Effort(40, 5, 2, 2, 2000))
    few = thinned(made, 20)
    assert len(few.gains) == 20
    np.testing.assert_array_equal(few.objectives.min(axis=0), made.objectives.min(axis=0))
    assert np.all(np.diff(few.objectives[:, 0]) >= 0.0)


def test_spread_takes_no_point_twice():
    rng = np.random.default_rng(0)
    some = spread(rng.random((100, 2)) + 0.1, 30)
    assert len(set(some.tolist())) == 30


def test_hypervolume_of_a_staircase():
    points = np.array([[0.0, 2.0], [1.0, 1.0], [2.0, 0.0]])
    assert hypervolume(points, np.array([3.0, 3.0])) == pytest.approx(1.0 + 2.0 + 3.0)


def test_an_empty_feasible_set_names_the_restriction_and_by_how_much():
    # no gain at all may be moved to nothing: Ms of one is kept by no loop that does anything
    task = fin_task(restriction=Restriction(peak=1.05))
    gains = task.loop.gains.bounded("KP", 5.0, 100.0)
    one = judge(replace(task, loop=replace(task.loop, gains=gains)))
    with pytest.raises(InputError, match=r"keep all limits: the nearest .* exceed Ms of 1.05 by [\d.]+ %"):
        refuse_infeasible(one, 0)
