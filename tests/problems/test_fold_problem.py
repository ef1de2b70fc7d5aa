"""A session left out: it is in no trial, its error is that of the coefficients alone, the truth predicts it best."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Ship
from seatrial.data.example_series import SENSOR_NOISE, simulate_run, true_model, with_sensor_noise
from seatrial.data.trial import EstimateSettings, Role, Run, Trial, TrialRecord
from seatrial.estimation.predict import HoldoutProtocol
from seatrial.problems import attempt, built_in_methods, fold_draw
from seatrial.problems.problem import BenchmarkProblem

PROTOCOL = HoldoutProtocol(20.0, 2.0)
RUNS = {"a": "zigzag:20/20", "b": "zigzag:10/10", "c": "turning-circle:25"}


@pytest.fixture(scope="module")
def items() -> list[TrialRecord]:
    rng = np.random.default_rng(5)
    records = {name: with_sensor_noise(simulate_run(true_model(), text), rng, 0) for name, text in RUNS.items()}
    return [TrialRecord(replace(record, name=name), Role.TRAIN, name) for name, record in records.items()]


@pytest.fixture(scope="module")
def trial(items: list[TrialRecord]) -> Trial:
    runs = tuple(Run(item.record, session=item.session) for item in items)
    ship = Ship("craft", {"L": 9.8, "d": 0.71, "m": 5540.0})
    return Trial(ship, runs, true_model(), EstimateSettings(segment_s=20.0), dict(SENSOR_NOISE))


def test_the_session_left_out_is_in_no_trial_and_every_one_takes_its_turn(
    trial: Trial, items: list[TrialRecord]
) -> None:
    absent = set()
    for seed in range(12):
        draw = fold_draw(trial, items, PROTOCOL, np.random.default_rng(seed))
        assert draw.trial is not None
        (left_out,) = set(RUNS) - {run.name for run in draw.trial.runs}
        absent.add(left_out)
    assert absent == set(RUNS)


def test_the_truth_predicts_what_was_left_out_and_other_coefficients_do_not(
    trial: Trial, items: list[TrialRecord]
) -> None:
    draw = fold_draw(trial, items, PROTOCOL, np.random.default_rng(0))
    truth = np.array([p.value for p in trial.model.parameters.free])
    assert draw.yardstick.error(truth) < 0.2 < draw.yardstick.success_limit  # noise of the initial states
    assert draw.yardstick.error(0.2 * truth) > 1.5 * draw.yardstick.error(truth)
    assert draw.yardstick.truth is None and "constant course" in draw.yardstick.unit
    assert np.all((truth >= draw.box.lower) & (truth <= draw.box.upper))
    assert draw.fitness(truth[None], 0)[0] < draw.fitness(0.2 * truth[None], 0)[0]


def test_methods_are_entered_against_it(trial: Trial, items: list[TrialRecord]) -> None:
    problem = BenchmarkProblem("craft-folds", 1, "", "", "", 60, lambda rng, _: fold_draw(trial, items, PROTOCOL, rng))
    answer = attempt(built_in_methods()["output-error"], problem, 0)
    truth = np.array([p.value for p in trial.model.parameters.free])
    stick = problem.draw(0).yardstick
    assert stick.error(answer.values) < 1.1 * stick.error(truth)
