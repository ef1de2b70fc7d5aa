"""One implementation, not two: a user's search and a study's give the same bits for the same seed."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from tests.fits import example_fit

from seatrial.core.results import Prediction
from seatrial.core.results.published_method import Search
from seatrial.core.values import Array
from seatrial.data.trial import (
    EstimateMethod,
    EstimateSettings,
    Run,
    SearchFitness,
    SearchSettings,
    Trial,
    load_trial,
)
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.search import estimate_by_search, search_candidates, simulated_starts
from seatrial.estimation.search import run_search, whole_record_fitness
from seatrial.numerics.optimise import Box, FitnessMemory
from seatrial.physics.simulate import record_of
from seatrial.problems import centred_box
from seatrial_studies.heave_pitch_search import (
    STEP,
    PitchUnit,
    SearchData,
    one_sample_objective,
    repeat_searches,
    simulate_search_data,
    whole_record_objective,
)
from seatrial_studies.meng2014 import reproduction as meng
from seatrial_studies.qi2025 import reproduction as qi
from seatrial_studies.qi2025.published import SearchAlgorithm
from seatrial_studies.seaway import SHIP

SEED, RESTARTS, ITERATIONS = 4, 2, 12
DEGREES = {"z": 1.0, "theta": PitchUnit.DEGREES.value}


def user_trial(data: SearchData, method: EstimateMethod, box: Box, fitness: SearchFitness) -> Trial:
    """The study's sea as a user would hand it in: forces and all states recorded, heave and pitch compared."""
    names = data.model.parameters.free_names
    bounds = {n: (float(a), float(b)) for n, a, b in zip(names, box.lower, box.upper, strict=True)}
    search = SearchSettings(iterations=ITERATIONS, restarts=RESTARTS, fitness=fitness, bounds=bounds)
    settings = EstimateSettings(method=method, search=search, channels=("z", "theta"))
    return Trial(SHIP, (Run(sea_record(data)),), data.model, noise=DEGREES, estimate=settings)


def sea_record(data: SearchData):
    time, states = STEP * np.arange(len(data.states)), data.states.copy()
    states[:, [0, 2]] = data.measured
    inputs = np.zeros((len(states), 4))
    inputs[:, :2] = data.forces
    outputs = np.empty((len(states), len(data.model.outputs)))
    return record_of(data.model, "sea", time, states, outputs, inputs)


def values_of(search: Search) -> Array:
    return np.array([list(restart.values.values()) for restart in search.restarts])


@pytest.mark.parametrize("algorithm", list(SearchAlgorithm))
def test_sample_by_sample_the_searches_of_qi2025_are_the_users(algorithm: SearchAlgorithm) -> None:
    data = simulate_search_data(135, np.random.default_rng(1), samples=60)
    box = centred_box(data.truth, 0.1)
    fit = identify(user_trial(data, EstimateMethod(algorithm.value.lower()), box, SearchFitness.SAMPLE), seed=SEED)
    create = qi.optimisers(ITERATIONS, FitnessMemory.RE_EVALUATE)[algorithm]
    study = repeat_searches([data] * RESTARTS, [box] * RESTARTS, create, one_sample_objective, SEED)
    assert fit.search is not None
    assert [one.evaluations for one in fit.search.restarts] == list(study.evaluations)
    assert fit.search.history == tuple(study.best_fitness)
    np.testing.assert_array_equal(np.array(list(fit.search.trace.values())).T, study.trace)
    np.testing.assert_array_equal(values_of(fit.search), study.points)
    np.testing.assert_array_equal(list(fit.search.scatter.values()), np.std(study.points, axis=0, ddof=1))


def test_over_the_whole_record_the_search_of_meng2014_is_the_users() -> None:
    data = simulate_search_data(135, np.random.default_rng(1), samples=60, has_fin=True, noise=meng.NOISE)
    box = centred_box(data.truth, 0.5)
    record = sea_record(data)
    from_rest = Prediction(
        "sea", "training", record, sea_record(replace(data, measured=data.states[:, [0, 2]])), {}, {}, 0
    )
    trial = user_trial(data, EstimateMethod.ICPSO, box, SearchFitness.RECORD)
    candidates = search_candidates(trial, data.model, [record], simulated_starts(data.model, [from_rest]))
    points = box.random_points(np.random.default_rng(0), 5)
    np.testing.assert_array_equal(candidates.record_rms(points), whole_record_objective(data)(points))
    create = meng.optimisers(ITERATIONS)[meng.SwarmAlgorithm.ICPSO]
    user = [run_search(box, create, lambda _: whole_record_fitness(candidates), SEED, k) for k in range(RESTARTS)]
    study = repeat_searches([data] * RESTARTS, [box] * RESTARTS, create, lambda d, _: whole_record_objective(d), SEED)
    assert user[0].solution.history == tuple(study.best_fitness)
    np.testing.assert_array_equal([one.solution.point for one in user], study.points)
    assert [one.solution.evaluations for one in user] == list(study.evaluations)


@pytest.mark.parametrize("method", [EstimateMethod.IWHO, EstimateMethod.ICPSO])
def test_on_the_shipped_example_the_loop_of_the_studies_gives_the_users_bits(
    repository: Path, method: EstimateMethod
) -> None:
    trial = load_trial(repository / "examples" / "heave_pitch.toml")
    search = SearchSettings(iterations=ITERATIONS, restarts=RESTARTS)
    trial, own = replace(trial, estimate=EstimateSettings(method=method, search=search)), example_fit("heave_pitch")
    runs = [p for p in own.predictions if p.role == "training"]
    records, starts = [p.measured for p in runs], simulated_starts(trial.model, runs)
    user = estimate_by_search(trial, records, starts, SEED).search
    assert user is not None
    candidates = search_candidates(trial, trial.model, records, starts)
    box = Box(*np.array(list(user.bounds.values())).T)
    if method is EstimateMethod.IWHO:
        create = qi.optimisers(ITERATIONS, FitnessMemory.KEEP)[SearchAlgorithm.IWHO]
    else:
        create = meng.optimisers(ITERATIONS)[meng.SwarmAlgorithm.ICPSO]
    sea = simulate_search_data(135, np.random.default_rng(1), samples=3)
    study = repeat_searches(
        [sea] * RESTARTS, [box] * RESTARTS, create, partial(lambda *_, c: whole_record_fitness(c), c=candidates), SEED
    )
    best = user.restarts[0]
    assert best.history == tuple(study.best_fitness)
    assert [one.evaluations for one in user.restarts] == list(study.evaluations)
    np.testing.assert_array_equal(values_of(user), study.points)
    np.testing.assert_array_equal(list(user.scatter.values()), np.std(study.points, axis=0, ddof=1))
