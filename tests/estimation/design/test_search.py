"""The search: better than what it starts from, within the limits, the same bits again, nothing lost on Ctrl-C."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.design.conftest import BOTH, NOZZLE_RANGE, with_inputs, with_limits

from seatrial.core.results import Design, TrialLimits
from seatrial.data.trial.design_request import DesignCriterion
from seatrial.estimation.design.design import design
from seatrial.estimation.design.manoeuvre_information import (
    ManoeuvreEvaluator,
    ManoeuvreInformation,
    input_series,
    leaves_limits,
    orders_at,
)
from seatrial.estimation.design.search import (
    DesignObjective,
    criterion_errors,
    search_orders,
    search_step,
    standard_manoeuvres,
)
from seatrial.estimation.design.task import DesignTask, draw_ships
from seatrial.physics.simulate.replay import inputs_of

GENERATIONS = 12


def bench(task: DesignTask) -> ManoeuvreEvaluator:
    ships = draw_ships(task, 0)
    return ManoeuvreEvaluator(task, ships, search_step(task, ships))


def quiet(_: str) -> None: ...


def test_standard_manoeuvres_keep_range_rate_and_where_they_can_the_limits(craft: DesignTask) -> None:
    task = with_limits(with_inputs(craft, BOTH, {}), TrialLimits(drift=math.radians(10.0)))
    at = bench(task)
    found = standard_manoeuvres(at)
    assert {"zigzag:10/10", "zigzag:20/20", "consecutive-zigzags:1", "turning-circle:35"} <= {r.name for r in found}
    for one in found:
        made = np.atleast_3d(one.inputs_for(at)).reshape(-1, *one.inputs_for(at).shape[-2:])
        for actuator in task.request.actuators:
            j = task.model.input_names.index(actuator.name)
            sign = -1.0 if task.model.inputs[j].is_reversed else 1.0
            course = sign * made[:, :, j]
            assert course.min() >= actuator.lower - 1e-9
            assert course.max() <= actuator.upper + 1e-9
            assert np.abs(np.diff(course, axis=1)).max() <= actuator.rate * at.dt * (1.0 + 1e-9)
        if one.is_random:
            assert not leaves_limits(task, at.evaluate(one.inputs_for(at)))
            assert np.ptp(made[0], axis=0).min() > 0.0


def test_a_trial_with_room_for_four_orders_has_its_standard_manoeuvres(craft: DesignTask) -> None:
    quarter = replace(NOZZLE_RANGE, hold=0.25 * craft.request.duration)
    task = with_inputs(craft, {"delta": quarter}, dict(craft.request.held))
    standards = standard_manoeuvres(bench(task))
    assert any(standard.is_random for standard in standards)
    assert len({standard.name for standard in standards}) == len(standards), "one hold for all: each row once"


def test_the_yardstick_of_a_standard_manoeuvre_is_never_below_one(craft: DesignTask) -> None:
    at = bench(craft)
    standard = standard_manoeuvres(at)
    reference = DesignObjective.from_standards(at, standard).baseline_errors
    for one in standard:
        assert np.all(criterion_errors(craft, at.evaluate(one.inputs_for(at))) >= reference * (1.0 - 1e-12))


def test_leaving_the_limits_costs_more_than_any_worth(craft: DesignTask) -> None:
    at = bench(craft)
    point = np.tile([1.0, 1.0, 0.0, 0.0], 3)
    drift = at.evaluate(input_series(craft, orders_at(craft, point), at.dt)).drift[0]
    tight = replace(at, task=with_limits(craft, TrialLimits(drift=0.5 * float(drift))))
    reference = np.ones(at.ships.count)
    assert DesignObjective(tight, reference).cost(point) > DesignObjective(at, reference).cost(point) + 10.0


def test_the_search_improves_and_repeats_itself_to_the_bit(craft: DesignTask) -> None:
    at = bench(craft)
    yardstick = DesignObjective.from_standards(at, standard_manoeuvres(at))
    first, again = (search_orders(yardstick, 7, quiet, GENERATIONS)[0] for _ in range(2))
    other, _ = search_orders(yardstick, 8, quiet, GENERATIONS)
    assert np.array_equal(first.point, again.point)
    assert not np.array_equal(first.point, other.point)
    history = np.array(first.history)
    assert np.all(np.diff(history) <= 0.0)
    assert history[-1] < history[0] - 0.1
    assert yardstick.cost(first.point) == first.value == history[-1]


def test_one_worker_finds_the_same_bits(craft: DesignTask, monkeypatch: pytest.MonkeyPatch) -> None:
    at = bench(craft)
    yardstick = DesignObjective.from_standards(at, standard_manoeuvres(at))
    many, _ = search_orders(yardstick, 7, quiet, GENERATIONS)
    monkeypatch.setattr(
        "seatrial.estimation.design.search.map_in_threads", lambda function, items: [function(i) for i in items]
    )
    assert np.array_equal(search_orders(yardstick, 7, quiet, GENERATIONS)[0].point, many.point)


def test_a_strategy_without_gains_ends_at_the_point_that_it_had(
    craft: DesignTask, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two generations without a gain end it, here before its twelve are over; the point is the one of that time."""
    at = bench(craft)
    yardstick = DesignObjective.from_standards(at, standard_manoeuvres(at))
    whole, _ = search_orders(yardstick, 7, quiet, GENERATIONS)
    monkeypatch.setattr("seatrial.estimation.design.search.IDLE_GENERATIONS", 2)
    found, _ = search_orders(yardstick, 7, quiet, GENERATIONS)
    assert len(found.history) < len(whole.history)
    assert found.history == whole.history[: len(found.history)]
    assert found.history[-1] == found.history[-3] == found.value


def test_ctrl_c_gives_the_best_so_far_and_says_so(craft: DesignTask) -> None:
    said: list[str] = []

    def interrupting(text: str) -> None:
        said.append(text)
        if text.startswith("search"):
            raise KeyboardInterrupt

    made = design(craft, 3, interrupting, generations=40)
    assert "interrupted" in [f.code for f in made.findings]
    assert made.confirmation is None
    assert made.designed.worst < 1.0
    whole = design(craft, 3, quiet, confirmation_runs=0, generations=40)
    assert whole.solution.value <= made.solution.value
    assert whole.solution.evaluations > made.solution.evaluations


@pytest.fixture(scope="module")
def limited(craft: DesignTask) -> Design:
    task = with_limits(craft, TrialLimits(drift=math.radians(12.0), sea_room=150.0))
    return design(task, 1, quiet, confirmation_runs=8, generations=60)


def test_a_design_keeps_its_limits_and_beats_the_standard_manoeuvres_that_do(limited: Design) -> None:
    assert limited.designed.drift <= limited.limits.drift
    assert limited.designed.distance <= limited.limits.sea_room
    keeping = [
        w for w in limited.baselines if w.drift <= limited.limits.drift and w.distance <= limited.limits.sea_room
    ]
    assert keeping
    assert limited.designed.worst < min(w.worst for w in keeping)


def test_its_plan_gives_its_worth_and_its_track(craft: DesignTask, limited: Design) -> None:
    at = ManoeuvreEvaluator(with_limits(craft, limited.limits), draw_ships(craft, 0, 0), 1.0 / limited.rate)
    evaluated = at.evaluate(inputs_of(limited.model, limited.plan))
    assert np.array_equal(evaluated.relative_errors[0], limited.designed.relative_error)
    track = limited.designed.executed
    assert float(np.hypot(track.channel("x0").values, track.channel("y0").values).max()) == pytest.approx(
        limited.designed.distance, rel=1e-9
    )


def test_simulated_trials_err_as_the_bound_foretells(limited: Design) -> None:
    """Eight trials, four coefficients: 32 squared ratios, whose root mean square lies within 1 -+ .4 at 3 sd."""
    tried = limited.confirmation
    assert tried is not None
    assert tried.converged_runs == tried.runs == 8
    assert 0.6 < float(np.sqrt(np.mean((tried.error / tried.bound) ** 2))) < 1.4


@pytest.mark.parametrize(
    ("criterion", "expected"), [(DesignCriterion.WORST, 0.4), (DesignCriterion.MEAN, 0.19**0.5 / 2.0)]
)
def test_the_criterion_decides_what_is_made_small(
    craft: DesignTask, criterion: DesignCriterion, expected: float
) -> None:
    evaluated = ManoeuvreInformation(np.array([[0.1, 0.1, 0.4, 0.1], [0.3, 0.3, 0.3, 0.3]]), np.zeros(2), np.zeros(2))
    at = criterion_errors(replace(craft, request=replace(craft.request, criterion=criterion)), evaluated)
    assert at == pytest.approx([expected, 0.3])
