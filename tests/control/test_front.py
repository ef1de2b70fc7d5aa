"""The front against a brute-force grid, the paper's gains, and arithmetic."""

from dataclasses import replace

import numpy as np
import pytest
from tests.control.fin_tasks import PAPER_OBJECTIVES, PUBLISHED, QUICK, VARIANCES, fin_task
from tests.control.loop_files import write_loop_file

from seatrial.control.front import (
    RATES,
    Effort,
    grid_front,
    pareto_front,
    rate_curve,
    refuse_infeasible,
    spread_points,
    thin_front,
)
from seatrial.control.gain_evaluation import all_gains, free_gain_bounds, gain_evaluator, refine_gains
from seatrial.control.loopfile.load import tuning_task
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import InputError
from seatrial.numerics.optimise import hypervolume, non_dominated
from seatrial.physics.loops.structures import Preamplifier

FREE = ControllerConstraints(Ms=2.0)


def _silent(_: str) -> None:
    pass


@pytest.mark.parametrize("preamplifier", Preamplifier)
@pytest.mark.parametrize("objectives", [VARIANCES, PAPER_OBJECTIVES])
def test_front_reaches_what_a_grid_of_all_gains_does(preamplifier, objectives):
    one = gain_evaluator(fin_task(preamplifier, objectives, FREE))
    known = grid_front(one, (60, 60, 60))
    made = pareto_front(one, "three gains", 0, _silent, QUICK)
    nadir = known.max(axis=0)
    assert hypervolume(made.objectives, nadir) >= 0.97 * hypervolume(known, nadir)
    assert np.all(made.Ms <= 2.0 * (1.0 + 1e-9))
    assert len(non_dominated(made.objectives)) == len(made.objectives)


def test_all_three_objectives_fall_far_below_the_papers_where_its_loop_is_fragile():
    one = gain_evaluator(fin_task(Preamplifier.PRINTED, restriction=FREE))
    made = pareto_front(one, "three gains", 0, _silent, QUICK)
    published = one.evaluate(PUBLISHED[None])
    assert (made.objectives / published.objectives).max(axis=1).min() <= 0.62
    assert published.Ms[0] > 5.0


def test_with_a_washout_the_papers_gains_lie_near_the_front():
    one = gain_evaluator(fin_task(Preamplifier.WASHOUT, restriction=FREE))
    made = pareto_front(one, "three gains", 0, _silent, QUICK)
    ratio = (made.objectives / one.evaluate(PUBLISHED[None]).objectives).max(axis=1).min()
    assert 0.95 <= ratio <= 1.0


CATAMARAN = """
[plant]
response = { num = [7.4371, 33.818, 10.634], den = [1.0, 9.2539, 25.160, 18.190, 7.0121, 0.0] }
output = "psi"
actuator = "delta"
speed = 1.34
[controller]
kind = "pid"
sample_s = 0.1
[actuator]
limit = { value = 0.4, unit = "rad" }
rate = { value = 10, unit = "rad/s" }
dead_time = 0.1
[sensors]
noise = { value = 0.5, unit = "deg" }
[limits]
Ms = 1.8
[[slow_disturbances]]
rms = { value = 0.05, unit = "rad" }
bandwidth = 0.2
[demand]
change = { value = 30, unit = "deg" }
time_constant = 1.5
"""


def test_no_controller_of_the_front_beats_an_optimum_along_the_rate(tmp_path):
    """Followed from the least rate alone, optima of this thruster craft stay without an integral up to twice it."""
    judge = gain_evaluator(tuning_task(write_loop_file(tmp_path, CATAMARAN)))
    curve = rate_curve(judge, 0)
    values = judge.evaluate(curve.gains_at(curve.levels)).objectives
    front = pareto_front(judge, "three gains", 0, _silent, QUICK).objectives
    assert len(values) == RATES
    assert not (front[:, None] < (1.0 - 1e-6) * values).all(axis=2).any()


def test_same_seed_same_front():
    one = gain_evaluator(fin_task())
    tiny = Effort(2, 1, 500)
    first, again = (pareto_front(one, "", 3, _silent, tiny) for _ in range(2))
    assert np.array_equal(first.gains, again.gains)


def test_pressing_keeps_restrictions_and_ceiling():
    one = gain_evaluator(fin_task())
    start = np.array([5.0, 5.0, 20.0])
    before = one.evaluate(start[None])
    assert before.is_feasible[0]
    after = one.evaluate(refine_gains(one, start, before.objectives[0])[None])
    assert after.is_feasible[0] or after.excess.max() < 1e-6
    assert np.all(after.objectives <= before.objectives * (1.0 + 1e-6))


def test_fixed_gains_stay():
    task = fin_task()
    held = replace(task, loop=replace(task.loop, gains=task.loop.gains.fixed("KI")))
    one = gain_evaluator(held)
    made = pareto_front(one, "two gains", 0, _silent, Effort(2, 1, 500))
    assert np.all(made.gains[:, 1] == 0.428)
    assert len(free_gain_bounds(one)[0]) == 2
    assert all_gains(one, np.zeros((1, 2)))[0].tolist() == [0.0, 0.428, 0.0]


def test_thinned_keeps_the_extremes():
    one = gain_evaluator(fin_task())
    made = pareto_front(one, "", 0, _silent, Effort(2, 2, 2000))
    few = thin_front(made, 20)
    assert len(few.gains) == 20
    np.testing.assert_array_equal(few.objectives.min(axis=0), made.objectives.min(axis=0))
    assert np.all(np.diff(few.objectives[:, 0]) >= 0.0)


def test_spread_takes_no_point_twice():
    rng = np.random.default_rng(0)
    some = spread_points(rng.random((100, 2)) + 0.1, 30)
    assert len(set(some.tolist())) == 30


def test_hypervolume_of_a_staircase():
    points = np.array([[0.0, 2.0], [1.0, 1.0], [2.0, 0.0]])
    assert hypervolume(points, np.array([3.0, 3.0])) == pytest.approx(1.0 + 2.0 + 3.0)


def test_an_empty_feasible_set_names_the_restriction_and_by_how_much():
    # no gain at all may be moved to nothing: Ms of one is kept by no loop that does anything
    task = fin_task(restriction=ControllerConstraints(Ms=1.05))
    gains = task.loop.gains.bounded("KP", 5.0, 100.0)
    one = gain_evaluator(replace(task, loop=replace(task.loop, gains=gains)))
    with pytest.raises(InputError, match=r"keep all limits: the nearest .* exceed Ms of 1.05 by [\d.]+ %"):
        refuse_infeasible(one, 0)
