"""Kill commands at random moments and look at what they leave: the old result, the new one, or none.

    python benchmarks/kills.py --command identify --kills 100 --seed 1

The commands work on the smallest inputs that still give every file of their folders (`kills_inputs`), in copies of a
process that has imported what they need, so that kills fall into their work. Half of the kills fall anywhere in the
time of a command, the others into its last act: while the folder of its result is written.

A folder of results is whole when it loads (its document names the digest of every data file) and its page is the one
that its document gives, to the byte. Between the kills the command runs with two seeds by turns, so that a mixture of
two results would show. The last run is not killed: nothing that a killed one left may stop it, or stay beside the
result. `follow` keeps a journal, reads it back after each kill, and must arrive at the coefficients of an undisturbed
run.

`--command save` kills what writes folders and does nothing else, so that every kill falls into the writing: results of
four kinds by turns into one folder, which must be that of one of them, byte by byte.

`--command benchmark` kills a benchmark of methods and starts it again until all kills are spent; runs that were noted
are not made again, and the last table must be that of an undisturbed benchmark.
"""

import argparse
import importlib
import itertools
import json
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.fuzz_targets import result_folders
from benchmarks.measure import Line, at_most

import seatrial as st
from seatrial.cli import main
from seatrial.core.values.files import write_files_atomically

INPUTS = Path(__file__).parent / "kills_inputs"
EXAMPLES = Path(__file__).parents[1] / "examples"
STUDY = "nomoto1957"
COMMANDS = {
    "identify": ["identify", f"{EXAMPLES}/fin_decay.toml"],
    "tune": ["tune", f"{INPUTS}/loop.toml"],
    "design": ["design", f"{INPUTS}/design.toml"],
    "reproduce": ["reproduce", STUDY],
    "follow": ["follow", f"{INPUTS}/follow.toml", "--once"],
}
BENCHMARK = ["benchmark", "yu2014-3-printed", "--against", "random", "--runs", "6", "--workers", "1"]
SAVE = "save"
_SAVING_S = 0.2  # s at most before a kill while saving: a round of folders takes about as long; chosen
# s at most after its draft appeared: what a folder of a small result takes to write and flush, measured 20 to 50 ms
_WRITING_S = 0.05
LONGEST_WAIT = 1.1
"""Up to where in the time that a command took undisturbed a kill may fall: a little beyond its end; chosen."""
_LOOK_S = 5e-4  # s between two looks at a command, whose draft stands for some ten milliseconds; chosen
_LONGEST_RUN_S = 600.0  # s: nothing that a killed command left may keep the next one waiting; chosen


@dataclass
class Tally:
    """What was found after the kills.

    Attributes:
        killed: commands killed.
        killed_writing: those of them of whose result a draft stood.
        finished_first: commands that ended before their kill.
        refused: those of them that ended without a result.
        none_yet: kills after which there was no result.
        whole: kills and ends after which there was one that is whole.
        broken: those after which there was one that is not.
        leftovers: names beside the result after the last, undisturbed run.
    """

    killed: int = 0
    killed_writing: int = 0
    finished_first: int = 0
    refused: int = 0
    none_yet: int = 0
    whole: int = 0
    broken: int = 0
    leftovers: list[str] = field(default_factory=list)


@dataclass
class Witness:
    """Looks at the folder of a command's results after each kill; a folder that it has seen whole it knows again."""

    folder: Path
    tally: Tally
    seen_whole: dict[str, bytes] = field(default_factory=dict)

    def look(self) -> None:
        """Count the state of the folder."""
        if not self.folder.exists():
            self.tally.none_yet += 1
            return
        files = {path.name: path.read_bytes() for path in self.folder.iterdir()}
        is_whole = files == self.seen_whole or self._renders_its_page()
        self.seen_whole = files if is_whole else {}
        self.tally.whole, self.tally.broken = self.tally.whole + is_whole, self.tally.broken + (not is_whole)

    def _renders_its_page(self) -> bool:
        try:
            with tempfile.TemporaryDirectory() as place:
                page = st.report(self.folder, Path(place) / "again.html").read_bytes()
        except st.InputError as error:
            print(f"broken: {error}")
            return False
        return page == (self.folder / "report.html").read_bytes()


class Copy:
    """A copy of this process that runs a command, and ends with it."""

    def __init__(self, command: list[str], seed: int, modules: Path | None = None) -> None:
        """modules: a file for the names of all modules that are imported at its end."""
        self.exit_code: int | None = None
        self._id = os.fork()
        if self._id == 0:
            _run_and_exit([*command, "--seed", str(seed)], modules)
        with suppress(OSError):  # it has done so itself
            os.setpgid(self._id, self._id)

    def wait(self, seconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Wait until it ends, or `until` holds, or so long [s], and return whether it has ended."""
        end = time.monotonic() + seconds
        while self.exit_code is None and time.monotonic() < end and not until():
            time.sleep(_LOOK_S)
            ended, status = os.waitpid(self._id, os.WNOHANG)
            self.exit_code = os.waitstatus_to_exitcode(status) if ended else None
        return self.exit_code is not None

    def kill(self) -> None:
        """Kill it and those that it has started."""
        os.killpg(self._id, signal.SIGKILL)
        os.waitpid(self._id, 0)


def _run_and_exit(command: list[str], modules: Path | None) -> NoReturn:
    code = 1
    try:
        os.setpgid(0, 0)
        nowhere = os.open(os.devnull, os.O_RDWR)
        for descriptor in range(3):  # standard input, output and error
            os.dup2(nowhere, descriptor)
        sys.argv = ["seatrial", *command]
        main()
    except SystemExit as ending:
        code = ending.code if isinstance(ending.code, int) else 0
        if modules is not None:
            modules.write_text("\n".join(sys.modules))
    finally:
        os._exit(code)


@contextmanager
def installed_study() -> Iterator[None]:
    """Install the study that is an example to contributors, which takes a second, in this process."""
    with tempfile.TemporaryDirectory() as place:
        shutil.copy(EXAMPLES / "contributions" / "turning_study.py", place)
        metadata = Path(place) / "turning_study-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: turning_study\nVersion: 1.0\n")
        (metadata / "entry_points.txt").write_text(f"[seatrial.studies]\n{STUDY} = turning_study:study\n")
        sys.path.append(place)
        try:
            yield
        finally:
            sys.path.remove(place)


def _succeeds(command: list[str], modules: Path | None = None) -> bool:
    copy = Copy(command, 0, modules)
    if copy.wait(_LONGEST_RUN_S):
        return copy.exit_code == 0
    copy.kill()
    return False


def undisturbed_duration(command: list[str], place: Path) -> float:
    """Import what a command needs and return its wall time [s] undisturbed.

    Raises:
        RuntimeError: it fails.
    """
    modules = place / "modules"
    for name in ["seatrial", *(modules.read_text().split("\n") if _succeeds(command, modules) else ())]:
        with suppress(Exception):  # names that a library gives to what is no module
            importlib.import_module(name)
    began = time.monotonic()
    if not _succeeds(command):
        raise RuntimeError(f"seatrial {' '.join(command)} fails undisturbed")
    return time.monotonic() - began


def kills(name: str, count: int, seed: int) -> Tally:
    """Kill a command `count` times, and run it undisturbed to its end."""
    rng, tally = random.Random(seed), Tally()
    with tempfile.TemporaryDirectory() as place, installed_study():
        once = Path(place) / "once"
        duration = undisturbed_duration(_command(name, once), Path(place))
        place_of_result = Path(place) / "results"
        place_of_result.mkdir()
        folder = place_of_result / "result"
        witness, command = Witness(folder, tally), _command(name, folder)
        journal = _journal(folder)
        for kill in itertools.takewhile(lambda _: tally.killed < count, itertools.count()):
            copy = Copy(command, kill % 2)
            if kill % 4 < 2:
                is_killed = _kill_after(copy, rng.random() * LONGEST_WAIT * duration, tally)
            else:
                copy.wait(_LONGEST_RUN_S, lambda: _has_draft(place_of_result))
                is_killed = _kill_after(copy, rng.random() * _WRITING_S, tally)
            tally.killed_writing += is_killed and _has_draft(place_of_result)
            witness.look()
            if not is_killed:
                journal.unlink(missing_ok=True)
        tally.refused += not _succeeds(command)
        witness.look()
        journal.unlink(missing_ok=True)
        tally.leftovers = [path.name for path in place_of_result.iterdir() if path != folder]
        tally.broken += _coefficients(folder) != _coefficients(once)
        return tally


def _command(name: str, folder: Path) -> list[str]:
    journal = ["--journal", str(_journal(folder))] if name == "follow" else []
    return [*COMMANDS[name], "--out", str(folder), *journal]


def _journal(folder: Path) -> Path:
    return folder.with_suffix(".journal")


def _coefficients(folder: Path) -> object:
    """The estimates of a fit's folder; None for other results."""
    path = folder / "result.json"
    return json.loads(path.read_text())["coefficients"] if path.exists() else None


def kills_of_benchmark(count: int, seed: int) -> Tally:
    """Kill a benchmark `count` times, each time another part of its work; as `kills`.

    A table that a killed process left counts as whole where it is that of an undisturbed benchmark, and its page, where
    there is one, that of the table.
    """
    rng, tally = random.Random(seed), Tally()
    with tempfile.TemporaryDirectory() as place:
        undisturbed, folder = Path(place) / "undisturbed", Path(place) / "killed"
        duration = undisturbed_duration([*BENCHMARK, "--out", str(Path(place) / "timed")], Path(place))
        _succeeds([*BENCHMARK, "--out", str(undisturbed)])
        while tally.killed < count:
            copy = Copy([*BENCHMARK, "--out", str(folder)], 0)
            is_killed = _kill_after(copy, rng.random() * LONGEST_WAIT * duration, tally)
            _look_at_table(folder, undisturbed, tally)
            if not is_killed:
                shutil.rmtree(folder)
        tally.refused += not _succeeds([*BENCHMARK, "--out", str(folder)])
        _look_at_table(folder, undisturbed, tally)
        return tally


def _kill_after(copy: Copy, seconds: float, tally: Tally) -> bool:
    """Kill a command unless it ends before, and return whether that was done."""
    if copy.wait(seconds):
        tally.finished_first += 1
        tally.refused += copy.exit_code != 0
        return False
    copy.kill()
    tally.killed += 1
    return True


def _has_draft(place: Path) -> bool:
    return any(".writing-" in name for name in os.listdir(place))  # noqa: PTH208  looked at two thousand times a second


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


def kills_while_saving(place: Path, count: int, seed: int) -> Tally:
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
        tally.killed_writing += _has_draft(place)
        if not folder.exists():
            tally.none_yet += 1
            continue
        is_whole = {path.name: path.read_bytes() for path in folder.iterdir()} in contents
        tally.whole, tally.broken = tally.whole + is_whole, tally.broken + (not is_whole)
    _save(folder, contents[0])
    tally.leftovers = [path.name for path in place.iterdir() if path != folder]
    return tally


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
            tally = kills_while_saving(Path(place), count, seed)
    else:
        tally = kills_of_benchmark(count, seed) if name == BENCHMARK[0] else kills(name, count, seed)
    return [
        Line(f"{name}: killed", tally.killed, ""),
        Line(f"{name}: of them while a folder was written", tally.killed_writing, ""),
        Line(f"{name}: finished before the kill", tally.finished_first, ""),
        Line(f"{name}: no result yet", tally.none_yet, ""),
        Line(f"{name}: whole results", tally.whole, ""),
        at_most(f"{name}: half results", tally.broken, "", 0),
        at_most(f"{name}: runs stopped by what was left", tally.refused, "", 0),
        at_most(f"{name}: leftovers beside the result", len(tally.leftovers), "", 0),
    ]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--command", choices=[*COMMANDS, BENCHMARK[0], SAVE], default="identify")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    for line in run(options.command, options.kills, options.seed):
        print(f"  {line.quantity:<50} {line.value:>8.0f} {line.verdict}", flush=True)
