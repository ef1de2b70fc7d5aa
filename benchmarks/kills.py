"""Kill commands at random moments and look at what they leave: the old result, the new one, or none.

    python benchmarks/kills.py --command identify --kills 100 --seed 1

A folder of results is whole when it loads (its document names the digest of every data file) and its page is the one
that its document gives, to the byte. Between the kills the command runs with two seeds by turns, so that a mixture of
two results would show. The last run is not killed: nothing that a killed one left may stop it.

`--command save` kills what writes folders and does nothing else, so that every kill falls into the writing: results of
four kinds by turns into one folder, which must be that of one of them, byte by byte.

`--command benchmark` kills a benchmark of methods and starts it again until all kills are spent; runs that were noted
are not made again, and the last table must be that of an undisturbed benchmark.
"""

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.fuzz_targets import result_folders
from benchmarks.measure import Line, at_most

import seatrial as st
from seatrial.core.values.files import write_files_atomically

EXAMPLES = Path(__file__).parents[1] / "examples"
COMMANDS = {
    "identify": ["identify", f"{EXAMPLES}/waterjet.toml"],
    "tune": ["tune", f"{EXAMPLES}/fin_stabiliser.toml"],
    "design": ["design", f"{EXAMPLES}/waterjet_design.toml"],
    "reproduce": ["reproduce", "meng2014", "--quick"],
    "follow": ["follow", f"{EXAMPLES}/waterjet_follow.toml", "--once"],
}
BENCHMARK = ["benchmark", "qi2025-135-whole", "--against", "iwho", "--against", "pso", "--runs", "8"]
SAVE = "save"
_SAVING_S = 0.2  # s at most before a kill while saving: a round of folders takes about as long; chosen
# a kill falls anywhere in the time that the command took undisturbed, and a little beyond: dimensionless, chosen
LONGEST_WAIT = 1.1
# every other kill falls into the last part of that time, where files are written: dimensionless, chosen
WRITING_SHARE = 0.1


@dataclass
class Tally:
    """What was found after the kills."""

    killed: int = 0
    finished_first: int = 0
    none_yet: int = 0
    whole: int = 0
    broken: int = 0


def look_at(folder: Path, tally: Tally) -> None:
    """Count the state of a result folder after a kill."""
    if not folder.exists():
        tally.none_yet += 1
        return
    try:
        page = st.report(folder, folder.parent / "again.html").read_bytes()
        whole = page == (folder / "report.html").read_bytes()
    except st.InputError as error:
        print(f"broken: {error}")
        whole = False
    tally.whole, tally.broken = tally.whole + whole, tally.broken + (not whole)


def _started(command: list[str], seed: int) -> subprocess.Popen[bytes]:
    program = [sys.executable, "-c", "from seatrial.cli import main; main()", *command, "--seed", str(seed)]
    return subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)


def _undisturbed_duration(command: list[str]) -> float:
    """Wall time [s] of a command."""
    began = time.monotonic()
    if _started(command, 0).wait() != 0:
        raise RuntimeError(f"seatrial {' '.join(command)} fails undisturbed")
    return time.monotonic() - began


def kills(name: str, count: int, seed: int) -> tuple[Tally, bool]:
    """Kill a command `count` times; the tally, and whether the undisturbed run afterwards succeeds."""
    rng, tally = random.Random(seed), Tally()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "result"
        command = [*COMMANDS[name], "--out", str(folder)]
        duration = min(_undisturbed_duration([*COMMANDS[name], "--out", f"{place}/timed"]) for _ in range(2))
        for kill in range(count):
            process = _started(command, kill % 2)
            share = rng.random() * (WRITING_SHARE if kill % 2 else 1.0)
            is_killed = _kill_after(process, (LONGEST_WAIT - share) * duration)
            tally.killed, tally.finished_first = tally.killed + is_killed, tally.finished_first + (not is_killed)
            look_at(folder, tally)
        finished = _started(command, 0).wait() == 0
        look_at(folder, tally)
        return tally, finished


def kills_of_benchmark(count: int, seed: int) -> tuple[Tally, bool]:
    """Kill a benchmark `count` times, each time another part of its work; as `kills`.

    A table that a killed process left counts as whole where it is that of an undisturbed benchmark.
    """
    rng, tally = random.Random(seed), Tally()
    with tempfile.TemporaryDirectory() as place:
        undisturbed, folder = Path(place) / "undisturbed", Path(place) / "killed"
        duration = _undisturbed_duration([*BENCHMARK, "--out", str(undisturbed)])
        for _ in range(count):
            process = _started([*BENCHMARK, "--out", str(folder)], 0)
            if not _kill_after(process, rng.random() * LONGEST_WAIT * duration):
                tally.finished_first += 1
                _look_at_table(folder, undisturbed, tally)
                shutil.rmtree(folder)
                continue
            tally.killed += 1
            _look_at_table(folder, undisturbed, tally)
        finished = _started([*BENCHMARK, "--out", str(folder)], 0).wait() == 0
        _look_at_table(folder, undisturbed, tally)
        return tally, finished


def _kill_after(process: subprocess.Popen[bytes], seconds: float) -> bool:
    """Kill a process and those it started; False if it ended before."""
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return True
    return False


def _look_at_table(folder: Path, undisturbed: Path, tally: Tally) -> None:
    if not (folder / "benchmark.json").exists():
        tally.none_yet += 1
        return
    is_whole = _scores(folder) == _scores(undisturbed)
    tally.whole, tally.broken = tally.whole + is_whole, tally.broken + (not is_whole)


def _scores(folder: Path) -> object:
    """The scores of a benchmark without times, which differ between any two runs."""
    problems = json.loads((folder / "benchmark.json").read_text())["problems"]
    for problem in problems:
        for method in problem["methods"]:
            del method["time_ratio"]
    return problems


def kills_while_saving(place: Path, count: int, seed: int) -> tuple[Tally, bool]:
    """Kill a process `count` times that writes folders of results one after another; as `kills`."""
    rng, tally, folder = random.Random(seed), Tally(), place / "result"
    contents = result_folders()
    for _ in range(count):
        process = os.fork()
        if process == 0:
            _save_for_ever(folder, contents)
        time.sleep(rng.random() * _SAVING_S)
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)
        tally.killed += 1
        if not folder.exists():
            tally.none_yet += 1
            continue
        is_whole = {path.name: path.read_bytes() for path in folder.iterdir()} in contents
        tally.whole, tally.broken = tally.whole + is_whole, tally.broken + (not is_whole)
    _save(folder, contents[0])
    return tally, [path.name for path in place.iterdir()] == [folder.name]


def _save_for_ever(folder: Path, contents: Sequence[dict[str, bytes]]) -> NoReturn:
    while True:
        for files in contents:
            _save(folder, files)


def _save(folder: Path, files: dict[str, bytes]) -> None:
    write_files_atomically(folder, files, {path.name for path in folder.iterdir()} if folder.exists() else ())


def run(name: str = "identify", count: int = 20, seed: int = 1) -> list[Line]:
    """The tally as a table."""
    if name == SAVE:
        with tempfile.TemporaryDirectory() as place:
            tally, finished = kills_while_saving(Path(place), count, seed)
    elif name == BENCHMARK[0]:
        tally, finished = kills_of_benchmark(count, seed)
    else:
        tally, finished = kills(name, count, seed)
    return [
        Line(f"{name}: killed", tally.killed, ""),
        Line("finished before the kill", tally.finished_first, ""),
        Line("no result yet", tally.none_yet, ""),
        Line("whole results", tally.whole, ""),
        at_most("half results", tally.broken, "", 0),
        at_most("undisturbed runs stopped by what was left", float(not finished), "", 0),
    ]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--command", choices=[*COMMANDS, BENCHMARK[0], SAVE], default="identify")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    for line in run(options.command, options.kills, options.seed):
        print(f"  {line.quantity:<50} {line.value:>8.0f} {line.verdict}")
