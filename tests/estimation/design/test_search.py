"""The search: better than what it starts from, within the limits, the same bits again, nothing lost on Ctrl-C."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.design.conftest import JET, NOZZLE

from seatrial.core.results import Design, Limits
from seatrial.estimation.design.design import design
from seatrial.estimation.design.orders import inputs, split
from seatrial.estimation.design.search import Yardstick, coarse, errors_of, search
from seatrial.estimation.design.ships import ships
from seatrial.estimation.design.standards import standards
from seatrial.estimation.design.task import Criterion, Task
from seatrial.estimation.design.worth import Bench, Told, leaves
from seatrial.physics.simulate.channels import inputs_of

GENERATIONS = 12


def bench(task: Task) -> Bench:
    return Bench(task, ships(task, 0), coarse(task))


def quiet(_: str) -> None: ...


def test_standard_manoeuvres_keep_range_rate_and_where_they_can_the_limits(craft: Task) -> None:
    task = replace(craft, actuators=(NOZZLE, JET), held={}, limits=Limits(drift=math.radians(10.0)))
    at = bench(task)
    found = standards(at)
    assert {"zigzag:10/10", "zigzag:20/20", "consecutive-zigzags:1", "turning-circle:35"} <= {r.name for r in found}
    for one in found:
        made = np.atleast_3d(one.made(at)).reshape(-1, *one.made(at).shape[-2:])
        for actuator in task.actuators:
            j = task.model.input_names.index(actuator.name)
            sign = -1.0 if task.model.inputs[j].is_turned else 1.0
            course = sign * made[:, :, j]
            assert course.min() >= actuator.lower - 1e-9
            assert course.max() <= actuator.upper + 1e-9
            assert np.abs(np.diff(course, axis=1)).max() <= actuator.rate * at.dt * (1.0 + 1e-9)
        if one.is_random:
            assert not leaves(task, at.told(one.made(at)))
            assert np.ptp(made[0], axis=0).min() > 0.0


def test_the_yardstick_of_a_standard_manoeuvre_is_never_below_one(craft: Task) -> None:
    at = bench(craft)
    standard = standards(at)
    reference = Yardstick.of(at, standard).reference
    for one in standard:
        assert np.all(errors_of(craft, at.told(one.made(at))) >= reference * (1.0 - 1e-12))


def test_leaving_the_limits_costs_more_than_any_worth(craft: Task) -> None:
    at = bench(craft)
    point = np.tile([1.0, 1.0, 0.0, 0.0], 3)
    drift = at.told(inputs(craft, split(craft, point), at.dt)).drift[0]
    tight = replace(at, task=replace(craft, limits=Limits(drift=0.5 * float(drift))))
    reference = np.ones(at.ships.count)
    assert Yardstick(tight, reference).cost(point) > Yardstick(at, reference).cost(point) + 10.0


def test_the_search_improves_and_repeats_itself_to_the_bit(craft: Task) -> None:
    at = bench(craft)
    yardstick = Yardstick.of(at, standards(at))
    first, again = (search(yardstick, 7, quiet, GENERATIONS) for _ in range(2))
    other = search(yardstick, 8, quiet, GENERATIONS)
    assert np.array_equal(first.solution.point, again.solution.point)
    assert not np.array_equal(first.solution.point, other.solution.point)
    history = np.array(first.solution.history)
    assert np.all(np.diff(history) <= 0.0)
    assert history[-1] < history[0] - 0.1
    assert yardstick.cost(first.solution.point) == first.solution.value == history[-1]


def test_one_worker_finds_the_same_bits(craft: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    at = bench(craft)
    yardstick = Yardstick.of(at, standards(at))
    many = search(yardstick, 7, quiet, GENERATIONS)
    monkeypatch.setattr(
        "seatrial.estimation.design.search.mapped", lambda function, items: [function(i) for i in items]
    )
    assert np.array_equal(search(yardstick, 7, quiet, GENERATIONS).solution.point, many.solution.point)


def test_ctrl_c_gives_the_best_so_far_and_says_so(craft: Task) -> None:
    said: list[str] = []

    def interrupting(text: str) -> None:
        said.append(text)
        if text.startswith("search"):
            raise KeyboardInterrupt

    made = design(craft, 3, interrupting, generations=40)
    assert "interrupted" in [f.code for f in made.findings]
    assert made.confirmation is None
    assert made.designed.worst < 1.0
    whole = design(craft, 3, quiet, confirming=0, generations=40)
    assert whole.solution.value <= made.solution.value
    assert whole.solution.evaluations > made.solution.evaluations


@pytest.fixture(scope="module")
def limited(craft: Task) -> Design:
    task = replace(craft, limits=Limits(drift=math.radians(12.0), room=150.0))
    return design(task, 1, quiet, confirming=8, generations=60)


def test_a_design_keeps_its_limits_and_beats_the_standard_manoeuvres_that_do(limited: Design) -> None:
    assert limited.designed.drift <= limited.limits.drift
    assert limited.designed.room <= limited.limits.room
    keeping = [w for w in limited.rivals if w.drift <= limited.limits.drift and w.room <= limited.limits.room]
    assert keeping
    assert limited.designed.worst < min(w.worst for w in keeping)


def test_its_plan_gives_its_worth_and_its_track(craft: Task, limited: Design) -> None:
    at = Bench(replace(craft, limits=limited.limits), ships(craft, 0, 0), 1.0 / limited.rate)
    told = at.told(inputs_of(limited.model, limited.plan))
    assert np.array_equal(told.relative[0], limited.designed.relative)
    track = limited.designed.executed
    assert float(np.hypot(track.channel("x0").values, track.channel("y0").values).max()) == pytest.approx(
        limited.designed.room, rel=1e-9
    )


def test_simulated_trials_err_as_the_bound_foretells(limited: Design) -> None:
    """Eight trials, four coefficients: 32 squared ratios, whose root mean square lies within 1 -+ .4 at 3 sd."""
    tried = limited.confirmation
    assert tried is not None
    assert tried.converged == tried.runs == 8
    assert 0.6 < float(np.sqrt(np.mean((tried.error / tried.bound) ** 2))) < 1.4


@pytest.mark.parametrize(("criterion", "expected"), [(Criterion.WORST, 0.4), (Criterion.MEAN, 0.19**0.5 / 2.0)])
def test_the_criterion_decides_what_is_made_small(craft: Task, criterion: Criterion, expected: float) -> None:
    told = Told(np.array([[0.1, 0.1, 0.4, 0.1], [0.3, 0.3, 0.3, 0.3]]), np.zeros(2), np.zeros(2))
    at = errors_of(replace(craft, criterion=criterion), told)
    assert at == pytest.approx([expected, 0.3])
