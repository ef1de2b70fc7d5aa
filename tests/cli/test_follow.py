"""`seatrial follow`: ends with what identify writes, says what was amiss, stops when asked, refuses in a sentence."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from tests.onboard.fabricated import mmg
from tests.onboard.streams import EXAMPLES, LINES

from seatrial.cli.follow_output import in_units_of_the_fit
from seatrial.data.trial import load_trial

COMMAND = (sys.executable, "-c", "from seatrial.cli import main; main()", "follow")


def trial_at(folder: Path, lines: list[str], *changes: tuple[str, str]) -> Path:
    """The example's trial in a folder, its voyage of these lines."""
    text = (EXAMPLES / "heave_pitch_follow.toml").read_text(encoding="utf-8")
    text = re.sub(r"\[\[records\]\].*?(?=\[follow\])", "", text, flags=re.DOTALL)
    for was, becomes in (('folder = "heave_pitch"', 'folder = "."'), *changes):
        assert was in text
        text = text.replace(was, becomes)
    (folder / "voyage_1.csv").write_text("".join(lines), encoding="utf-8")
    (folder / "trial.toml").write_text(text, encoding="utf-8")
    return folder / "trial.toml"


def as_records(trial: Path) -> Path:
    """The same trial with its stream as a record at rest."""
    text = trial.read_text(encoding="utf-8")
    block = text[text.index("[follow]") : text.index("[excitation]")]
    at_rest = block.replace('source = "file"\n', "").replace("rate = 10\n", "").replace("file =", "files =")
    at_rest = at_rest.replace("[follow]", "[[records]]").replace("[follow.", "[records.")
    place = trial.with_name("records.toml")
    place.write_text(text.replace(block, at_rest), encoding="utf-8")
    return place


def test_once_writes_what_identify_writes(tmp_path: Path, run_command: Callable[..., int], capsys) -> None:
    trial = trial_at(tmp_path, LINES)
    assert run_command("follow", trial, "--once", "--json", tmp_path / "followed.json", "--out", tmp_path / "out") == 0
    said = capsys.readouterr().out
    assert "trial.toml: file voyage_1.csv" in said
    assert "1501 samples accepted; no faults" in said
    assert "95 % from" in said
    assert (
        run_command("identify", as_records(trial), "--json", tmp_path / "identified.json", "--out", tmp_path / "other")
        == 0
    )
    followed, identified = (json.loads((tmp_path / f"{n}.json").read_text()) for n in ("followed", "identified"))
    for document in (followed, identified):
        del document["elapsed_s"]
    assert followed == identified
    assert (tmp_path / "out" / "report.html").is_file()
    assert not list((tmp_path / "out").glob("*.journal"))


def test_what_was_amiss_is_counted_and_said(tmp_path: Path, run_command: Callable[..., int], capsys) -> None:
    lines = [*LINES[:400], "rubbish\n", LINES[390], *LINES[400:420], *LINES[430:], LINES[-1]]
    plain = ("[follow]\n", '[estimate]\nmethod = "output-error"\n\n[follow]\n')
    assert run_command("follow", trial_at(tmp_path, lines, plain), "--once") == 0
    said = capsys.readouterr().out
    assert "1491 samples accepted; 1 late, 1 repeated, 10 missing, 1 garbled" in said
    assert "latest fault: " in said


@pytest.mark.parametrize(
    ("changes", "arguments", "says"),
    [
        (
            [('zeta = { column = "zeta [m]", unit = "m" }\n', "")],
            [],
            "[follow] lacks channels that model",
        ),
        ([("[follow.channels]", "[follow.channel]")], [], "unknown key 'follow.channel'; did you mean 'channels'?"),
        ([('file = "voyage_1.csv"', 'file = "voyage_9.csv"')], [], "voyage_9.csv does not exist"),
        ([], ["--source", "udp"], "source 'udp' needs a port; add port to [follow]"),
        ([], ["--source", "nmea-udp"], "has other columns"),
        ([], ["--page", "99999"], "port 99999 cannot be opened"),
        ([], ["--journal", "."], "journal '.' is a folder, pipe or device"),
        ([], ["--journal", str(EXAMPLES / "waterjet.toml")], "is not a journal of 'seatrial follow'"),
    ],
)
def test_what_cannot_be_is_one_line_and_exit_code_2(
    tmp_path: Path, run_command: Callable[..., int], capsys, changes: list, arguments: list[str], says: str
) -> None:
    assert run_command("follow", trial_at(tmp_path, LINES, *changes), *arguments) == 2
    said = capsys.readouterr().err.strip()
    assert says in said
    assert "\n" not in said


def test_a_trial_without_the_table_and_a_journal_of_another_are_refused(
    tmp_path: Path, run_command: Callable[..., int], capsys
) -> None:
    assert run_command("follow", EXAMPLES / "waterjet.toml") == 2
    assert "there is no [follow]" in capsys.readouterr().err
    trial = trial_at(tmp_path, LINES[:31])
    assert run_command("follow", trial, "--once", "--journal", tmp_path / "a.journal") == 2
    assert "too short for its longest waves" in capsys.readouterr().err
    other = trial_at(tmp_path, LINES, ('z = { column = "z [m]", unit = "m"', 'z = { column = "z [m]", unit = "cm"'))
    assert run_command("follow", other, "--once", "--journal", tmp_path / "a.journal") == 2
    assert "another model or other columns" in capsys.readouterr().err


def test_ctrl_c_ends_it_with_what_is_known_and_the_journal_goes_on(tmp_path: Path) -> None:
    trial = trial_at(tmp_path, LINES[:1001])
    out, json_file = tmp_path / "out", tmp_path / "online_page.json"
    command = [*COMMAND, str(trial), "--out", str(out), "--json", str(json_file), "--page", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        last_resort = threading.Timer(40.0, child.kill)
        last_resort.start()
        heading = child.stdout.readline()
        assert re.search(r"page http://127\.0\.0\.1:\d+/\?token=\S+#onboard", heading)
        time.sleep(0.7)
        with (tmp_path / "voyage_1.csv").open("a") as log:
            log.write("".join(LINES[1001:1201]))
        journal = out / "trial.journal"
        while child.poll() is None and not (journal.exists() and journal.stat().st_size > 1200 * 45):
            time.sleep(0.05)
        time.sleep(2.0)
        os.kill(child.pid, signal.SIGINT)
        said, wrong = child.communicate()
        last_resort.cancel()
    assert child.returncode == 0, wrong
    assert "1200 samples accepted; no faults" in said
    last = json.loads(json_file.read_text())
    assert (last["counts"]["accepted"], last["phase"], len(last["coefficients"])) == (1200, "window", 8)
    assert 0 < last["samples"] <= 1200
    assert json.loads((out / "online.json").read_text()) == json.loads(json_file.read_text())
    assert journal.stat().st_size < 1250 * 45


def test_standard_input_gives_the_same_coefficients(tmp_path: Path, run_command: Callable[..., int]) -> None:
    trial, json_file = trial_at(tmp_path, LINES), tmp_path / "online_page.json"
    assert run_command("follow", trial, "--once", "--json", tmp_path / "file.json") == 0
    command = [*COMMAND, str(trial), "--once", "--source", "stdin", "--json", str(json_file)]
    with (tmp_path / "voyage_1.csv").open() as lines:
        done = subprocess.run(command, stdin=lines, capture_output=True, text=True, timeout=300.0)
    assert done.returncode == 0, done.stderr
    piped, read = (json.loads(path.read_text())["coefficients"] for path in (json_file, tmp_path / "file.json"))
    assert piped == read


@pytest.mark.parametrize(
    "example, units", [("thrusters", ["N/kg", "1/s"]), ("station", ["N", "kg/s"]), ("waterjet", ["1"])]
)
def test_forces_on_each_kilogram_have_the_units_that_identify_prints(example: str, units: list[str]) -> None:
    trial = load_trial(EXAMPLES / f"{example}.toml")
    of_the_model = tuple({"N/kg": "N", "1/s": "kg/s"}.get(unit, unit) for unit in units)
    snapshot = replace(next(iter(mmg(0.0))), units=of_the_model)
    assert list(in_units_of_the_fit(snapshot, trial).units) == units
