"""Long records: decided on stretches, estimated on all samples by one step that loses nothing."""

import numpy as np
import pytest
from scipy.signal import lfilter

from seatrial.core.values import Record
from seatrial.estimation.estimate import fit
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.filtering import KalmanFilter

DT, ROWS, K, T = 0.2, 9000, 0.15, 8.0


def steered(gust: float) -> Record:
    """T r' + r = K (delta + w) with w first-order, memory 5 s; exact for forces constant over a step."""
    rng = np.random.default_rng(6)
    bits = np.repeat(rng.choice([-1.0, 1.0], ROWS // 20 + 1), 20)[:ROWS] * np.radians(4.0)
    delta = np.convolve(bits, np.ones(4) / 4.0, "same")
    keep, decay = np.exp(-DT / 5.0), np.exp(-DT / T)
    force = gust * lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(ROWS))
    turning = K * (0.5 * (delta[1:] + delta[:-1]) + 0.5 * (force[1:] + force[:-1]))
    r = np.concatenate([[0.0], lfilter([1.0 - decay], [1.0, -decay], turning)])
    psi = np.concatenate([[0.0], np.cumsum(0.5 * DT * (r[1:] + r[:-1]))])
    noise = np.radians([0.1, 0.2]) * rng.standard_normal((ROWS, 2))
    channels = {"delta": delta, "r": r + noise[:, 0], "psi": psi + noise[:, 1], "u": np.full(ROWS, 5.0)}
    return Record.from_arrays("run", DT * np.arange(ROWS), channels)


def estimated(record: Record) -> Estimation:
    return estimate_model(nomoto(), Runs.one_session_each([record], 50.0), options=EstimatorOptions(workers=1))


@pytest.mark.long
@pytest.mark.parametrize("gust", [0.0, np.radians(1.2)])
def test_one_step_from_stretches_is_the_estimate_of_all(gust: float, monkeypatch: pytest.MonkeyPatch) -> None:
    record = steered(gust)
    whole = estimated(record)
    monkeypatch.setattr(fit, "MOST_SAMPLES", 8000)
    monkeypatch.setattr(fit, "CHOICE_SAMPLES", 4500)
    monkeypatch.setattr(fit, "PIECE_SAMPLES", 3000)
    filtered = rows_filtered(monkeypatch)
    few = estimated(record)
    assert sum(rows >= ROWS for rows in filtered) <= 20 * few.estimate.problem.data.count
    assert few.noise_model.method == whole.noise_model.method
    assert "were chosen on 4500 of 9000 samples" in few.noise_model.text
    assert few.estimate.problem.data.count == (3 if gust else 1)
    error = whole.interval.standard_error[:2]
    np.testing.assert_allclose(few.interval.standard_error[:2], error, rtol=0.15)
    away = (few.estimate.common_parameters - whole.estimate.common_parameters)[:2] / error
    assert np.all(np.abs(away) < 0.3), away


def rows_filtered(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The samples of every batch that the Kalman filter passes a segment of, from now on."""
    passes: list[int] = []
    run = KalmanFilter._run

    def counted(self: KalmanFilter, *arguments, **keywords):
        passes.append(int(self.offsets[-1]))
        return run(self, *arguments, **keywords)

    monkeypatch.setattr(KalmanFilter, "_run", counted)
    return passes


def test_steps_over_growing_parts_lead_to_the_optimum_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three steps from 1000 of 9000 samples: a fourth one moves the coefficients by less than 0.2 standard errors."""
    limits = {"MOST_SAMPLES": 8000, "CHOICE_SAMPLES": 1000, "PIECE_SAMPLES": 3000, "_MOST_GROWTH": 2.5}
    for name, value in limits.items():
        monkeypatch.setattr(fit, name, value)
    few = estimated(steered(np.radians(1.2)))
    noise = few.process_noise
    assert noise is not None
    again = fit.newton_optimum(noise.problem, noise.optimum, 1.0)[0].solution.point
    moved = (again - noise.optimum.solution.point)[:2] / few.interval.standard_error[:2]
    assert np.all(np.abs(moved) < 0.2), moved


def test_short_records_are_taken_whole() -> None:
    record = steered(0.0)
    assert fit.choice_runs(Runs.one_session_each([record], 50.0)) is None


def test_stretches_of_a_run_keep_its_session(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fit, "MOST_SAMPLES", 8000)
    monkeypatch.setattr(fit, "CHOICE_SAMPLES", 3000)
    some = fit.choice_runs(Runs.one_session_each([steered(0.0)], 50.0))
    assert some is not None
    assert [len(r) for r in some.records] == [1000, 1000, 1000]
    assert set(some.sessions) == {"run"}
    assert some.records[0].time[0] == 0.0
    assert some.records[-1].time[-1] == pytest.approx(DT * (ROWS - 1))
