"""A simulated run goes back in as a record: simulated again, predicted, written and read."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import seatrial as st
from seatrial.api import course_findings, propeller_rate_text, replay
from seatrial.core.results import IntervalBasis, SessionOffset
from seatrial.core.values import InputError, RecordKind
from seatrial.data.folder.model_file import ModelFile
from seatrial.estimation.information.extrapolation import motion_envelope
from seatrial.physics.models import model_named

JET = {"v_j": 1.866}  # jet velocity of the example's trials, m/s


@pytest.fixture(scope="module")
def craft(repository: Path) -> ModelFile:
    """The waterjet craft of the examples, with its particulars."""
    trial = st.load_trial(repository / "examples" / "waterjet.toml")
    return ModelFile(trial.model, ship=trial.ship)


@pytest.fixture(scope="module")
def zigzag(craft: ModelFile) -> st.Record:
    """A simulated zigzag."""
    return st.simulate(craft, "zigzag:20/20", inputs=JET)


def test_the_inputs_of_a_record_give_the_record_again(craft: ModelFile, zigzag: st.Record) -> None:
    again = st.simulate(craft, zigzag)
    np.testing.assert_allclose(again["psi"], zigzag["psi"], atol=1e-6)
    assert again.kind == "simulated"


def test_a_model_alone_simulates_what_its_model_file_does(craft: ModelFile, zigzag: st.Record) -> None:
    alone = st.simulate(craft.model, "zigzag:20/20", inputs=JET)
    assert alone["psi"].tobytes() == zigzag["psi"].tobytes()


def test_a_prediction_compares_a_run_with_its_measurement(craft: ModelFile, zigzag: st.Record) -> None:
    prediction = st.predict(craft, zigzag)
    assert prediction.rms["psi_deg"] < 1e-4
    overshoot = prediction.measures["overshoot_1_deg"]
    assert overshoot.measured == pytest.approx(overshoot.simulated, rel=1e-3)
    assert st.predict(craft.model, zigzag).measures == {}, "no length of the ship, no measures"


def test_a_noisy_run_starts_at_an_estimated_state_not_at_its_first_sample(craft: ModelFile, zigzag: st.Record) -> None:
    rng = np.random.default_rng(1)
    noise = {"u": 0.05, "v": 0.05, "r": 0.01, "psi": 0.02, "x0": 0.5, "y0": 0.5}  # SI, some times a sensor's
    channels = {
        s: zigzag.channel(s).with_values(zigzag[s] + sd * rng.standard_normal(len(zigzag))) for s, sd in noise.items()
    }
    noisy = replace(zigzag, kind=RecordKind.MEASURED, channels={**zigzag.channels, **channels})
    prediction = st.predict(craft, noisy)
    assert prediction.initial_seconds > 0.0
    error = np.degrees(np.abs(prediction.simulated["psi"] - zigzag["psi"]).max())
    at_first_sample = np.degrees(np.abs(replay(craft, noisy)["psi"] - zigzag["psi"]).max())
    assert error < 0.5 * at_first_sample
    assert st.simulate(craft, noisy)["psi"].tobytes() == prediction.simulated["psi"].tobytes()
    assert st.predict(craft.model, noisy).initial_seconds == pytest.approx(0.1 * noisy.duration), "length not known"


def test_a_worse_model_predicts_worse(craft: ModelFile, zigzag: st.Record) -> None:
    other = craft.model.with_values({"N_r": 1.2 * craft.model.parameters["N_r"].value})
    assert st.predict(other, zigzag).rms["psi_deg"] > 1.0


def test_a_record_survives_being_written_and_read(zigzag: st.Record, tmp_path: Path) -> None:
    restored = st.read_record(st.write_record(zigzag, tmp_path / "zigzag.csv"))
    assert restored.metadata == zigzag.metadata
    assert restored.matrix(("u", "psi", "delta")).tobytes() == zigzag.matrix(("u", "psi", "delta")).tobytes()


def test_a_file_of_another_program_is_read_by_its_layout(tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text("t;kn\n0,0;10,0\n0,5;10,0\n")
    columns = (st.ColumnSpec("u", "kn", "kn"),)
    layout = st.Layout("text", st.ColumnSpec("time", "t", "s"), columns, separator=";")
    np.testing.assert_allclose(st.read_record(tmp_path / "log.txt", layout)["u"], 10.0 * 1852.0 / 3600.0)


def test_a_straight_run_that_is_not_held_is_said_to_be_so() -> None:
    craft = model_named("thrusters").with_values({"M_v": 2.5})
    unstable = ModelFile(craft, interval_basis=None)
    (finding,) = course_findings(unstable, "straight:90")
    assert finding.code == "course-unstable"
    assert "the craft is course unstable at " in finding.message
    assert "at equal orders it ends in a turn of " in finding.evidence
    assert course_findings(unstable, "spin:90") == ()
    stable = ModelFile(craft.with_values({"M_v": 1.5, "N_r": -5.0}))
    assert course_findings(stable, "straight:90") == ()


def test_inputs_of_a_log_are_corrected_by_what_its_session_was_off(craft: ModelFile, zigzag: st.Record) -> None:
    # the log shows 3 deg less than the nozzle's angle in the model's sign, opposite to the record's; then 1 deg more
    assert craft.model.inputs[0].positive != zigzag.channel("delta").positive
    zeros = {"1 May": np.radians(3.0), "2 May": -np.radians(1.0)}
    fitted = replace(craft, offsets=(SessionOffset("delta zero", "rad", 0.0, zeros),))
    for day, zero in zeros.items():
        shown = zigzag.channel("delta").with_values(zigzag["delta"] + zero)
        logged = replace(zigzag, kind=RecordKind.MEASURED, channels={**zigzag.channels, "delta": shown})
        error = np.degrees(np.abs(st.simulate(fitted, logged, session=day)["psi"] - zigzag["psi"]).max())
        assert error < 0.1
        assert st.predict(fitted, logged, day).rms["psi_deg"] < 0.1
        as_new = st.simulate(fitted, logged)["psi"]
        np.testing.assert_allclose(as_new, st.simulate(craft, logged)["psi"], atol=1e-6)  # 0 is expected of a new one
        assert np.degrees(np.abs(as_new - zigzag["psi"]).max()) > 10.0 * error
    with pytest.raises(InputError, match="no session '3 May' was fitted"):
        st.simulate(fitted, zigzag_measured(zigzag), session="3 May")


def zigzag_measured(zigzag: st.Record) -> st.Record:
    """The zigzag as a log would hold it."""
    return replace(zigzag, kind=RecordKind.MEASURED)


@pytest.mark.parametrize(("lowest", "is_said"), [(3.04, True), (3.28, False)])
def test_a_propeller_that_slowed_down_in_the_trials_and_not_in_the_simulation_is_said(
    craft: ModelFile, lowest: float, is_said: bool
) -> None:
    time = np.arange(0.0, 400.0)
    n = np.where(time < 10.0, 0.0, np.where(time < 200.0, 3.3, lowest))  # rps: started, straight ahead, in the turn
    turn = st.Record.from_arrays("circle", time, {"n": n})
    basis = IntervalBasis(np.zeros((0, 0)), np.inf, training_envelope=motion_envelope([turn]))
    held = st.Record.from_arrays("simulated", time, {"n": np.full(len(time), 3.3)})
    text = propeller_rate_text(replace(craft, interval_basis=basis), held)
    assert ("3.3 rps (198 rpm) throughout" in text and "fell to 3.04 rps (182 rpm)" in text) == is_said
    assert text.endswith("--set n=3.04") if is_said else text == ""
    assert propeller_rate_text(craft, held) == ""
