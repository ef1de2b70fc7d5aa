"""Runs of several files and runs cut out of one log, as the trial file describes them."""

from pathlib import Path

import numpy as np
import pytest
from tests.data.read.samples import HEADING, SAMPLES, SPEED, TIME

from seatrial.core.values import InputError
from seatrial.data.trial import Role, RunFiles, Trial, load_runs, load_trial

HEAD = """
[ship]
name = "craft"
L = 2.0
[model]
name = "nomoto"
"""
BIN = """
[[records]]
files = "run.bin"
channels.u = { column = "XKF1/VN", unit = "m/s" }
channels.psi = { column = "XKF1/Yaw", unit = "deg" }
"""
TWO = """
[[records]]
name = "joined"
[[records.sources]]
file = "speed.csv"
time = { column = "t" }
channels.u = { column = "speed", unit = "m/s" }
[[records.sources]]
file = "heading.csv"
clock_offset = -100.0
time = { column = "t", unit = "s" }
channels.psi = { column = "heading", unit = "deg" }
channels.command_1 = { column = "pwm", unit = "us", zero = 1500, span = 400, positive = "astern" }
channels.delta = { column = "heading2", unit = "deg", scale = 0.5, offset = 10 }
"""


def load(folder: Path, text: str) -> Trial:
    (folder / "trial.toml").write_text(HEAD + text, encoding="utf-8")
    return load_trial(folder / "trial.toml")


def write_two(folder: Path) -> None:
    SAMPLES["run.csv"].write(folder / "speed.csv")
    rows = zip((TIME + 100.0).tolist(), HEADING.tolist(), strict=True)
    lines = [f"{t!r},{psi!r},{psi!r},{1500 + 200 * (t > 106)}" for t, psi in rows]
    (folder / "heading.csv").write_text("\n".join(["t,heading,heading2,pwm", *lines]), encoding="utf-8")


def test_sources_with_clocks_of_their_own_make_one_record(tmp_path: Path) -> None:
    write_two(tmp_path)
    (run,) = load(tmp_path, TWO).runs
    record = run.raw_record()
    assert record.name == run.name == "joined" and len(run.files) == 2
    np.testing.assert_allclose(record.time, TIME, atol=1e-9)
    np.testing.assert_allclose(record["u"], SPEED)
    np.testing.assert_allclose(np.degrees(record["psi"]), HEADING)
    np.testing.assert_array_equal(record["command_1"], np.where(TIME > 6, 0.5, 0.0))
    np.testing.assert_allclose(np.degrees(record["delta"]), 0.5 * HEADING + 10.0)
    assert record.channel("command_1").positive == "astern"


def test_parts_by_time_and_by_event_have_roles_and_share_a_session(tmp_path: Path) -> None:
    SAMPLES["run.bin"].write(tmp_path / "run.bin")
    parts = """
validate = "auto"
parts = [
    { name = "first", from = "1 s", to = "4 s" },
    { name = "manual", from = "MODE MANUAL", to = "MODE AUTO" },
    { name = "auto", from = "MODE AUTO" },
]
"""
    first, manual, auto = load(tmp_path, BIN + parts).runs
    assert (first.role, auto.role) == (Role.TRAIN, Role.VALIDATE)
    assert first.session == manual.session == "run"
    for run, ends in ((first, (1.0, 4.0)), (manual, (0.0, 6.0)), (auto, (6.0, TIME[-1]))):
        record = run.raw_record()
        np.testing.assert_allclose([record.time[0], record.time[-1]], ends, atol=1e-9)
        np.testing.assert_allclose(record["u"], np.interp(record.time, TIME, SPEED), atol=1e-6)


def test_a_part_of_one_of_several_files_leaves_the_others_whole(tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        SAMPLES["run.csv"].write(tmp_path / name)
    text = """
[[records]]
files = ["a.csv", "b.csv"]
validate = "late"
time = { column = "t" }
channels.u = { column = "speed", unit = "m/s" }
parts = [{ file = "b", name = "late", from = "5 s" }]
"""
    whole, late = load(tmp_path, text).runs
    assert (whole.name, late.name, late.role) == ("a", "late", Role.VALIDATE)
    assert len(whole.raw_record()) == len(TIME)
    assert late.raw_record().time[0] == pytest.approx(5.0)
    with pytest.raises(InputError, match=r"records\[1\].parts: 'late' is of file 'c', which is not among files"):
        load(tmp_path, text.replace('file = "b"', 'file = "c"'))


def test_a_clock_since_1970_is_set_back_to_the_start(tmp_path: Path) -> None:
    SAMPLES["run.mcap"].write(tmp_path / "run.mcap")
    text = """
[[records]]
files = "run.mcap"
channels.u = { column = "/nav/twist/twist.linear.x", unit = "m/s" }
"""
    (run,) = load(tmp_path, text).runs
    record = run.raw_record()
    np.testing.assert_allclose(record.time, TIME, atol=1e-6)
    assert "time counted from 2023-11-14 22:13:20 of the log's clock" in record.provenance.steps


def test_brackets_in_the_name_of_a_folder_are_brackets(tmp_path: Path) -> None:
    folder = tmp_path / "[2024] trials"
    folder.mkdir()
    SAMPLES["run.csv"].write(folder / "a.csv")
    text = '[data]\nfolder = "[2024] trials"\n' + TWO.split("[[records.sources]]")[0].replace(
        'name = "joined"',
        'files = "*.csv"\ntime = { column = "t" }\nchannels.u = { column = "speed", unit = "m/s" }',
    )
    (run,) = load(tmp_path, text).runs
    assert run.name == "a" and len(run.raw_record()) == len(TIME)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (TWO.replace('name = "joined"', ""), "a run of several sources needs a name"),
        (TWO.replace('name = "joined"', 'name = "joined"\nfiles = "speed.csv"'), "give files, or sources of one run"),
        (TWO.replace("speed.csv", "none.csv"), r"records\[1\].sources\[1\].files: there is no file"),
        (TWO.replace("span = 400", "span = 0"), "0 makes every number the same"),
        (TWO.replace("delta = { column", "rot = { column"), "unknown channel 'rot'; write r with unit = \"deg/min\""),
        (BIN + 'parts = [{ name = "a", from = "MODE HOLD" }]', "no event 'MODE HOLD' follows"),
        (BIN + 'parts = [{ name = "a", from = "5 s", to = "2 s" }]', "part 'a' ends 2 s after .* starts 5 s"),
        (BIN + 'parts = [{ name = "a" }, { name = "a" }]', "two runs are called 'a'"),
    ],
)
def test_what_does_not_fit_is_refused(text: str, sentence: str, tmp_path: Path) -> None:
    write_two(tmp_path)
    SAMPLES["run.bin"].write(tmp_path / "run.bin")
    with pytest.raises(InputError, match=sentence):
        load(tmp_path, text).runs[0].raw_record()


def test_runs_are_read_without_ship_and_model(tmp_path: Path) -> None:
    write_two(tmp_path)
    path = tmp_path / "trial.toml"
    path.write_text(TWO, encoding="utf-8")
    assert [run.name for run in load_runs(path)] == ["joined"]
    with pytest.raises(InputError, match=r"\[ship\], with name and L, is missing"):
        load_trial(path)
    path.write_text(TWO.replace("speed.csv", "none.csv"), encoding="utf-8")
    with pytest.raises(InputError, match=r"trial.toml: records\[1\].sources\[1\].files: there is no file"):
        load_runs(path)


@pytest.mark.parametrize(("line", "is_stated"), [("antenna = { x = 0.0, y = 0.0 }", True), ("", False)])
def test_an_antenna_at_midship_is_stated_where_the_trial_says_so(tmp_path: Path, line: str, *, is_stated: bool) -> None:
    (tmp_path / "trial.toml").write_text(HEAD + BIN.replace("[[records]]", f"[[records]]\n{line}"))
    (tmp_path / "run.bin").write_bytes(b"")
    (run,) = load_trial(tmp_path / "trial.toml").runs
    assert isinstance(run.data, RunFiles) and run.data.states_antenna is is_stated
