"""Objectives, restrictions and their gradients, over one sea and several."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.control.fin_tasks import PAPER_OBJECTIVES, PUBLISHED, VARIANCES, fin_task

from seatrial.control import gain_evaluation
from seatrial.control.front import rate_curve
from seatrial.control.gain_evaluation import (
    GainEvaluator,
    gain_evaluator,
    least_output_gains,
    polished_gains,
    spread_gains,
)
from seatrial.control.task import Effectiveness
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.physics.loops import Performance
from seatrial.physics.loops.structures import Preamplifier


def _differences(of, gains, step=1e-5):
    return np.array([(of(gains + step * d) - of(gains - step * d)) / (2.0 * step) for d in np.eye(len(gains))]).T


@pytest.mark.parametrize("preamplifier", Preamplifier)
@pytest.mark.parametrize("objectives", [VARIANCES, PAPER_OBJECTIVES])
def test_gradients_are_those_of_the_numbers(preamplifier, objectives):
    one = gain_evaluator(fin_task(preamplifier, objectives))
    gains = np.array([5.0, 3.0, 20.0])
    slopes, excess = one.point(gains).slopes
    np.testing.assert_allclose(slopes, _differences(lambda k: one.evaluate(k[None]).objectives[0], gains), rtol=2e-6)
    np.testing.assert_allclose(
        excess, _differences(lambda k: one.evaluate(k[None]).excess[0], gains), rtol=2e-6, atol=1e-9
    )


def test_objectives_are_means_and_restrictions_the_worst_of_several_seas():
    beam, quarter = fin_task(), fin_task(beta=math.radians(135.0))
    both = replace(beam, disturbances=(*beam.disturbances, *quarter.disturbances))
    single = [gain_evaluator(task).evaluate(PUBLISHED[None]) for task in (beam, quarter)]
    made = gain_evaluator(both).evaluate(PUBLISHED[None])
    np.testing.assert_allclose(made.objectives, np.mean([m.objectives for m in single], axis=0))
    np.testing.assert_allclose(made.excess, np.max([m.excess for m in single], axis=0))


def test_gradient_over_several_seas_and_speeds():
    beam, quarter = fin_task(), fin_task(beta=math.radians(135.0))
    faster = tuple(replace(met, U=11.0) for met in quarter.disturbances)
    both = replace(beam, disturbances=(*beam.disturbances, *faster), effectiveness=Effectiveness.SPEED_SQUARED)
    one, gains = gain_evaluator(both), np.array([8.0, 3.0, 30.0])
    np.testing.assert_allclose(
        one.point(gains).slopes[0], _differences(lambda k: one.evaluate(k[None]).objectives[0], gains), rtol=2e-6
    )


def test_value_and_slopes_of_one_set_of_gains_rest_on_one_evaluation_of_the_loops(monkeypatch):
    calls, evaluate = [], Performance.evaluate

    def counted(performance, gains, *, with_Ms=True):
        calls.append(performance)
        return evaluate(performance, gains, with_Ms=with_Ms)

    monkeypatch.setattr(Performance, "evaluate", counted)
    one, gains = gain_evaluator(fin_task()), np.array([5.0, 3.0, 20.0])
    one.evaluate(gains[None])
    _ = one.point(gains).slopes
    assert calls == list(one.performances)


def test_an_unstable_loop_is_never_good():
    one = gain_evaluator(fin_task(Preamplifier.PRINTED, restriction=ControllerConstraints()))
    made = one.evaluate(np.array([[100.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    assert np.all(np.isinf(made.objectives[0]))
    assert not made.is_feasible[0]
    assert made.is_feasible[1]


def test_saturation_is_the_share_of_rayleigh():
    task = fin_task()
    share = 0.05
    tight = gain_evaluator(replace(task, constraints=replace(task.constraints, saturation=share)))
    variance = float(tight.evaluate(PUBLISHED[None]).variances[0, 0, 1])
    said = math.exp(-(task.constraints.limit**2) / (2.0 * variance))
    assert (tight.evaluate(PUBLISHED[None]).excess[0, 1] > 0.0) == (said > share)


def test_effectiveness_goes_with_the_square_of_the_speed():
    task = replace(fin_task(), effectiveness=Effectiveness.SPEED_SQUARED)
    assert task.loop_at(2.0 * task.U).plant.gain == pytest.approx(4.0 * task.loop.plant.gain)
    assert task.loop_at(2.0 * task.U).disturbance.gain == task.loop.disturbance.gain


@pytest.mark.parametrize("gains", [PUBLISHED, np.array([16.0, 150.0, 1.0])])
def test_each_excess_and_its_slopes_are_those_of_the_numbers(gains):
    one = gain_evaluator(fin_task())
    values, slopes = one.point(gains).excess_of_each
    np.testing.assert_allclose(
        [values[:3].max(), *values[3:]], one.evaluate(gains[None]).excess[0], rtol=1e-9, atol=1e-9
    )
    differences = _differences(lambda k: one.point(k).excess_of_each[0], gains)
    np.testing.assert_allclose(slopes[values > -1.0], differences[values > -1.0], rtol=2e-5, atol=1e-8)


def test_gains_along_the_rate_stay_where_sums_end_in_other_bits(monkeypatch):
    def optima(noise):
        rng, evaluate = np.random.default_rng(noise), Performance.evaluate

        def rounded_elsewhere(self, gains, *, with_Ms=True):
            made = evaluate(self, gains, with_Ms=with_Ms)
            return replace(made, variances=made.variances * (1.0 + 4e-16 * rng.integers(-2, 3, made.variances.shape)))

        with monkeypatch.context() as patch:
            patch.setattr(Performance, "evaluate", rounded_elsewhere)
            curve = rate_curve(gain_evaluator(fin_task()), 0)
            return curve.levels[::5], curve.gains_at(curve.levels[::5])

    (levels, gains), (other_levels, others) = optima(1), optima(2)
    np.testing.assert_allclose(levels, other_levels, rtol=1e-9)
    np.testing.assert_allclose(gains, others, rtol=1e-7, atol=1e-7)


def test_a_point_that_is_no_optimum_is_not_verified():
    task = fin_task()
    one = GainEvaluator(task, task.loop, (task.motion,))
    assert polished_gains(one, np.array([1.0, 1.0, 1.0])) is None


def test_a_search_from_several_starts_ends_where_three_agree_and_not_before(monkeypatch):
    task = fin_task()
    one = GainEvaluator(task, task.loop, (task.motion,))
    press, ends = gain_evaluation._pressed_gains, []

    def pressed(evaluator, start):
        ends.append(press(evaluator, start))
        return ends[-1]

    monkeypatch.setattr(gain_evaluation, "_pressed_gains", pressed)
    samples = spread_gains(one, 0)
    best, count = least_output_gains(one, samples), len(ends)
    assert count == 6  # three samples and three faces, of which two meet in the best
    again = least_output_gains(one, samples, [best])
    agreeing = [is_verified and np.allclose(gains, best, rtol=1e-9, atol=0.0) for gains, is_verified in ends[count:]]
    np.testing.assert_allclose(again, best, rtol=1e-9)
    assert agreeing == [True, False, True, True]
