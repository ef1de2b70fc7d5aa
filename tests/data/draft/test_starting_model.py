"""The model and the held-out run of a draft follow from its channels and runs."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.draft_text import tables_text, thruster_tables
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.draft.starting_model import starting_model, with_wind
from seatrial.data.trial.load import load_trial

SHIP = {"delta", "u", "v", "r", "psi", "lat", "lon"}
TIME = np.arange(400) * 0.5


def zigzag(rudder_deg: float) -> Record:
    delta = np.radians(rudder_deg) * np.sign(np.sin(0.2 * TIME))
    return Record.from_arrays("run", TIME, {"delta": delta, "psi": np.zeros(400)})


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


def test_thrusters_are_named_by_the_side_that_the_motion_shows() -> None:
    left, right = (ColumnGuess(s, f"command_{k}", "1", side=s) for k, s in ((1, "port"), (2, "starboard")))
    text = "\n".join(thruster_tables([left, right], StatedSize(2.0)))
    assert 'name = "port"\nx = 0.0' in text and "y = -0.30    # ESTIMATED" in text
    assert text.count("same_as") == 1
    assert "y = -0.34    # ESTIMATED: m to starboard, from B" in "\n".join(
        thruster_tables([left, right], StatedSize(1.4, 0.9))
    )
    unknown = thruster_tables([ColumnGuess("a", "command_1", "1"), ColumnGuess("b", "alpha_1", "rad")], StatedSize(2.0))
    assert 'name = "thruster_1"' in unknown and 'angle = { channel = "alpha_1" }' in unknown


def trial_run(rudder_deg: float, rate: float = 0.0) -> Record:
    """A zigzag at 6 m/s; rate: of the propeller [1/s], 0: not recorded."""
    delta = np.radians(rudder_deg) * np.sign(np.sin(0.2 * TIME))
    same = np.ones(400)
    propeller = {"n": rate * same} if rate else {}
    return Record.from_arrays("run", TIME, {"delta": delta, "u": 6.0 * same, "v": 0.0 * same, **propeller})


LENGTH = StatedSize(35.0)


def test_a_ship_of_stated_length_whose_drift_is_recorded_has_a_model_of_forces() -> None:
    runs = [trial_run(10.0), trial_run(20.0)]
    model = starting_model(SHIP, runs, LENGTH)
    assert (model.name, model.speed) == ("abkowitz", 6.0)
    assert {"X_u", "X_uu", "X_dd", "N_d", "N_vvr"} <= set(model.free), "no usual term is held at zero"
    assert starting_model(SHIP, runs).name == "nomoto"  # no length
    assert starting_model(SHIP - {"v", "psi"}, runs, LENGTH).name == "nomoto"
    engine = [trial_run(10.0, 25.0), trial_run(20.0, 40.0)]
    assert starting_model(SHIP, engine, LENGTH).name == "nomoto"  # what turns is no propeller, and not steadily


def test_a_recorded_propeller_gives_the_model_with_propeller_and_rudder() -> None:
    runs = [trial_run(10.0, 4.0), trial_run(20.0, 5.0)]
    model = starting_model(SHIP, runs, LENGTH)
    value = {one.key: one.value for one in model.particulars}
    assert model.name == "mmg" and 0.5 <= value["pitch_ratio"] <= 1.4 and value["D_P"] < value["d"]
    assert starting_model(SHIP, runs, StatedSize(6.0)).name == "nomoto"  # a Froude number of 0.78
    steady = [trial_run(10.0, 4.0), trial_run(20.0, 4.0)]
    assert starting_model(SHIP, steady, LENGTH, has_jet=True).name == "abkowitz"


def track_run(rate: float = 0.0, north: float = 1.0) -> Record:
    """A straight run at 6 m/s of which the track and the heading are recorded, in a small arc of the rudder."""
    delta, way = np.radians(10.0) * np.sign(np.sin(0.2 * TIME)), 6.0 * TIME
    propeller = {"n": np.full(400, rate)} if rate else {}
    motion = {"x0": north * way, "y0": np.sqrt(1.0 - north**2) * way, "psi": np.full(400, np.arccos(north))}
    return Record.from_arrays("run", TIME, {"delta": delta, **motion, **propeller})


@pytest.mark.parametrize(
    ("positions", "rate", "name"),
    [(("x0", "y0"), 4.0, "mmg"), (("lat", "lon"), 4.0, "mmg"), (("x0", "y0"), 0.0, "abkowitz")],
)
def test_a_track_with_the_heading_shows_drift_and_approach_speed(
    positions: tuple[str, str], rate: float, name: str
) -> None:
    symbols, runs = {"delta", "r", "psi", *positions}, [track_run(rate, 0.6)]
    model = starting_model(symbols, runs, LENGTH)
    assert (model.name, model.speed) == (name, pytest.approx(6.0))
    assert model.particulars == starting_model(SHIP, [trial_run(10.0, 4.0)], LENGTH).particulars or not rate
    assert starting_model(symbols - {"psi"}, runs, LENGTH).name == "nomoto"


def test_a_run_that_starts_slowly_has_the_speed_that_it_reaches() -> None:
    run = trial_run(10.0)
    slow = run.with_channel("u", run.channel("u").with_values(np.minimum(0.1 * TIME, 6.0)))
    assert starting_model(SHIP, [slow], LENGTH).speed == pytest.approx(6.0)


@pytest.mark.parametrize("rate", [0.0, 4.0])
def test_the_tables_of_a_ship_are_a_trial_that_runs(tmp_path: Path, rate: float) -> None:
    model = starting_model(SHIP, [trial_run(10.0, rate)], LENGTH)
    lines = tables_text(model, [ColumnGuess("a", "sog", "kn"), ColumnGuess("b", "cog", "deg")], LENGTH)
    (tmp_path / "log.csv").write_text("".join(f"{t},{t % 7},4\n" for t in range(40)))
    records = '[[records]]\nfiles = ["log.csv"]\ntime = { column = 1 }\nchannels.delta = { column = 2, unit = "deg" }\n'
    records += 'channels.n = { column = 3, unit = "rps" }\n'
    (tmp_path / "trial.toml").write_text("\n".join([*lines, records]))
    trial = load_trial(tmp_path / "trial.toml")
    value = {p.name: p.value for p in trial.model.parameters}
    assert value["I_z"] == pytest.approx(value["m"] * (35.0 / 4.0) ** 2, 1e-3)
    assert trial.estimate.current and 'velocity = "ground"' in "".join(lines)
    assert any("ESTIMATED" in line and line.startswith(("m = ", "D_P = ")) for line in lines)


def test_a_recorded_wind_acts_on_areas_from_the_length(tmp_path: Path) -> None:
    model = with_wind(starting_model(SHIP, [trial_run(10.0, 4.0)], LENGTH), LENGTH)
    (tmp_path / "log.csv").write_text("".join(f"{t},{t % 7},4\n" for t in range(40)))
    records = '[[records]]\nfiles = ["log.csv"]\ntime = { column = 1 }\nchannels.delta = { column = 2, unit = "deg" }\n'
    records += 'channels.n = { column = 3, unit = "rps" }\n'
    (tmp_path / "trial.toml").write_text("\n".join([*tables_text(model, [], LENGTH), records]))
    parameters = load_trial(tmp_path / "trial.toml").model.parameters
    assert parameters["A_L"].value == pytest.approx(0.1 * 35.0**2)
    priors = [parameters[name].prior for name in ("C_X1", "C_Y1", "C_N2")]
    assert [(one.mean, one.standard_deviation) for one in priors if one] == [(-0.7, 0.35), (-0.8, 0.4), (0.0, 0.1)]
