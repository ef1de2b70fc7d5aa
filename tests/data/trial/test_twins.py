"""Columns of two sides in a trial file: their mean for every model, their difference for one that has it."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import load_trial
from seatrial.data.trial.records import load_run
from seatrial.data.trial.run_data import RunFiles
from seatrial.physics.simulate.replay import inputs_of
from seatrial.problems.twin_ships import twin_screw_ship

TIME = np.arange(0.0, 60.0, 0.5)
COLUMNS = {
    "t": TIME, "psi": TIME, "u": 5.0 + 0.0 * TIME, "rp": 10.0 + np.sin(TIME), "rs": 4.0 + 0.0 * TIME,
    "np": 120.0 + 0.1 * TIME, "ns": -30.0 + 0.0 * TIME,
}  # fmt: skip
DELTA = 'delta = { column = "rp", twin = "rs", unit = "deg" }'


def write(folder: Path, model: str = "mmg_twin", delta: str = DELTA, more: str = "") -> Path:
    """A trial of one record, with the particulars of the known ferry."""
    table = np.column_stack(list(COLUMNS.values()))
    np.savetxt(folder / "run.csv", table, "%.12g", ",", header=",".join(COLUMNS), comments="")
    ship = twin_screw_ship()
    names = [p.name for p in ship.parameters if not p.free and p.name != "L"]
    values = "\n".join(
        f"{name} = {ship.parameters[name].value}" for name in names if model == "mmg_twin" or name != "y_P"
    )
    text = f"""
[ship]
name = "ferry"
L = 6.0
[model]
name = "{model}"
[model.fixed]
{values}
[[records]]
files = ["run.csv"]
time = {{ column = "t" }}
channels.psi = {{ column = "psi", unit = "deg" }}
channels.u = {{ column = "u", unit = "m/s" }}
channels.{delta}
channels.n = {{ column = "np", twin = "ns", unit = "rpm" }}
{more}
"""
    (folder / "trial.toml").write_text(text)
    return folder / "trial.toml"


def test_a_model_with_two_of_each_gets_their_differences(tmp_path: Path) -> None:
    trial = load_trial(write(tmp_path))
    record = load_run(trial.runs[0], 0.0).record
    inputs = dict(zip(trial.model.input_names, inputs_of(trial.model, record).T, strict=True))
    np.testing.assert_allclose(inputs["delta"], np.radians(7.0 + 0.5 * np.sin(TIME)), atol=1e-6)
    np.testing.assert_allclose(inputs["delta_difference"], np.radians(6.0 + np.sin(TIME)), atol=1e-6)
    np.testing.assert_allclose(inputs["n_difference"], (150.0 + 0.1 * TIME) / 60.0, rtol=1e-5)


def test_a_model_with_one_of_each_gets_half_the_sums_alone(tmp_path: Path) -> None:
    record = load_run(load_trial(write(tmp_path, "mmg")).runs[0], 0.0).record
    assert {"delta", "n"} <= set(record.channels) and not [name for name in record.channels if "difference" in name]


def test_angles_counted_to_port_have_a_difference_of_the_other_sign(tmp_path: Path) -> None:
    turned = 'delta = { column = "rp", twin = "rs", unit = "deg", positive = "port", zero = 1.0, scale = 2.0 }'
    trial = load_trial(write(tmp_path, delta=turned))
    record = load_run(trial.runs[0], 0.0).record
    np.testing.assert_allclose(record["delta_difference"], -2.0 * np.radians(6.0 + np.sin(TIME)), atol=1e-6)


def test_where_one_side_is_empty_the_sides_are_taken_as_equal(tmp_path: Path) -> None:
    path = write(tmp_path)
    lines = (tmp_path / "run.csv").read_text().splitlines()
    cells = lines[5].split(",")
    lines[5] = ",".join([*cells[:3], "", *cells[4:]])
    (tmp_path / "run.csv").write_text("\n".join(lines) + "\n")
    files = load_trial(path).runs[0].data
    assert isinstance(files, RunFiles)
    record = files.read()
    assert record["delta_difference"][4] == 0.0
    assert record["delta"][4] == pytest.approx(np.radians(4.0))


def test_a_key_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="twins"):
        load_trial(write(tmp_path, delta='delta = { column = "rp", twins = "rs", unit = "deg" }'))


def test_a_difference_can_be_recorded_itself(tmp_path: Path) -> None:
    more = 'channels.delta_difference = { column = "rs", unit = "deg" }'
    trial = load_trial(write(tmp_path, delta='delta = { column = "rp", unit = "deg" }', more=more))
    record = load_run(trial.runs[0], 0.0).record
    np.testing.assert_allclose(record["delta_difference"], np.radians(4.0), atol=1e-6)
