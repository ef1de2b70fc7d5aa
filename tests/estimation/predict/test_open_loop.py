"""Open-loop predictions, their errors and measures, and where they diverge."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.conftest import NOISE, TRUTH, square, steered

from seatrial.core.equations import Sheet
from seatrial.core.results import Fit
from seatrial.core.values import InputError, Record, Ship
from seatrial.data.folder.result_folder import load_fit, save_result
from seatrial.data.trial import EstimateSettings, Role, Run, Trial
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.settings import ship_length_seconds
from seatrial.estimation.identify import estimate_model, identify
from seatrial.estimation.predict.open_loop import divergence_of, predict_run, simulate_open_loop
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import replay
from seatrial.physics.simulate.replay import first_row_outside, inputs_of, trajectory
from seatrial.reporting.verdict import verdict


def test_a_model_of_yaw_rate_alone_is_predicted_without_measures(rng: np.random.Generator) -> None:
    sheet = Sheet("yaw_rate")
    (r,) = sheet.states("r")
    delta = sheet.input("delta")
    T = sheet.parameter("T", 8.0, "s", free=True, lower=0.1, upper=100.0)
    K = sheet.parameter("K", 0.2, "1/s", free=True)
    sheet.rate(r, (K * delta - r) / T)
    model = sheet.model()
    time = 0.2 * np.arange(1500)
    rudder = 0.2 * np.sign(np.sin(0.1 * time))
    truth = replay(model, Record.from_arrays("run", time, {"delta": rudder, "u": np.ones(1500)}), {"r": 0.0})
    noisy = truth["r"] + 1e-3 * rng.standard_normal(1500)
    record = Record.from_arrays("run", time, {"r": noisy, "delta": rudder, "u": np.ones(1500)})
    settings = EstimateSettings().with_known_timing(model.input_names)
    found = estimate_model(model.with_values({"T": 3.0, "K": 0.1}), Runs.one_session_each([record], 10.0), settings)
    run = simulate_open_loop(
        found.estimate.problem,
        found.model,
        record,
        np.empty(0),
        10.0,
    )
    made = predict_run(found.model, record, "validation", run, 10.0, 10.0)
    assert made.measures == {}
    assert set(made.rms) == {"r"}
    assert made.rms["r"] < 1.1e-3


def test_records_without_speed_take_their_time_scale_from_the_segments(rng: np.random.Generator) -> None:
    time = 0.2 * np.arange(100)
    silent = Record.from_arrays("run", time, {"r": rng.standard_normal(100)})
    assert ship_length_seconds([silent], 10.0, 15.0) == 10.0
    for length in (None, np.inf):
        with pytest.raises(InputError, match="no forward speed"):
            ship_length_seconds([silent], 10.0, length)


def test_positions_that_stay_for_most_rows_show_a_speed() -> None:
    time = 0.2 * np.arange(500)
    places = {"x0": np.floor(1.5 * time), "y0": np.zeros(500)}  # 1.5 m/s in whole metres
    assert 10.0 / ship_length_seconds([Record.from_arrays("run", time, places)], 10.0) == pytest.approx(1.5, rel=0.2)


UNSTABLE = {"alpha": -200.0}
"""Cubic coefficient [s^2/rad^2] with which r = K delta has no solution beyond |K delta| = 2/3 / sqrt(3 * 200)."""
GENTLE, HARD = 0.1, 0.3  # rad: below and above that rudder angle, 0.18 rad at K = 0.15


def run(name: str, rudder: float, rng: np.random.Generator, phase: float = 0.0) -> Record:
    record = steered(nomoto().with_values(TRUTH), square(500, phase=phase, size=rudder), rng, NOISE)
    return Record(name, record.time, record.channels)


def fit_of(held_out: Record, rng: np.random.Generator, values: Mapping[str, float]) -> Fit:
    runs = [Run(run(name, GENTLE, rng, phase), Role.TRAIN) for name, phase in (("a", 0.0), ("b", 7.0))]
    return identify(
        Trial(Ship("craft", {"L": 8.0}), (*runs, Run(held_out, Role.VALIDATE)), nomoto().with_values(values))
    )


@pytest.fixture(scope="module")
def diverged() -> Fit:
    rng = np.random.default_rng(3)
    return fit_of(run("v", HARD, rng), rng, UNSTABLE)


def test_a_diverged_run_is_scored_as_long_as_it_lasts(diverged: Fit) -> None:
    (prediction,) = diverged.validation
    found = prediction.divergence
    assert found is not None
    assert (found.state, found.terms) == ("r", ("alpha",))
    lasting = prediction.measured.time < found.time
    for channel in ("r", "psi"):
        assert np.isfinite(prediction.simulated[channel][lasting]).all()
        assert np.isnan(prediction.simulated[channel][~lasting]).all()
    np.testing.assert_array_equal(prediction.simulated["delta"], prediction.measured["delta"])
    error = (prediction.simulated["r"] - prediction.measured["r"])[lasting]
    assert prediction.rms["r"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-12)
    assert found.seconds == pytest.approx(prediction.measured.time[lasting][-1] - prediction.measured.time[0])


def test_the_warning_names_the_terms_and_a_cure(diverged: Fit) -> None:
    (warning,) = [f for f in diverged.findings if f.code == "diverged"]
    assert "'v' diverges in 'r'" in warning.message
    assert "alpha" in warning.message
    assert warning.advice == "train on a run of this amplitude; or correct the fixed value of alpha"


def test_a_fit_is_kept_whose_own_run_diverges(rng: np.random.Generator, tmp_path: Path) -> None:
    # beyond the angle up to which the model has a solution: segments of a second last, the whole run does not
    runs = [Run(run(name, rudder, rng), Role.TRAIN) for name, rudder in (("a", GENTLE), ("b", HARD))]
    quick = nomoto().with_values(UNSTABLE | {"T": 1.5})
    model = quick.with_parameters(quick.parameters.fixed("T").bounded("K", 0.14, 0.16))
    trial = Trial(Ship("craft", {"L": 8.0}), tuple(runs), model)
    fit = identify(replace(trial, estimate=replace(trial.estimate, segment_s=1.0)))
    assert [p.divergence is not None for p in fit.predictions] == [False, True]
    (warning,) = [f for f in fit.findings if f.code == "diverged"]
    assert warning.message.startswith("training run 'b' diverges in 'r'")
    assert "train on a run" not in warning.advice
    assert verdict(fit).startswith("Does not reproduce b of its 2 runs: the simulation diverges")
    save_result(fit, tmp_path)
    assert load_fit(tmp_path).predictions[1].divergence == fit.predictions[1].divergence


def test_the_folder_of_a_fit_with_a_diverged_run_is_written_and_read(diverged: Fit, tmp_path: Path) -> None:
    save_result(diverged, tmp_path)
    again = load_fit(tmp_path)
    assert again.validation[0].divergence == diverged.validation[0].divergence
    assert again.validation[0].rms == diverged.validation[0].rms


def without_rudder(record: Record) -> Record:
    return Record(record.name, record.time, {s: c for s, c in record.channels.items() if s != "delta"})


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [(lambda r: r.rows(slice(0, 2)), "has 2 samples"), (without_rudder, "has no channel 'delta'")],
)
def test_a_run_that_cannot_be_simulated_leaves_the_fit(
    spoil: Callable[[Record], Record], reason: str, rng: np.random.Generator
) -> None:
    fit = fit_of(spoil(run("v", GENTLE, rng)), rng, {})
    assert [p.record for p in fit.predictions] == ["a", "b"]
    assert fit["T"].estimate == pytest.approx(TRUTH["T"], rel=0.1)
    (warning,) = [f for f in fit.findings if f.code == "not-predicted"]
    assert reason in warning.message


def test_a_run_that_stays_within_bounds_has_no_divergence(rng: np.random.Generator) -> None:
    record, model = run("v", GENTLE, rng), nomoto().with_values(TRUTH)
    inputs = inputs_of(model, record)
    states, _ = trajectory(model, inputs, record.dt, np.zeros(len(model.states)))
    assert divergence_of(model, record, states) is None


def test_the_first_row_outside_counts_what_is_not_a_number() -> None:
    states = np.array([[0.0, 1.0], [0.5, 2.0], [np.nan, 0.0]])
    assert first_row_outside(states, np.array([1.0, 3.0])) == 2
    assert first_row_outside(states, np.array([1.0, 1.5])) == 1
    assert first_row_outside(states[:2], np.array([1.0, 3.0])) is None
