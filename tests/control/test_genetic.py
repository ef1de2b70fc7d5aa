"""The published search on a task: that of the study, bit for bit; its answer, its cost and its scatter."""

from dataclasses import replace

import numpy as np
import pytest
from tests.control.fin_tasks import LIMITS, PAPER_OBJECTIVES
from tests.control.fin_tasks import sampled_fin_task as fin_task

from seatrial.control import (
    GeneticTuning,
    SearchedObjectives,
    gain_evaluator,
    genetic_run,
    genetic_runs,
    pareto_front,
)
from seatrial.control.front import Effort, published_search, searched_objectives
from seatrial.control.tune import tune
from seatrial.core.results.tuning import ControllerConstraints, TuningMethod
from seatrial.core.values import InputError
from seatrial.numerics.optimise import Box, GeneticSettings, Normaliser
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.published import performance
from seatrial_studies.yu2014.searches import GeneticSearchSetting, search_over_seeds

SMALL = GeneticTuning(population=20, generations=10, seeds=3)
TINY = Effort(refined=4, fill_rounds=2, neighbours=2000)


def test_the_search_is_that_of_the_study_bit_for_bit() -> None:
    of = performance(Preamplifier.WASHOUT)
    task = fin_task(objectives=PAPER_OBJECTIVES)
    (seaway,) = task.disturbances
    task = replace(task, loop=of.loop, disturbances=(replace(seaway, U=18.0 * 1852.0 / 3600.0),))
    own = GeneticTuning(objectives=SearchedObjectives.OWN, seeds=2)
    found = genetic_runs(gain_evaluator(task), own, seed=3)
    study = search_over_seeds(GeneticSearchSetting(Preamplifier.WASHOUT), 2, 3)
    assert np.stack([run.gains for run in found]).tobytes() == study.gains.tobytes()
    assert all(run.evaluations == 10_000 for run in found)


def test_objectives_are_those_printed_one_sided_or_the_tasks() -> None:
    evaluator = gain_evaluator(fin_task())
    printed, one_sided, own = (
        searched_objectives(evaluator, GeneticTuning(objectives=kind)) for kind in SearchedObjectives
    )
    quiet = np.full((1, 1), 0.01 * evaluator.allowed_variances[0])
    assert [one.name for one in printed] == ["J1", "J2", "J3"]
    assert printed[1].value(quiet)[0] > 0.0 == one_sided[1].value(quiet)[0]
    assert own == evaluator.objectives


def test_values_without_the_sensitivity_peak_are_those_with_it() -> None:
    evaluator = gain_evaluator(fin_task())
    gains = np.array([[11.0, 0.4, 33.0], [90.0, 40.0, 5.0], [0.0, 0.0, 0.0]])
    assert np.array_equal(evaluator.objective_values(gains), evaluator.evaluate(gains).objectives)


def test_the_answer_is_compared_with_the_front() -> None:
    evaluator = gain_evaluator(fin_task())
    front = pareto_front(evaluator, "3 gains", 0, lambda _: None, TINY)
    made = published_search(evaluator, SMALL, front, 1)
    assert np.array_equal(made.choice.gains, made.result.gains[0])
    assert made.result.histories.shape == (3, 10) and made.result.history == tuple(made.result.histories[0])
    assert np.array_equal(made.result.spread, np.ptp(made.result.gains, axis=0) / [100.0, 50.0, 100.0])
    beaten = [(front.objectives < row).all(axis=1).any() for row in made.result.values]
    assert made.result.dominated == sum(beaten)
    assert evaluator.evaluate(made.front.gains).is_feasible.all()
    assert 0.0 <= made.result.hypervolume < 1.01


def test_tuning_by_the_method_keeps_the_own_choice_beside_it() -> None:
    task = replace(fin_task(), genetic=SMALL)
    own, made = (tune(task, effort=TINY, method=kind) for kind in TuningMethod)
    assert own.search is None and own.reference is None and own.compared[0].gains == own.chosen.gains
    assert made.reference is not None and made.reference.gains == own.chosen.gains
    assert made.search is not None
    assert list(made.chosen.gains.values()) == made.search.gains[0].tolist()
    assert [front.name for front in made.extended_fronts] == ["the genetic algorithm"]
    assert made.solution.evaluations == made.search.evaluations == 200
    assert any("genetic algorithm of Yu et al. 2014" in reason for reason in made.reasons)
    named = "compared with 'own front' (the package's choice from its own front)"
    assert any(named in reason for reason in made.reasons)
    for finding in made.findings:
        if finding.code in ("breaks-limits", "lost-to-limits"):
            assert "run without --method" in finding.advice


def test_only_free_gains_are_searched() -> None:
    task = fin_task()
    fixed = replace(task.loop, gains=task.loop.gains.fixed("KI"))
    run, *_ = genetic_runs(gain_evaluator(replace(task, loop=fixed)), SMALL, 0)
    assert run.gains.shape == (2,)


def test_a_search_of_anything_is_the_same_search() -> None:
    run = genetic_run(
        lambda points: np.abs(points - [0.3, 0.6]), Box(np.zeros(2), np.ones(2)),
        GeneticSettings(objectives=2, generations=40), np.random.default_rng(0),
    )  # fmt: skip
    assert run.gains == pytest.approx([0.3, 0.6], abs=0.05)
    assert len(run.history) == 40 and run.evaluations == 2000


def test_an_actuator_without_limit_has_no_published_objective() -> None:
    evaluator = gain_evaluator(fin_task(restriction=ControllerConstraints()))
    with pytest.raises(InputError, match=r"needs its limit; give \[actuator\] limit"):
        genetic_runs(evaluator, SMALL, 0)


def test_a_search_that_meets_no_stable_loop_says_so() -> None:
    task = fin_task(Preamplifier.PRINTED, restriction=LIMITS)
    gains = task.loop.gains.bounded("KD", 90_000.0, 100_000.0).bounded("KP", 90_000.0, 100_000.0)
    with pytest.raises(InputError, match="met no stable loop in 200 controllers"):
        genetic_runs(gain_evaluator(replace(task, loop=replace(task.loop, gains=gains))), SMALL, 0)


def test_settings_it_cannot_work_with_are_one_sentence() -> None:
    assert GeneticTuning(normaliser=Normaliser.BEST).algorithm_settings(3).normaliser is Normaliser.BEST
    with pytest.raises(InputError, match="population"):
        GeneticTuning(population=2)
    with pytest.raises(InputError, match="crossover"):
        GeneticTuning(crossover=1.2)
    many = GeneticTuning(population=5, objectives=SearchedObjectives.OWN)
    evaluator = gain_evaluator(fin_task(objectives=(*PAPER_OBJECTIVES, *PAPER_OBJECTIVES[:1])))
    with pytest.raises(InputError, match="genetic: A genetic algorithm needs at least 6 individuals"):
        genetic_runs(evaluator, many, 0)
