"""The model and the held-out run of a draft follow from its channels and runs."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.starting_model import held_out_run, starting_model
from seatrial.data.draft.tables_text import tables_text, thruster_tables
from seatrial.data.trial.load import load_trial

SHIP = {"delta", "u", "v", "r", "psi", "lat", "lon"}
TIME = np.arange(400) * 0.5


def zigzag(rudder_deg: float) -> Record:
    delta = np.radians(rudder_deg) * np.sign(np.sin(0.2 * TIME))
    return Record.from_arrays("run", TIME, {"delta": delta, "psi": np.zeros(400)})


def decay(angle_deg: float) -> Record:
    phi = np.radians(angle_deg) * np.exp(-0.05 * TIME) * np.cos(TIME)
    return Record.from_arrays("run", TIME, {"phi": phi})


@pytest.mark.parametrize(
    ("symbols", "name"),
    [
        ({"delta", "psi", "command_1"}, "nomoto"),
        ({"command_1", "command_2", "psi", "phi"}, "thrusters"),
        ({"phi", "p"}, "roll"),
        ({"zeta", "z", "theta"}, "heave_pitch"),
        ({"phi", "psi"}, ""),
        ({"lat", "lon"}, ""),
    ],
)
def test_the_model_follows_from_the_channels(symbols: set[str], name: str) -> None:
    assert starting_model(symbols, []).name == name


def test_the_fall_of_the_gain_is_free_where_rudder_angles_differ() -> None:
    symbols = {"delta", "psi"}
    assert starting_model(symbols, [zigzag(10.0), zigzag(20.0), None]).free == ("K", "T", "alpha")
    assert starting_model(symbols, [zigzag(20.0), zigzag(22.0)]).free == ()


def test_the_upper_middle_run_within_the_others_is_held_out() -> None:
    records = {"a": zigzag(10.0), "b": zigzag(20.0), "c": zigzag(30.0)}
    model = starting_model({"delta"}, list(records.values()))
    assert held_out_run(model, records) == "a"  # of two; c leaves what the others show
    assert held_out_run(model, records | {"d": zigzag(30.0)}) == "c"


def test_no_run_is_held_out_whose_side_no_other_shows() -> None:
    port = Record.from_arrays("p", TIME, {"delta": np.where(TIME > 20.0, -0.3, 0.0)})
    starboard = Record.from_arrays("s", TIME, {"delta": np.where(TIME > 20.0, 0.3, 0.0)})
    records = {"p": port, "s": starboard}
    assert held_out_run(starting_model({"delta"}, list(records.values())), records) == ""
    assert held_out_run(starting_model({"delta"}, [port]), {"p": port}) == ""


def test_the_smaller_of_two_decays_is_held_out_to_whichever_side_it_starts() -> None:
    records = {"large": decay(15.0), "small": decay(-10.0)}
    assert held_out_run(starting_model({"phi"}, list(records.values())), records) == "small"


def test_thrusters_are_named_by_the_side_that_the_motion_shows() -> None:
    left, right = (ColumnGuess(s, f"command_{k}", "1", side=s) for k, s in ((1, "port"), (2, "starboard")))
    text = "\n".join(thruster_tables([left, right], 2.0))
    assert 'name = "port"\nx = 0.0' in text and "y = -0.30    # ESTIMATED" in text
    assert text.count("same_as") == 1
    unknown = thruster_tables([ColumnGuess("a", "command_1", "1"), ColumnGuess("b", "alpha_1", "rad")], 2.0)
    assert 'name = "thruster_1"' in unknown and 'angle = { channel = "alpha_1" }' in unknown


def trial_run(rudder_deg: float, rate: float = 1.5) -> Record:
    delta = np.radians(rudder_deg) * np.sign(np.sin(0.2 * TIME))
    same = np.ones(400)
    return Record.from_arrays("run", TIME, {"delta": delta, "u": 6.0 * same, "v": 0.0 * same, "n": rate * same})


def test_a_ship_of_stated_length_whose_drift_is_recorded_has_a_model_of_forces() -> None:
    runs = [trial_run(10.0), trial_run(20.0)]
    model = starting_model(SHIP, runs, 35.0)
    assert (model.name, model.speed, model.free[-1]) == ("abkowitz", 6.0, "N_rrr")
    assert starting_model(SHIP, runs).name == "nomoto"  # no length
    assert starting_model(SHIP - {"v"}, runs, 35.0).name == "nomoto"
    assert starting_model(SHIP, [trial_run(10.0), trial_run(20.0, 2.0)], 35.0).name == "nomoto"  # its engine varies


def test_the_tables_of_a_ship_are_a_trial_that_runs(tmp_path: Path) -> None:
    model = starting_model(SHIP, [trial_run(10.0)], 35.0)
    lines = tables_text(model, [ColumnGuess("a", "sog", "kn"), ColumnGuess("b", "cog", "deg")], 35.0)
    (tmp_path / "log.csv").write_text("".join(f"{t},{t % 7}\n" for t in range(40)))
    records = '[[records]]\nfiles = ["log.csv"]\ntime = { column = 1 }\nchannels.delta = { column = 2, unit = "deg" }\n'
    (tmp_path / "trial.toml").write_text("\n".join([*lines, records]))
    trial = load_trial(tmp_path / "trial.toml")
    value = {p.name: p.value for p in trial.model.parameters}
    assert value["I_z"] == pytest.approx(value["m"] * (35.0 / 4.0) ** 2, 1e-3)
    assert value["Y_vdot"] < 0.0 and trial.estimate.current and 'velocity = "ground"' in "".join(lines)
    assert any("ESTIMATED" in line and line.startswith("m = ") for line in lines)
