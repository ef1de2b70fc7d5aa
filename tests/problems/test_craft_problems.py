"""Craft whose coefficients are known: truth off the middle of the box, the own estimators at the bound."""

import numpy as np
import pytest

from seatrial.problems import (
    Placement,
    attempt,
    built_in_methods,
    centred_box,
    off_centre_box,
    scaled_values,
    ship_in_wind,
    thruster_craft,
    waterjet_craft,
)
from seatrial.problems import disturbed_craft as nomoto_gusts

FAMILIES = (nomoto_gusts, ship_in_wind, thruster_craft, waterjet_craft)
PROBLEMS = {p.name: p for family in FAMILIES for p in family.problems()}
QUICK = ("song2025-zigzags", "nomoto-gusts-closed", "thrusters-two-fixed", "s175-trials")
"""Problems whose models compile in a second or two; the other craft with thrusters differ in their layout alone."""


def test_boxes_hold_the_truth_and_values_stay_near_the_published_ones() -> None:
    truth, rng = np.array([2.0, -3.0]), np.random.default_rng(0)
    middle = centred_box(truth, 0.1)
    np.testing.assert_allclose(0.5 * (middle.lower + middle.upper), truth)
    for _ in range(20):
        box = off_centre_box(truth, 0.5, rng)
        np.testing.assert_allclose(box.width, np.abs(truth))
        place = (truth - box.lower) / box.width
        assert np.all((place > 0.19) & (place < 0.81))
        assert np.all(np.abs(scaled_values(truth, 0.1, rng) / truth - 1.0) <= 0.1)


@pytest.mark.parametrize("name", QUICK)
def test_a_draw_repeats_itself_and_its_truth_is_near_the_published_one(name: str) -> None:
    problem = PROBLEMS[name]
    draw, again, published = problem.draw(3), problem.draw(3), problem.draw(3, Placement.PUBLISHED)
    truth, first = draw.yardstick.truth, published.yardstick.truth
    assert truth is not None and first is not None and draw.least_squares is not None
    assert truth.tobytes() == again.yardstick.truth.tobytes()  # type: ignore[union-attr]
    assert np.any(truth != first) and np.all(np.abs(truth / first - 1.0) < 0.21)
    cost = draw.least_squares.cost(truth, np.zeros((0, 0)))
    count = draw.fitness(truth[None], 0)[0]
    assert cost == pytest.approx(count) and np.isfinite(cost)
    assert draw.trial is not None
    at_start = {p.name: p.value for p in draw.trial.model.parameters.free}
    assert np.allclose([at_start[name] for name in draw.unknowns], draw.start)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["song2025-zigzags", "thrusters-two-fixed", "s175-trials"])
def test_the_own_estimator_succeeds_under_white_noise(name: str) -> None:
    problem = PROBLEMS[name]
    answer = attempt(built_in_methods()["output-error"], problem, 1)
    assert problem.draw(1).yardstick.error(answer.values) < 1.5


def test_a_ship_in_wind_is_judged_outside_the_distribution_of_its_training() -> None:
    draw, again = (PROBLEMS["s175-wind"].draw(1) for _ in range(2))
    yardstick = draw.yardstick
    assert isinstance(yardstick, ship_in_wind.OutsideYardstick)
    assert yardstick.narx == again.yardstick.narx  # type: ignore[union-attr]
    assert draw.trial is not None and draw.least_squares is not None
    train = [run.raw_record() for run in draw.trial.runs]
    seen = {name: max(float(np.abs(r[name]).max()) for r in train) for name in ("delta", "wind_speed", "u")}
    beyond = yardstick.windows.records
    assert all(max(float(np.abs(r[name]).max()) for r in beyond) > 1.2 * seen[name] for name in ("delta", "wind_speed"))
    start = np.asarray(draw.start)
    answer = attempt(built_in_methods()["output-error"], PROBLEMS["s175-wind"], 1)
    assert yardstick.error(answer.values) < yardstick.success_limit
    assert yardstick.error(answer.values) < 0.5 * yardstick.error(start)


def test_every_craft_with_thrusters_is_a_problem() -> None:
    names = {f"thrusters-{name}" for name in thruster_craft.CRAFTS}
    assert names == {name for name in PROBLEMS if name.startswith("thrusters")}
    for craft in thruster_craft.CRAFTS.values():
        commands = {one.command.channel for one in craft.layout.thrusters}
        assert commands <= set(craft.ranges) and set(craft.values) >= {"M_v", "M_r", "tau"}


@pytest.mark.long
def test_under_gusts_identify_is_near_the_bound_and_output_error_is_not() -> None:
    problem, methods = PROBLEMS["nomoto-gusts-closed"], built_in_methods()
    draw = problem.draw(1)
    near, far = (
        draw.yardstick.error(attempt(methods[name], problem, 1, draw=draw).values)
        for name in ("identify", "output-error")
    )
    assert near < 2.0 < far
