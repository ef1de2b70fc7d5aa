"""The choice: margin where the benefit lies within the uncertainty of paired seas, bounds last, designs beside it."""

from dataclasses import replace

import numpy as np
import pytest
from tests.control.fin_tasks import PUBLISHED
from tests.control.fin_tasks import sampled_fin_task as fin_task

from seatrial.control.choice import (
    _HEATS,
    HARD_WORKING,
    ROBUST,
    _best_candidate,
    _Candidate,
    _designs,
    _SelectionSeas,
)
from seatrial.control.gain_evaluation import gain_evaluator, gains_on_bound
from seatrial.control.task import SimulationSettings

SEAS = np.array([0.70, 0.72, 0.69, 0.71])


def candidate(
    gain: float, Ms: float, *, is_on_bound: bool = False, is_delay_kept: bool = True, loss: float = 0.0
) -> _Candidate:
    judge = gain_evaluator(fin_task())
    scatter = 1e-3 * np.arange(len(SEAS))
    reductions = SEAS + gain + scatter
    return _Candidate(
        judge, np.full(3, Ms), "front", reductions, reductions, lambda: reductions + loss, 1.0, Ms, is_on_bound,
        is_delay_kept,
    )  # fmt: skip


def test_margin_is_preferred_where_the_benefit_is_not_sure() -> None:
    frail, safe = candidate(0.002, 1.6), candidate(0.0, 1.3)
    assert _best_candidate([frail, safe]) is safe


def test_a_sure_benefit_is_taken() -> None:
    frail, safe = candidate(0.02, 1.6), candidate(0.0, 1.3)
    assert _best_candidate([frail, safe]) is frail


def test_gains_within_the_search_and_enough_delay_margin_come_first() -> None:
    inside, on_bound = candidate(0.0, 1.5), candidate(0.001, 1.2, is_on_bound=True)
    late = candidate(0.1, 1.2, is_delay_kept=False)
    assert _best_candidate([late, on_bound, inside]) is inside


def test_who_loses_much_to_the_limits_is_neither_chosen_nor_the_measure_of_others() -> None:
    lossy, kept = candidate(0.02, 1.2, loss=0.03), candidate(0.0, 1.6)
    assert _best_candidate([lossy, kept]) is kept
    assert _best_candidate([lossy]) is lossy


def test_a_race_ends_at_the_candidate_that_all_seas_would_choose() -> None:
    task = replace(fin_task(), simulation=SimulationSettings(seeds=4, duration=200.0, dt=0.05))
    judge, seas = gain_evaluator(task), _SelectionSeas(task, 1000)
    made = [seas.candidate(judge, "front", scale * PUBLISHED) for scale in (0.2, 0.5, 0.9, 1.0, 1.1)]
    raced, whole = seas.raced(made), [seas.tried(one) for one in made]
    best, wanted = _best_candidate(raced), _best_candidate(whole)
    assert np.array_equal(best.gains, wanted.gains) and np.array_equal(best.reductions, wanted.reductions)
    assert len(best.limited) == _HEATS[-1] and len(raced) < len(made)


def test_a_robust_and_a_hard_working_design_stand_beside_the_choice() -> None:
    robust, chosen, hard = candidate(-0.1, 1.2), candidate(0.0, 1.45), candidate(0.001, 1.6)
    assert _best_candidate([robust, chosen, hard]) is chosen
    assert [d.name for d in _designs([robust, chosen, hard], chosen)] == [ROBUST, HARD_WORKING]
    assert _designs([chosen], chosen) == ()


@pytest.mark.parametrize(("KI", "count"), [(50.0, 1), (25.0, 0), (0.0, 0)])
def test_a_gain_on_the_bound_is_named(KI: float, count: int) -> None:
    assert gains_on_bound(fin_task().loop, np.array([11.0, KI, 32.0])) == (("KI", "upper", 50.0),) * count


def test_a_delay_margin_below_twice_the_dead_time_is_broken() -> None:
    from seatrial.control.controller import describe_controller

    task = fin_task()
    late = replace(task, constraints=replace(task.constraints, delay=10.0))
    gains = np.array([11.053, 0.428, 32.736])
    (broken,) = describe_controller(gain_evaluator(late), "published", gains).violated
    assert broken.startswith("delay margin") and "10 s are required" in broken
