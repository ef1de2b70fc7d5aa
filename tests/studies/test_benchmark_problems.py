"""The papers' problems and measured trials as benchmark problems: truth inside the box, bound reached, folds."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.identify import identify
from seatrial.numerics.optimise import Box
from seatrial.problems import (
    BenchmarkProblem,
    KnownTruth,
    Placement,
    attempt,
    built_in_methods,
    standard_errors_within,
)
from seatrial_studies import benchmark_problems
from seatrial_studies.benchmark_problems import meng2014_problems, qi2025_problems, yu2014_problems

# The papers' problems: truth inside the box and off its middle, bound reached by the own estimator.

PROBLEMS = {p.name: p for p in (*qi2025_problems(), *meng2014_problems(), *yu2014_problems())}
WITH_TRUTH = [p for p in PROBLEMS.values() if not p.name.startswith("yu2014")]


def test_names_versions_sources_and_budgets_are_stated() -> None:
    assert len(PROBLEMS) == 15
    for problem in PROBLEMS.values():
        assert problem.title and problem.source and problem.noise and problem.budget > 1000
        assert problem.version == (1 if problem.name.startswith("yu2014") else 2)


@pytest.mark.parametrize("problem", WITH_TRUTH, ids=lambda p: p.name)
def test_the_truth_lies_in_the_box_off_its_middle_and_moves_with_the_seed(problem: BenchmarkProblem) -> None:
    places = []
    for seed in range(4):
        draw = problem.draw(seed)
        truth = draw.yardstick.truth
        assert truth is not None and np.all((truth > draw.box.lower) & (truth < draw.box.upper))
        places.append((truth - draw.box.lower) / draw.box.width)
    assert np.std(places) > 0.1
    assert problem.draw(0).yardstick.truth.tobytes() == problem.draw(0).yardstick.truth.tobytes()  # type: ignore[union-attr]


@pytest.mark.parametrize("heading", [90, 135, 180])
def test_as_published_the_truth_is_the_papers_in_the_middle_of_its_box(heading: int) -> None:
    draw = PROBLEMS[f"qi2025-{heading}-paper"].draw(0, Placement.PUBLISHED)
    assert isinstance(draw.yardstick, KnownTruth)
    np.testing.assert_allclose(0.5 * (draw.box.lower + draw.box.upper), draw.yardstick.truth)
    assert float(np.max(np.abs(draw.box.width / draw.yardstick.truth))) == pytest.approx(0.2)


@pytest.mark.parametrize(
    "name", ["qi2025-90-whole", "qi2025-135-whole", "qi2025-180-whole", "meng2014-8", "meng2014-12"]
)
def test_the_own_estimator_is_at_the_bound(name: str) -> None:
    problem, own = PROBLEMS[name], built_in_methods()["output-error"]
    seeds = range(40)
    errors = [problem.draw(seed).yardstick.error(attempt(own, problem, seed).values) for seed in seeds]
    assert 0.8 < np.sqrt(np.mean(np.square(errors))) < 1.2


@pytest.mark.parametrize(
    ("name", "seed"),
    [
        # white residuals whose correlation looks large by chance
        ("qi2025-135-whole", 4),
        ("meng2014-8", 7),
        # a start far off, and one from which output error ends in another optimum
        ("meng2014-8", 9),
        ("meng2014-8", 15),
        # the largest of thirty
        ("qi2025-180-whole", 4),
        ("meng2014-12", 3),
    ],
)
def test_identify_is_at_the_bound_and_inside_the_box(name: str, seed: int) -> None:
    problem = PROBLEMS[name]
    draw, answer = problem.draw(seed), attempt(built_in_methods()["identify"], problem, seed)
    assert draw.yardstick.error(answer.values) < 2.3 and answer.covariance is not None
    assert np.all((answer.values >= draw.box.lower) & (answer.values <= draw.box.upper))


@pytest.mark.long(every=2)
@pytest.mark.parametrize(
    "method",
    [EstimateMethod.AUTO, EstimateMethod.OUTPUT_ERROR, EstimateMethod.MULTIPLE_SHOOTING,
     EstimateMethod.PREDICTION_ERROR],
)  # fmt: skip
def test_bounds_that_exclude_the_truth_hold_whatever_the_criterion(method: EstimateMethod) -> None:
    draw = PROBLEMS["qi2025-135-whole"].draw(1)
    assert draw.trial is not None and draw.yardstick.truth is not None
    trial, upper = draw.trial, 0.9 * float(draw.yardstick.truth[0])
    model = trial.model.with_parameters(trial.model.parameters.bounded("a33", 0.0, upper))
    fit = identify(replace(trial, model=model, estimate=EstimateSettings(method=method)))
    assert all(p.lower <= p.value <= p.upper for p in fit.model.parameters.free)
    assert any(f.code == "bound-hit" for f in fit.findings)


def test_a_bound_beyond_the_box_counts_the_box() -> None:
    box, nothing = Box(np.zeros(2), np.array([1.0, 2.0])), np.zeros((2, 2))
    np.testing.assert_allclose(standard_errors_within(nothing, box), box.width / np.sqrt(12.0))
    sure = np.diag([1e8, 1e6])
    np.testing.assert_allclose(standard_errors_within(sure, box), [1e-4, 1e-3], rtol=1e-4)


def test_the_trial_of_a_problem_states_its_box_and_starts_inside() -> None:
    draw = PROBLEMS["meng2014-12"].draw(2)
    assert draw.trial is not None
    for parameter, lower, upper in zip(draw.trial.model.parameters.free, draw.box.lower, draw.box.upper, strict=True):
        assert (parameter.lower, parameter.upper) == (lower, upper) and lower <= parameter.value <= upper


def test_without_noise_the_whole_of_the_record_gives_the_truth() -> None:
    problem = PROBLEMS["qi2025-135-paper"]
    answer = attempt(built_in_methods()["output-error"], problem, 0)
    assert problem.draw(0).yardstick.error(answer.values) < 1e-6


def test_gains_are_scaled_by_the_seed_and_the_least_objective_stays() -> None:
    problem = PROBLEMS["yu2014-3-washout"]
    answer = attempt(built_in_methods()["de"], problem, 0)
    assert problem.draw(0).yardstick.error(answer.values) < 1.0
    assert problem.draw(1).yardstick.error(answer.values) > problem.draw(0).yardstick.error(answer.values)
    wild = np.array([1.0, 1.0, 1e6])
    assert problem.draw(0).yardstick.error(wild) == np.inf


# Folds of measured trials, where the records are; a plain reason where they are not.


def test_a_fold_of_the_blueboat_repeats_itself(monkeypatch: pytest.MonkeyPatch, data_folder: Path) -> None:
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder))
    (problem,) = benchmark_problems.blueboat_problems()
    draw, again = problem.draw(1), problem.draw(1)
    assert draw.start is not None and draw.trial is not None and again.trial is not None
    assert [run.name for run in draw.trial.runs] == [run.name for run in again.trial.runs]
    assert 0.0 < draw.yardstick.error(draw.start) < 3.0
    assert np.isfinite(draw.fitness(draw.start[None], 0)[0])


@pytest.mark.parametrize("make", [benchmark_problems.kvlcc2_problems, benchmark_problems.esso_osaka_problems])
def test_the_others_are_there_too(monkeypatch: pytest.MonkeyPatch, data_folder: Path, make: object) -> None:
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder))
    (problem,) = make()  # type: ignore[operator]
    assert problem.budget > 0 and problem.title


def test_without_the_records_the_reason_is_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SEATRIAL_DATA", raising=False)
    with pytest.raises(InputError, match="SEATRIAL_DATA is not set; set it to their folder"):
        benchmark_problems.kvlcc2_problems()
