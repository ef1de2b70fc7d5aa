"""Runs that diverge or cannot be simulated: the fit is kept, and the run scored as long as it lasts."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.conftest import NOISE, TRUTH, square, steered

from seatrial.core.results import Fit
from seatrial.core.values import Record, Ship
from seatrial.data.folder.result_folder import load_fit, save_result
from seatrial.data.trial import Role, Trial, TrialRun
from seatrial.estimation.identify import identify
from seatrial.estimation.predict.open_loop import divergence_of
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.replay import first_row_outside, inputs_of, trajectory
from seatrial.reporting.verdict import verdict

UNSTABLE = {"alpha": -200.0}
"""Cubic coefficient [s^2/rad^2] with which r = K delta has no solution beyond |K delta| = 2/3 / sqrt(3 * 200)."""
GENTLE, HARD = 0.1, 0.3  # rad: below and above that rudder angle, 0.18 rad at K = 0.15


def run(name: str, rudder: float, rng: np.random.Generator, phase: float = 0.0) -> Record:
    record = steered(nomoto().with_values(TRUTH), square(500, phase=phase, size=rudder), rng, NOISE)
    return Record(name, record.time, record.channels)


def fit_of(held_out: Record, rng: np.random.Generator, values: Mapping[str, float]) -> Fit:
    runs = [TrialRun(run(name, GENTLE, rng, phase), Role.TRAIN) for name, phase in (("a", 0.0), ("b", 7.0))]
    return identify(
        Trial(Ship("craft", {"L": 8.0}), (*runs, TrialRun(held_out, Role.VALIDATE)), nomoto().with_values(values))
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
    runs = [TrialRun(run(name, rudder, rng), Role.TRAIN) for name, rudder in (("a", GENTLE), ("b", HARD))]
    quick = nomoto().with_values(UNSTABLE | {"T": 1.5})
    model = quick.with_parameters(quick.parameters.fixed("T").bounded("K", 0.14, 0.16))
    trial = Trial(Ship("craft", {"L": 8.0}), tuple(runs), model)
    fit = identify(replace(trial, estimate=replace(trial.estimate, segment_s=1.0)))
    assert [p.divergence is not None for p in fit.predictions] == [False, True]
    (warning,) = [f for f in fit.findings if f.code == "diverged"]
    assert warning.message.startswith("training run 'b' diverges in 'r'")
    assert "train on a run" not in warning.advice
    assert verdict(fit).startswith("Does not reproduce b of 2 runs that it was fitted to: the simulation diverges")
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
