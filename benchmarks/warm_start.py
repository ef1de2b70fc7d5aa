"""Processor time of every command on its example in a process that finds all compiled code, by phase.

Ratios are to the import floor of the same run: the libraries that any such command needs. Bytecode of the modules is
cached, as in an installed package. `python benchmarks/warm_start.py PHASES COMMAND...` is the measured process itself.
"""

import builtins
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any

from measure import Line, at_most, machine

EXAMPLES = Path(__file__).parents[1] / "examples"
FLOOR = "import numpy, scipy.linalg, numba, pandas, pydantic, typer, rich, jinja2"
CHECK_LIMIT, IDENTIFY_LIMIT = 1.1, 3.0  # multiples of the floor, required
REPEATS = 3
# phase -> functions whose time it is, as module and name; what none of them holds is import or rest
PHASES = {
    "read": (("seatrial.data.read.record_file", "read_record"),),
    "check": (("seatrial.data.check.examine", "examined_record"),),
    "identifiability": (
        ("seatrial.estimation.information.symmetries", "structural_symmetries"),
        ("seatrial.estimation.information.symmetries", "refuse_unidentifiable"),
    ),
    "estimate": (("seatrial.estimation.estimate.fit", "estimate_model"),),
    "predict": (("seatrial.estimation.predict.predict_runs", "predict_runs"),),
    "report": (("seatrial.reporting.pages", "report_page"),),
}


class Stopwatch:
    """Processor time of this process by phase; a phase within another one is not counted in that."""

    def __init__(self) -> None:
        self.seconds: Counter[str] = Counter()
        self._open, self._since = ["rest"], 0.0

    def _book(self) -> None:
        now = time.process_time()
        self.seconds[self._open[-1]] += now - self._since
        self._since = now

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Count the time of the body to a phase."""
        self._book()
        self._open.append(name)
        try:
            yield
        finally:
            self._book()
            self._open.pop()

    def timed(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function with its time counted to a phase."""

        @wraps(function)
        def call(*arguments: Any, **options: Any) -> Any:
            with self.phase(name):
                return function(*arguments, **options)

        return call

    def watch_imports(self) -> None:
        """Count imports, and replace the functions of the phases as soon as their modules are there."""
        plain, pending = builtins.__import__, {pair: name for name, pairs in PHASES.items() for pair in pairs}

        def timed_import(*arguments: Any, **options: Any) -> Any:
            with self.phase("import"):
                module = plain(*arguments, **options)
            for (place, function), name in list(pending.items()):
                original = vars(sys.modules[place]).get(function) if place in sys.modules else None
                if original is not None:
                    _replace_everywhere(function, original, self.timed(name, original))
                    del pending[place, function]
            return module

        builtins.__import__ = timed_import


def _replace_everywhere(name: str, original: object, replacement: object) -> None:
    """In every module of the package that holds the function: packages hand out what they export."""
    for place, module in list(sys.modules.items()):
        if place.startswith("seatrial") and vars(module).get(name) is original:
            vars(module)[name] = replacement


def measured(command: list[str]) -> None:
    """Run a command in this process and print its phases as the last line of the error output."""
    stopwatch = Stopwatch()
    stopwatch.watch_imports()
    sys.argv = ["seatrial", *command]
    try:
        from seatrial.cli import main

        main()
    except SystemExit as end:
        if end.code:
            raise
    with stopwatch.phase("rest"):
        print(json.dumps(stopwatch.seconds), file=sys.stderr)


def warm(command: list[str], environment: dict[str, str]) -> dict[str, float]:
    """Phases [s] of the fastest of several runs, after one that fills the caches."""
    program = [sys.executable, __file__, "PHASES", *command]
    runs = []
    for _ in range(1 + REPEATS):
        done = subprocess.run(program, env=environment, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"seatrial {' '.join(command)} failed:\n{done.stderr}")
        runs.append(json.loads(done.stderr.splitlines()[-1]))
    return min(runs[1:], key=lambda phases: sum(phases.values()))


def floor(environment: dict[str, str]) -> float:
    """Processor time [s] of importing the libraries."""
    program = f"{FLOOR}\nimport time\nprint(time.process_time())"
    runs = [subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True) for _ in range(4)]
    return min(float(done.stdout) for done in runs[1:])


def _write_two_fronts(folder: Path) -> None:
    """Write the loop file of the fins without schedule and trials at sea: the fronts of its two structures."""
    text = (EXAMPLES / "fin_stabiliser.toml").read_text(encoding="utf-8")
    made = f"{text[: text.index('[schedule]')]}[simulation]\nseeds = 0\n"
    (folder / "two_fronts.toml").write_text(made, encoding="utf-8")


def commands(folder: Path) -> dict[str, list[str]]:
    """Every command on its example, writing below a folder; some read what `identify` wrote."""
    fit = folder / "fit"
    return {
        "check": ["check", f"{EXAMPLES}/waterjet.toml"],
        "identify": ["identify", f"{EXAMPLES}/waterjet.toml", "--out", str(fit)],
        "simulate": ["simulate", f"{fit}/model.toml", "--manoeuvre", "zigzag:20/20", "--set", "v_j=1.866",
                     "--out", f"{folder}/zigzag.csv"],
        "report": ["report", str(fit)],
        "design": ["design", f"{EXAMPLES}/waterjet_design.toml", "--out", f"{folder}/design"],
        "tune": ["tune", f"{EXAMPLES}/waterjet_autopilot.toml", "--from", f"{fit}/model.toml",
                 "--out", f"{folder}/tuning"],
        "fins": ["tune", f"{EXAMPLES}/fin_stabiliser.toml", "--out", f"{folder}/fins"],
        "fronts": ["tune", str(folder / "two_fronts.toml"), "--out", f"{folder}/fronts"],
        "follow": ["follow", f"{EXAMPLES}/waterjet_follow.toml", "--once", "--out", f"{folder}/followed"],
    }  # fmt: skip


def run(names: tuple[str, ...] = ("check", "identify", "simulate", "report")) -> list[Line]:
    """Total and ratio of each command, and its phases."""
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": f"{folder}/bytecode"}
        environment["OPENBLAS_NUM_THREADS"] = "1"  # as the command line sets it, also for the floor
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        _write_two_fronts(Path(folder))
        for name in names:
            least = floor(environment)  # beside each command: other work on the machine slows both
            lines.append(Line(f"imports alone, before {name}", least, "s"))
            phases = warm(commands(Path(folder))[name], environment)
            total = sum(phases.values())
            limit = {"check": CHECK_LIMIT, "identify": IDENTIFY_LIMIT}.get(name)
            quantity = f"{name}, of the imports alone"
            lines.append(at_most(quantity, total / least, "x", limit) if limit else Line(quantity, total / least, "x"))
            lines += [Line(f"  {phase}", seconds, "s") for phase, seconds in phases.items() if seconds >= 0.005]
    return lines


if __name__ == "__main__":
    if sys.argv[1:2] == ["PHASES"]:
        measured(sys.argv[2:])
    else:
        print(machine())
        for line in run(tuple(sys.argv[1:]) or tuple(commands(Path()))):
            print(f"  {line.quantity:<40} {line.value:>8.3f} {line.unit:<3} {line.verdict}", flush=True)
