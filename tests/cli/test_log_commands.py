"""`seatrial init` and `seatrial check` on bare logs and on drafted files."""

from pathlib import Path

import numpy as np
import pytest
from tests.data.draft.test_draft import BASE, TRUTH, write
from tests.data.read.samples import SAMPLES
from typer.testing import CliRunner

from seatrial.cli.commands import app
from seatrial.core.values import InputError

RUNNER = CliRunner()


def output(*arguments: str) -> str:
    result = RUNNER.invoke(app, list(arguments), catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_a_bare_log_is_listed(tmp_path: Path) -> None:
    SAMPLES["run.bin"].write(tmp_path / "run.bin")
    text = output("check", str(tmp_path / "run.bin"))
    for part in ("run.bin: ardupilot-bin, 1 topic", "XKF1: 60 rows, 5 Hz, 11.8 s", "-> u", "MODE AUTO", "2 parameters"):
        assert part in text
    assert "Next: seatrial init" in text


def test_a_folder_is_listed_as_init_takes_it(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write(tmp_path / f"{name}.csv", {"time": TRUTH["t"], "heading": TRUTH["psi"]})
    (tmp_path / "notes.txt").write_text("no numbers\n", encoding="utf-8")
    text = output("check", str(tmp_path))
    assert "a.csv: text, 1 topic" in text and "b.csv: text, 1 topic" in text and "no log: notes.txt: " in text
    assert text.endswith(f"Next: seatrial init {tmp_path} --out trial.toml\n")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="there is no log"):
        output("check", str(tmp_path / "empty"))


def test_a_draft_is_written_once_and_checked(tmp_path: Path) -> None:
    log, trial = write(tmp_path / "run.csv", BASE | {"rot": TRUTH["r"]}), tmp_path / "trial.toml"
    text = output("init", str(log), "--out", str(trial))
    assert (
        "rad/s, positive to starboard by the rate of the heading" in text
        and "zigzag1, " in text
        and "Next: no column is a rudder (delta)" in text
    )
    assert "seatrial open" in text and [path.name for path in tmp_path.glob("trial*")] == ["trial.toml"]
    with pytest.raises(InputError, match=r"trial.toml' exists; add --overwrite"):
        output("init", str(log), "--out", str(trial))
    assert "Next: " in output("check", str(trial))
    assert "trial file" in output("init", str(log), "--out", str(trial), "--overwrite")


def test_sources_without_a_time_column_are_drafted_with_their_columns(tmp_path: Path) -> None:
    rows = [f"{k * 7 % 5},a{k},{0.1 * k * k - k}" for k in range(40)]
    for name, columns in (("nav", "speed,note,heading"), ("engine", "rpm,note,load")):
        (tmp_path / f"{name}.csv").write_text("\n".join([columns, *rows]), encoding="utf-8")
    logs, trial = [str(tmp_path / f"{name}.csv") for name in ("nav", "engine")], tmp_path / "trial.toml"
    assert "no time column" in output("init", *logs, "--out", str(trial))
    text = trial.read_text(encoding="utf-8")
    for part in ('file = "nav.csv"', 'file = "engine.csv"', "# OPEN: no column is recognised as the time", "heading"):
        assert part in text
    with pytest.raises(InputError, match="channels"):
        output("check", str(trial))
    assert "OPEN: no input" in text and "text: note" in output("check", logs[0])


def test_a_draft_of_runs_takes_them_whole_and_a_model_of_its_inputs(tmp_path: Path) -> None:
    columns = BASE | {"thr_left": 1500.0 + 300.0 * TRUTH["delta"], "thr_right": 1500.0 - 300.0 * TRUTH["delta"]}
    write(tmp_path / "a.csv", columns)
    write(tmp_path / "b.csv", columns)
    text = output("init", str(tmp_path), "--out", str(tmp_path / "trial.toml"))
    assert "a.csv: 3 manoeuvres: zigzag, straight, circle to starboard" in text
    assert "put the length of the craft after 'L =' in" in text
    draft = (tmp_path / "trial.toml").read_text(encoding="utf-8")
    assert "parts" not in draft
    assert '\nname = "thrusters"' in draft
    assert 'validate = "a"' in draft


@pytest.mark.parametrize(("stated", "is_noted"), [("", True), ("--rho 1000", False)])
def test_the_water_of_a_small_craft_is_asked_for_where_its_model_takes_one(
    tmp_path: Path, stated: str, *, is_noted: bool
) -> None:
    columns = BASE | {"rudder": TRUTH["delta"] * 180.0 / np.pi}
    write(tmp_path / "a.csv", columns)
    size = ["--length", "8", "--name", 'Dr"a', *stated.split()]
    text = output("init", str(tmp_path), *size, "--out", str(tmp_path / "trial.toml"))
    assert ("NOTE the water is taken for that of the sea" in text) is is_noted
    assert '\nname = "Dr\\"a"\n' in (tmp_path / "trial.toml").read_text(encoding="utf-8")


def test_the_manoeuvres_of_a_single_log_are_runs(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", BASE | {"rudder": TRUTH["delta"] * 180.0 / np.pi})
    text = output("init", str(tmp_path), "--length", "20", "--out", str(tmp_path / "trial.toml"))
    assert text.endswith(f"Next: seatrial identify {tmp_path / 'trial.toml'} --out results\n")
    draft = (tmp_path / "trial.toml").read_text(encoding="utf-8")
    assert draft.count("\nparts = [") == 1 and draft.count("\n    { name = ") == 2
    assert draft.count("\n#   { name = ") == 1  # the straight run
    assert "Next: seatrial identify" in output("check", str(tmp_path / "trial.toml"))


def test_a_model_without_its_input_in_the_records_cannot_start_yet(tmp_path: Path) -> None:
    write(tmp_path / "run.csv", {"time": TRUTH["t"], "r": TRUTH["r"]})
    (tmp_path / "trial.toml").write_text(
        '[ship]\nname = "ship"\nL = 100.0\n[model]\nname = "nomoto"\n[[records]]\nfiles = ["run.csv"]\n'
        'time = { column = "time" }\nchannels.r = { column = "r", unit = "rad/s" }\n',
        encoding="utf-8",
    )
    assert "Next: identify cannot start yet: record 'run' has no channel 'delta'" in output(
        "check", str(tmp_path / "trial.toml")
    )


@pytest.mark.parametrize(("channels", "is_ready"), [("xy", False), ("psi", False), ("xy psi", True)])
def test_check_refuses_a_model_of_forces_whose_speeds_nothing_implies(
    tmp_path: Path, channels: str, *, is_ready: bool
) -> None:
    north, east = (np.cumsum(f(TRUTH["psi"]) * TRUTH["u"]) for f in (np.cos, np.sin))
    columns = {"xy": {"x0": north, "y0": east}, "psi": {"psi": TRUTH["psi"]}}
    write(tmp_path / "run.csv", {"time": TRUTH["t"], "delta": TRUTH["delta"]} | {
        name: values for key in channels.split() for name, values in columns[key].items()})  # fmt: skip
    units = {"x0": "m", "y0": "m", "psi": "rad"}
    names = [name for key in channels.split() for name in columns[key]]
    tables = "".join(f'{name} = {{ column = "{name}", unit = "{units[name]}" }}\n' for name in names)
    (tmp_path / "trial.toml").write_text(
        '[ship]\nname = "s"\nL = 100.0\nm = 1e6\nI_z = 6e8\nx_G = 0.0\nrho = 1025.0\n[model]\nname = "abkowitz"\n'
        "[model.fixed]\nU_n = 5.0\nX_udot = -0.001\nY_vdot = -0.01\nN_rdot = -0.0005\n"
        '[[records]]\nfiles = ["run.csv"]\ntime = { column = "time" }\n[records.channels]\n'
        f'delta = {{ column = "delta", unit = "rad", positive = "starboard" }}\n{tables}', encoding="utf-8",
    )  # fmt: skip
    text = " ".join(output("check", str(tmp_path / "trial.toml")).split())
    refusal = "neither holds nor implies 'u', which model 'abkowitz' needs; add the channel, or positions and heading"
    assert (refusal in text) is not is_ready


def test_the_next_command_quotes_a_path_with_spaces(tmp_path: Path) -> None:
    folder = tmp_path / "[2024] trials"
    folder.mkdir()
    log = write(folder / "run 1.csv", {"time": TRUTH["t"], "heading": TRUTH["psi"]})
    assert f"Next: seatrial init '{log}' --out trial.toml" in output("check", str(log))
    assert f"seatrial check '{folder / 'trial.toml'}'" in output("init", str(log), "--out", str(folder / "trial.toml"))


def test_a_heading_that_is_not_recognised_is_asked_for(tmp_path: Path) -> None:
    named = {name: values for name, values in BASE.items() if name != "heading"}
    log = write(tmp_path / "run.csv", named | {"bearing of the bow": TRUTH["psi"], "rudder": TRUTH["delta"]})
    text = output("init", str(log), "--length", "12", "--out", str(tmp_path / "trial.toml"))
    assert "Next: no column is recognised as the heading" in text
    assert "--overwrite --column 'bearing of the bow=psi'" in text.replace("\n", " ").replace("  ", " ")


def test_heading_and_rudder_that_are_not_recognised_are_asked_for_together(tmp_path: Path) -> None:
    named = {name: values for name, values in BASE.items() if name != "heading"}
    log = write(tmp_path / "run.csv", named | {"bearing of the bow": TRUTH["psi"], "blade": TRUTH["delta"]})
    arguments = ("init", str(log), "--length", "12", "--out", str(tmp_path / "trial.toml"))
    text = " ".join(output(*arguments).split())
    named_so = ("--overwrite", "--column", "bearing of the bow=psi", "--column", "blade=delta")
    assert text.endswith("--overwrite --column 'bearing of the bow=psi' --column blade=delta")
    assert "not recognised" not in output(*arguments, *named_so)
