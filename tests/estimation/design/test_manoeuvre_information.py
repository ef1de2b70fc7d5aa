"""What a manoeuvre is worth: the house's own Cramer-Rao bound, and the laws that information obeys."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.design.conftest import with_limits

from seatrial.core.results import TrialLimits
from seatrial.core.values import Array
from seatrial.core.values.parameters import Prior
from seatrial.estimation.design.manoeuvre_information import (
    ManoeuvreEvaluator,
    input_series,
    leaves_limits,
    limit_excess,
    order_counts,
    planned_record,
    simulate_plan,
)
from seatrial.estimation.design.task import DesignTask, PriorShips, draw_ships, relative_spread
from seatrial.estimation.information.covariance import from_information
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments


def hard(task: DesignTask, seed: int = 1) -> list[Array]:
    (actuator,), (count,) = task.request.actuators, order_counts(task)
    return [np.random.default_rng(seed).choice([actuator.lower, actuator.upper], size=count)]


def alone(task: DesignTask, dt: float) -> ManoeuvreEvaluator:
    return ManoeuvreEvaluator(task, draw_ships(task, 0, 0), dt)


def errors(task: DesignTask, dt: float) -> Array:
    return alone(task, dt).evaluate(input_series(task, hard(task), dt)).relative_errors[0]


def test_it_is_the_bound_of_output_error_with_the_initial_state_unknown(craft: DesignTask) -> None:
    dt = 1.0 / craft.request.rate
    record = simulate_plan(craft, planned_record(craft, input_series(craft, hard(craft), dt), dt), "hard")
    noise = np.array(list(craft.sensors.values()))
    problem = OutputError(
        craft.model, cut_segments(craft.model, [record], tuple(craft.sensors), None), noise, workers=1
    )
    bound = from_information(
        problem.normal(problem.start(), problem.measured_initial_states()).without_local()[1]
    ).standard_error
    values = np.array([p.value for p in craft.model.parameters.free])
    assert errors(craft, dt) == pytest.approx(bound / np.abs(values), rel=1e-6)


def test_sensors_twice_as_good_or_four_times_as_fast_halve_the_errors(craft: DesignTask) -> None:
    reference = errors(craft, 1.0)
    better = replace(craft, sensors={name: 0.5 * s for name, s in craft.sensors.items()})
    assert errors(better, 1.0) == pytest.approx(0.5 * reference, rel=1e-9)
    assert errors(replace(craft, request=replace(craft.request, rate=4.0 * craft.request.rate)), 1.0) == pytest.approx(
        0.5 * reference, rel=1e-9
    )


def test_what_goes_on_longer_or_measures_more_never_tells_less(craft: DesignTask) -> None:
    dt = 1.0
    whole = alone(craft, dt).evaluate(input_series(craft, hard(craft), dt)).relative_errors[0]
    shorter = replace(craft, request=replace(craft.request, duration=150.0))
    less = alone(shorter, dt).evaluate(input_series(craft, hard(craft), dt)[:151]).relative_errors[0]
    assert np.all(whole < less)
    fewer = {n: s for n, s in craft.sensors.items() if n != "v"}
    assert np.all(whole < errors(replace(craft, sensors=fewer), dt))


def test_a_prior_adds_its_information_and_no_more(craft: DesignTask) -> None:
    sd = 1e-4
    parameters = craft.model.parameters.with_priors({"N_r": Prior(craft.model.parameters["N_r"].value, sd)})
    evaluated = replace(craft, model=craft.model.with_parameters(parameters))
    with_it, without = errors(evaluated, 1.0), errors(craft, 1.0)
    place = craft.model.parameters.free_names.index("N_r")
    size = abs(craft.model.parameters["N_r"].value)
    assert with_it[place] == pytest.approx((size**2 / sd**2 + without[place] ** -2) ** -0.5, rel=1e-6)
    assert np.all(with_it <= without * (1.0 + 1e-9))


def test_the_search_s_step_scores_as_the_sensors_rate_does(craft: DesignTask) -> None:
    assert errors(craft, 1.0) == pytest.approx(errors(craft, 0.2), rel=0.01)


def test_one_course_each_is_that_of_each_alone(craft: DesignTask) -> None:
    fleet = draw_ships(craft, 3)
    bench = ManoeuvreEvaluator(craft, fleet, 1.0)
    each = np.stack([input_series(craft, hard(craft, k), 1.0) for k in range(fleet.count)])
    together = bench.evaluate(each)
    for k in range(fleet.count):
        one = ManoeuvreEvaluator(craft, PriorShips(fleet.parameters[k : k + 1], fleet.precision), 1.0).evaluate(each[k])
        assert np.array_equal(one.relative_errors[0], together.relative_errors[k])
        assert (one.drift[0], one.distance[0]) == (together.drift[k], together.distance[k])


def test_a_lost_ship_is_stated_as_lost_and_spoils_no_other(craft: DesignTask) -> None:
    fleet = draw_ships(craft, 3)
    mad = fleet.parameters.copy()
    mad[1, craft.model.parameters.index("N_r")] = 50.0
    made = input_series(craft, hard(craft), 1.0)
    evaluated, sane = (
        ManoeuvreEvaluator(craft, PriorShips(mad, fleet.precision), 1.0).evaluate(made),
        ManoeuvreEvaluator(craft, fleet, 1.0).evaluate(made),
    )
    assert np.isnan(evaluated.relative_errors[1]).all()
    others = [0, 2, 3]
    assert np.array_equal(evaluated.relative_errors[others], sane.relative_errors[others])


def test_limits_bind_the_ship_assumed_and_the_others_on_request(craft: DesignTask) -> None:
    bench = ManoeuvreEvaluator(craft, draw_ships(craft, 3), 1.0)
    evaluated = bench.evaluate(input_series(craft, hard(craft), 1.0))
    farthest = int(np.argmax(evaluated.drift))
    assert farthest != 0
    between = TrialLimits(drift=0.5 * float(evaluated.drift[0] + evaluated.drift[farthest]))
    bound, strict = with_limits(craft, between), with_limits(craft, replace(between, for_every_ship=True))
    assert not leaves_limits(bound, evaluated)
    assert leaves_limits(strict, evaluated)
    assert limit_excess(bound, evaluated)[farthest] == pytest.approx(evaluated.drift[farthest] / between.drift - 1.0)


def test_ships_are_the_model_first_then_within_the_spread_and_the_same_for_a_seed(craft: DesignTask) -> None:
    fleet = draw_ships(craft, 5, 200)
    free = [craft.model.parameters.index(n) for n in craft.model.parameters.free_names]
    share = fleet.parameters[:, free] / craft.model.parameters.values[free] - 1.0
    assert np.array_equal(fleet.parameters[0], craft.model.parameters.values)
    assert np.abs(share).max() <= craft.request.relative_spread
    assert share[1:].mean(axis=0) == pytest.approx(0.0, abs=0.005)
    assert share[1:].std(axis=0) == pytest.approx(craft.request.relative_spread / 3**0.5, rel=0.02)
    assert np.array_equal(draw_ships(craft, 5, 200).parameters, fleet.parameters)
    fixed = [i for i in range(len(craft.model.parameters)) if i not in free]
    assert np.array_equal(np.ptp(fleet.parameters[:, fixed], axis=0), np.zeros(len(fixed)))


def test_ships_of_a_fit_have_its_covariance(craft: DesignTask) -> None:
    sizes = np.array([abs(p.value) for p in craft.model.parameters.free])
    unit = np.eye(4) + 0.9 * (np.eye(4, k=1) + np.eye(4, k=-1)) * np.array([1, 0, 0, 0])[:, None]
    unit = np.tril(unit.T) @ np.tril(unit.T).T
    covariance = 0.02**2 * unit * np.outer(sizes, sizes)
    fitted = replace(craft, covariance=covariance)
    free = [craft.model.parameters.index(n) for n in craft.model.parameters.free_names]
    drawn = np.cov(draw_ships(fitted, 5, 2000).parameters[1:, free].T)
    scale = np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    assert drawn / scale == pytest.approx(covariance / scale, abs=0.25)
    assert relative_spread(fitted) == pytest.approx(np.sqrt(np.diag(covariance)) / sizes)
