"""What a run has of its own: its session's estimate, or the population's expectation."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs, estimate_model
from seatrial.estimation.predict.session_offsets import (
    new_session_offsets,
    offsets_without,
    session_offsets,
    updated_by_start,
)
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.steer import manoeuvre

ZEROS = np.radians([1.3, 0.8, 1.1, 0.9, 1.4])
SETTINGS = EstimateSettings(method="output-error", offsets={"delta": np.radians(2.0)}, delays={"delta": 0.0})
OPTIONS = EstimatorOptions(workers=1)


@pytest.fixture(scope="module")
def truth() -> Model:
    return nomoto().with_values({"K": 0.15, "T": 8.0, "U": 1.0})


@pytest.fixture(scope="module")
def records(truth: Model) -> list[Record]:
    """Zigzags whose recorded rudder angle lacks the zero of their session."""
    runs = [
        manoeuvre(truth, programme(f"zigzag:{10 + 4 * i}/10"), dt=0.5, speed=1.0, duration=90.0).renamed(f"run_{i}")
        for i in range(len(ZEROS))
    ]
    zeros = zip(runs, ZEROS, strict=True)
    return [r.with_channel("delta", r.channel("delta").with_values(r["delta"] - zero)) for r, zero in zeros]


@pytest.fixture(scope="module")
def estimation(truth: Model, records: list[Record]) -> Estimation:
    start = truth.with_values({"K": 0.1, "T": 10.0})
    return estimate_model(start, Runs.one_session_each(records, 7.0), SETTINGS, OPTIONS)


def test_a_session_that_was_fitted_has_its_own_offset(estimation: Estimation, records: list[Record]) -> None:
    for record, zero in zip(records, ZEROS, strict=True):
        own = session_offsets(estimation, record.name, record)
        assert own.expected[0] == pytest.approx(zero, abs=2e-4)
        assert own.covariance[0, 0] < new_session_offsets(estimation.estimate, record).covariance[0, 0]


def test_a_new_session_has_mean_and_spread_of_the_others(estimation: Estimation, records: list[Record]) -> None:
    new = session_offsets(estimation, "another day", records[0])
    assert new.expected[0] == pytest.approx(ZEROS.mean(), rel=0.02)
    # the prior keeps the deviation above the sample's, and the mean's own error is added
    assert 1.0 < np.sqrt(new.covariance[0, 0]) / np.std(ZEROS, ddof=1) < 1.6


def test_a_run_left_out_is_expected_as_the_others_are(estimation: Estimation, records: list[Record]) -> None:
    problem, point = estimation.estimate.problem, estimation.estimate.common_parameters
    expected = offsets_without(problem, point, "run_0", records[0])
    assert expected[0] == pytest.approx(ZEROS[1:].mean(), abs=2e-4)
    alone = replace(problem, data=problem.data.selected(problem.data.run_segments(0)))
    assert len(offsets_without(alone, point, "run_0", records[0])) == 1


def test_a_mean_that_follows_the_helm(truth: Model, records: list[Record]) -> None:
    """Zeros on a line over the rms of the rudder angle leave next to nothing between sessions."""
    helm = np.array([np.sqrt(np.mean(r["delta"] ** 2)) for r in records])
    zeros = 0.03 - 0.1 * (helm - helm.mean())
    recorded = [
        r.with_channel("delta", r.channel("delta").with_values(r["delta"] + own - zero))
        for r, own, zero in zip(records, ZEROS, zeros, strict=True)
    ]
    settings = replace(SETTINGS, covariates={"delta": "delta"})
    fit = estimate_model(truth, Runs.one_session_each(recorded, 7.0), settings, OPTIONS)
    expected = [new_session_offsets(fit.estimate, r).expected[0] for r in recorded]
    np.testing.assert_allclose(expected, zeros, atol=2e-3)
    assert np.ptp(expected) > 0.5 * np.ptp(zeros)


def test_a_covariate_that_is_no_input_is_refused(truth: Model, records: list[Record]) -> None:
    runs = Runs.one_session_each(records, 7.0)
    with pytest.raises(InputError, match="'wind' is no input of model 'nomoto'; name one of delta"):
        estimate_model(truth, runs, replace(SETTINGS, covariates={"delta": "wind"}), OPTIONS)
    with pytest.raises(InputError, match="'n' is not under offsets"):
        replace(SETTINGS, covariates={"n": "delta"})


def test_the_first_seconds_of_a_run_move_the_expectation_towards_its_own_offset(
    estimation: Estimation, records: list[Record]
) -> None:
    new = session_offsets(estimation, "another day", records[0])
    problem, model = estimation.estimate.problem, estimation.model
    few, many = (updated_by_start(problem, model, new, records[0], seconds) for seconds in (5.0, 80.0))
    before, after, last = (abs(o.expected[0] - ZEROS[0]) for o in (new, few, many))
    assert last < 0.1 * before
    assert last < after < before
    assert many.covariance[0, 0] < few.covariance[0, 0] < new.covariance[0, 0]


def test_a_start_that_says_nothing_leaves_the_population(estimation: Estimation, records: list[Record]) -> None:
    new = session_offsets(estimation, "another day", records[0])
    blind = replace(estimation.estimate.problem, noise=np.full(len(estimation.estimate.problem.noise), 1e6))
    same = updated_by_start(blind, estimation.model, new, records[0], 5.0)
    np.testing.assert_allclose(same.expected, new.expected, rtol=1e-6)
    np.testing.assert_allclose(same.covariance, new.covariance, rtol=1e-6)
