"""Offsets of sessions in predictions, and errors some samples ahead."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter
from tests.estimation.estimate.test_large_records import steered

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record, Ship
from seatrial.data.trial import EstimateSettings, Role, Run, Trial
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs, estimate_model
from seatrial.estimation.identify import identify
from seatrial.estimation.predict.session_offsets import (
    Horizon,
    horizon_list,
    new_session_offsets,
    offsets_without,
    session_offsets,
    updated_by_start,
)
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.estimation.problem.segments import cut_segments
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


Array = NDArray[np.float64]
K, T, DT, ROWS = 0.15, 8.0, 0.2, 20000
Q, NOISE = np.radians(0.3), np.radians(0.2)  # rad/s over the root of a second, rad/s
KEEP = np.exp(-DT / T)


def record_of(seed: int = 3) -> Record:
    """T r' + r = K delta and white noise on r', exact for a rudder that is straight between samples."""
    rng = np.random.default_rng(seed)
    delta = np.convolve(np.repeat(rng.choice([-0.1, 0.1], ROWS // 25), 25), np.ones(5) / 5.0, "same")
    ramp = T / DT * (1.0 - KEEP) - KEEP, 1.0 - T / DT * (1.0 - KEEP)  # weights of a straight input (first-order hold)
    force = K * (ramp[0] * delta[:-1] + ramp[1] * delta[1:])
    shock = Q * np.sqrt(0.5 * T * (1.0 - KEEP**2)) * rng.standard_normal(ROWS - 1)
    r = np.concatenate([[0.0], lfilter([1.0], [1.0, -KEEP], force + shock)])
    channels = {"delta": delta, "r": r + NOISE * rng.standard_normal(ROWS), "u": np.full(ROWS, 5.0)}
    return Record.from_arrays("run", DT * np.arange(ROWS), channels)


def filter_of(record: Record) -> tuple[PredictionError, Array]:
    """The filter with the true noise, at the true coefficients."""
    model = nomoto().with_values({"K": K, "T": T})
    runs = OutputError(model, cut_segments(model, [record], ("r",), None), np.array([NOISE]), workers=1)
    start = np.zeros((1, len(model.states)))
    problem = PredictionError(runs, ("r",), start, start + NOISE**2, np.array([np.nan]))
    return problem, np.concatenate([runs.start(), [Q**2, NOISE**2]])


def steady_variance() -> float:
    """Variance of r after a sample, of the steady Kalman filter (discrete algebraic Riccati equation, scalar)."""
    process, after = 0.5 * Q**2 * T * (1.0 - KEEP**2), NOISE**2
    for _ in range(1000):
        before = KEEP**2 * after + process
        after = before * NOISE**2 / (before + NOISE**2)
    return after


def test_k_step_variance_is_that_of_the_closed_form() -> None:
    """P(k) = a^2k P + q^2 T / 2 (1 - a^2k) + R; errors k samples ahead are correlated over k of them."""
    record = record_of()
    problem, point = filter_of(record)
    origins = np.arange(200, ROWS - 101, 4)
    ahead = problem.predicted_ahead(point, 0, origins, 100)[:, :, 0]
    for k in (1, 5, 20, 100):
        errors = ahead[:, k] - record["r"][origins + k]
        keep = KEEP ** (2 * k)
        expected = keep * steady_variance() + 0.5 * Q**2 * T * (1.0 - keep) + NOISE**2
        scatter = np.sqrt(2.0 * max(k / 4.0, 1.0) / len(origins))
        assert np.mean(errors**2) == pytest.approx(expected, rel=4.0 * scatter)


def test_predictions_are_those_of_a_discrete_predictor() -> None:
    """An independent filter with the same splitting of the noise, its transitions exact."""
    record = record_of(4).rows(slice(0, 400))
    problem, point = filter_of(record)
    delta, y = record["delta"], record["r"]
    step = T / DT * (1.0 - KEEP)
    force = K * ((step - KEEP) * delta[:-1] + (1.0 - step) * delta[1:])
    origins, horizon = np.array([50, 200, 380]), 15
    filtered, r, p = [], 0.0, NOISE**2
    for n in range(len(y)):
        gain = p / (p + NOISE**2)
        r, p = r + gain * (y[n] - r), (1.0 - gain) * p
        filtered.append(r)
        if n < len(force):
            r, p = KEEP * r + force[n], KEEP**2 * (p + 0.5 * Q**2 * DT) + 0.5 * Q**2 * DT
    ahead = problem.predicted_ahead(point, 0, origins, horizon)[:, :, 0]
    for row, origin in enumerate(origins):
        r = filtered[origin]
        for k in range(horizon + 1):
            assert ahead[row, k] == pytest.approx(r, abs=1e-9)
            r = KEEP * r + force[origin + k] if origin + k < len(force) else r


def test_one_sample_ahead_is_the_innovation() -> None:
    record = record_of(5).rows(slice(0, 300))
    problem, point = filter_of(record)
    origins = np.arange(0, 299)
    ahead = problem.predicted_ahead(point, 0, origins, 1)[:, 1, 0]
    np.testing.assert_allclose(record["r"][1:] - ahead, problem.innovations(point).e[1:, 0], atol=1e-13)


def test_horizons_are_samples_or_seconds() -> None:
    assert horizon_list("1, 10,5s") == (Horizon(1.0, is_seconds=False), Horizon(10.0, is_seconds=False),
                                        Horizon(5.0, is_seconds=True))  # fmt: skip
    assert [h.steps(0.2) for h in horizon_list("1,10,5s,0.01s")] == [1, 10, 25, 1]
    for text in ("0", "1.5", "5 m", "-3s"):
        with pytest.raises(InputError, match="write samples or seconds"):
            horizon_list(text)


def test_a_fit_has_the_errors_of_its_own_disturbance() -> None:
    """In gusts of 5 s the error grows with the horizon to that of a simulation, below that of the last value held."""
    record = steered(np.radians(1.2))
    runs = [record.rows(slice(a, a + 1500)).renamed(f"from row {a}") for a in (0, 1500, 3000)]
    roles = (Role.TRAIN, Role.TRAIN, Role.VALIDATE)
    trial = Trial(Ship("craft", {"L": 50.0}), tuple(map(Run, runs, roles)), nomoto())
    fit = identify(trial, horizons="1,5s,60s")
    held = {e.channel: e for e in fit.k_step_errors if e.role == "validation"}
    assert held["r"].steps == (1, 25, 300)
    assert {e.role for e in fit.k_step_errors} == {"training", "validation"}
    assert list(held["r"].rms) == sorted(held["r"].rms)
    assert all(a < b for a, b in zip(held["r"].rms, held["r"].held_rms, strict=True))
    assert held["r"].rms[-1] == pytest.approx(fit.validation[0].rms["r"], rel=0.15)
    assert held["r"].rms[0] == pytest.approx(np.radians(0.1), rel=0.2)
    assert fit.frequency_responses[0].output == "r"
