"""A search fed sample by sample is the search over the whole record at once, whatever the blocks."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.search.test_linear_candidates import SUBSTEPS, TRUTH, candidates, judged_run, recorded_inputs

from seatrial.estimation.search import JudgedRun, SampleSearch, one_sample_fitness, run_search
from seatrial.numerics.optimise import Box, FitnessMemory, ParticleSwarm, SwarmSettings

BOX = Box(TRUTH - 0.5 * np.abs(TRUTH), TRUTH + 0.5 * np.abs(TRUTH))
SETTINGS = SwarmSettings(10, 8, memory=FitnessMemory.RE_EVALUATE)


def swarm(box: Box, rng: np.random.Generator) -> ParticleSwarm:
    return ParticleSwarm(box, rng, SETTINGS)


def run_until(samples: int, first: int = 0, *, with_states: bool = False) -> JudgedRun:
    """The run as it is known after some samples, its first ones gone."""
    run = judged_run(recorded_inputs(1), with_states=with_states)
    fine = SUBSTEPS * np.array([first, samples - 1])
    forcing = replace(run.forcing, inputs=run.forcing.inputs[fine[0] : fine[1] + 1])
    states = None if run.states is None else run.states[first:samples]
    return replace(run, forcing=forcing, measured=run.measured[first:samples], states=states)


@pytest.mark.parametrize("with_states", [True, False])
@pytest.mark.parametrize("edges", [(13,), (2, 6, 7, 13)])
def test_blocks_give_the_bits_of_the_search_at_once(with_states: bool, edges: tuple[int, ...]) -> None:
    whole = candidates(run_until(13, with_states=with_states))
    at_once = run_search(BOX, swarm, lambda o: one_sample_fitness(whole, o), 5, 0)
    fed = SampleSearch(swarm(BOX, np.random.default_rng([5, 0])))
    for edge in edges:
        fed.process(candidates(run_until(edge, with_states=with_states)))
    found = fed.finished(5)
    assert found.solution.history == at_once.solution.history
    assert found.solution.evaluations == at_once.solution.evaluations
    np.testing.assert_array_equal(found.trace, at_once.trace)
    np.testing.assert_array_equal(fed.best, at_once.solution.point)
    # spent after 8 iterations, tracked for 12 steps
    assert fed.step_count == len(fed.trace) == len(fed.tracked_states) == 12
    np.testing.assert_array_equal(fed.trace[7:], np.tile(fed.best, (5, 1)))


def test_a_record_whose_beginning_is_gone_goes_on_where_it_was() -> None:
    kept, cut = (SampleSearch(swarm(BOX, np.random.default_rng([5, 0]))) for _ in range(2))
    for fed in (kept, cut):
        fed.process(candidates(run_until(9)))
    kept.process(candidates(run_until(13)))
    cut.process(candidates(run_until(13, first=3)), first_step=3)
    np.testing.assert_array_equal(cut.trace, kept.trace)
    np.testing.assert_allclose(cut.tracked_states, kept.tracked_states, rtol=1e-12)
