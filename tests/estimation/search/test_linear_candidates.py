"""Candidates of a linear model against the package's own simulator of records, one by one."""

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.estimation.search import JudgedRun, LinearCandidates, one_sample_fitness, run_search, whole_record_fitness
from seatrial.numerics.optimise import Box, ParticleSwarm, SwarmSettings
from seatrial.physics.models import heave_pitch
from seatrial.physics.simulate import Forcing, LinearBatch
from seatrial_studies.seaway import theoretical_coefficients

SAMPLES, DT, SUBSTEPS = 40, 0.2, 8
NAMES = ("a33", "a35", "b33", "b53", "lift_1")
SIGMA = np.array([0.01, 0.002])
MODEL = theoretical_coefficients(135).applied_to(heave_pitch()).with_values({"lift_1": 8e5, "x_f1": -25.0})
TRUTH = np.array([MODEL.parameters[name].value for name in NAMES])
START = np.array([0.1, -0.2, 0.01, 0.02])


def recorded_inputs(seed: int) -> Array:
    """Wave force and moment as noise, one fin that jumps, one at rest."""
    rng = np.random.default_rng(seed)
    inputs = np.zeros((SAMPLES, 4))
    inputs[:, :2] = rng.standard_normal((SAMPLES, 2)) * [4e5, 6e6]
    inputs[:, 2] = np.repeat(rng.uniform(-0.2, 0.2, SAMPLES // 5), 5)
    return inputs


def simulator(inputs: Array) -> LinearBatch:
    return LinearBatch(MODEL, inputs, np.array([0, SAMPLES]), DT, MODEL.states)


def simulated(inputs: Array, point: Array) -> Array:
    values = MODEL.with_values(dict(zip(NAMES, map(float, point), strict=True))).parameters.values
    return simulator(inputs).simulate(0, 1, START[None], values[None], np.empty((1, 0)))[0]


def judged_run(inputs: Array, *, with_states: bool = False) -> JudgedRun:
    states = simulated(inputs, TRUTH)
    forcing = Forcing(simulator(inputs).fine_inputs(0)[0][:, :3], DT, is_held=False, substeps=SUBSTEPS,
                      held_columns=(2,))  # fmt: skip
    return JudgedRun(forcing, START, states[:, [0, 2]], states if with_states else None)


def candidates(*runs: JudgedRun) -> LinearCandidates:
    return LinearCandidates(MODEL, NAMES, (0, 1, 2), runs, (0, 2), SIGMA)


@pytest.fixture
def points() -> Array:
    return TRUTH * (1.0 + 0.3 * np.random.default_rng(5).uniform(-1.0, 1.0, (3, len(NAMES))))


def test_a_record_is_judged_as_the_simulator_of_records_has_it(points: Array) -> None:
    first, second = recorded_inputs(1), recorded_inputs(2)
    both = candidates(judged_run(first), judged_run(second))
    expected = [
        np.sqrt(np.mean([
            (simulated(inputs, p)[:, [0, 2]] - simulated(inputs, TRUTH)[:, [0, 2]]) ** 2 / SIGMA**2
            for inputs in (first, second)
        ]))
        for p in points
    ]  # fmt: skip
    np.testing.assert_allclose(whole_record_fitness(both)(points), expected, rtol=1e-9)
    assert both.record_rms(TRUTH[None])[0] < 1e-9


def test_a_sample_is_judged_by_one_step_from_the_recorded_state(points: Array) -> None:
    inputs = recorded_inputs(1)
    truth = simulated(inputs, TRUTH)
    one = candidates(judged_run(inputs, with_states=True))
    box = Box(TRUTH - np.abs(TRUTH), TRUTH + np.abs(TRUTH))
    swarm = ParticleSwarm(box, np.random.default_rng(0), SwarmSettings(iterations=4))
    fitness = one_sample_fitness(one, swarm)
    for step in range(3):
        reached = np.array([one.advanced_state(p, step, truth[step]) for p in points])
        expected = np.sqrt(np.mean(((reached[:, [0, 2]] - truth[step + 1, [0, 2]]) / SIGMA) ** 2, axis=1))
        np.testing.assert_allclose(fitness(points), expected, rtol=1e-9)
        swarm.tell(fitness(swarm.ask()))


def test_without_recorded_states_the_best_points_carry_the_state() -> None:
    inputs = recorded_inputs(1)
    one = candidates(judged_run(inputs), judged_run(recorded_inputs(2)))
    state = START
    for step in range(SAMPLES - 1):
        state = one.advanced_state(TRUTH, step, state)
    np.testing.assert_allclose(state, simulated(inputs, TRUTH)[-1], rtol=1e-9)
    assert one.given_state(1) is None
    np.testing.assert_array_equal(one.given_state(SAMPLES - 1), START)
    assert one.step_count == 2 * (SAMPLES - 1)


def test_a_sample_that_was_not_measured_prefers_nobody(points: Array) -> None:
    run = judged_run(recorded_inputs(1))
    run.measured[3] = np.nan
    np.testing.assert_array_equal(candidates(run).step_rms(points, 2, START), np.zeros(len(points)))


def test_a_search_depends_on_seed_and_restart_alone() -> None:
    one = candidates(judged_run(recorded_inputs(1)))
    box = Box(TRUTH - 0.5 * np.abs(TRUTH), TRUTH + 0.5 * np.abs(TRUTH))

    def search(seed: int, restart: int) -> Array:
        def create(bounds: Box, rng: np.random.Generator) -> ParticleSwarm:
            return ParticleSwarm(bounds, rng, SwarmSettings(iterations=5))

        finished = run_search(box, create, lambda _: whole_record_fitness(one), seed, restart)
        assert finished.trace.shape == (5, len(NAMES))
        assert finished.solution.evaluations == 5 * SwarmSettings.population
        return finished.solution.point

    np.testing.assert_array_equal(search(1, 0), search(1, 0))
    assert not np.array_equal(search(1, 0), search(1, 1))
    assert not np.array_equal(search(1, 0), search(2, 0))
