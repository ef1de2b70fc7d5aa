"""Peak memory of each command on its example, and on ten times the data.

`python benchmarks/memory.py [command ...]` measures the named commands only. Ten times the data are the example's
records at ten times their rate, interpolated, or ten times the runs of a benchmark or a campaign. Each command runs in
a process of its own; what is printed is the largest resident memory of that process (readers of binary formats are
others), and that of a process that only imports the libraries.
"""

import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from measure import Line, machine

EXAMPLES = Path(__file__).parents[1] / "examples"
FACTOR = 10
RUNS = 3
"""Runs of a benchmark or a campaign; ten times as many beside them. Chosen: each takes seconds."""
_KIB = 1024  # bytes in the unit of ru_maxrss on Linux (getrusage(2)); macOS counts bytes
COMMANDS = {
    "init": ["init", "{data}/waterjet", "--out", "{out}.toml"],
    "check": ["check", "{data}/waterjet.toml"],
    "identify": ["identify", "{data}/waterjet.toml", "--out", "{out}"],
    "follow": ["follow", "{data}/waterjet_follow.toml", "--once", "--out", "{out}"],
    "report": ["report", "{fit}"],
    "simulate": ["simulate", "{fit}/model.toml", "--manoeuvre", "zigzag:20/20", "--out", "{out}.csv"],
    "design": ["design", "{data}/waterjet_design.toml", "--out", "{out}"],
    "tune": ["tune", "{data}/waterjet_autopilot.toml", "--from", "{fit}/model.toml", "--out", "{out}"],
    "compare": ["compare", "{fit}", "{fit}", "--out", "{out}"],
    "export": ["export", "{fit}/model.toml", "--to", "c99", "--out", "{out}"],
    "models": ["models"],
    "benchmark": [
        "benchmark", "yu2014-3-printed", "--against", "iwho", "--runs", "{runs}", "--workers", "1", "--out", "{out}",
    ],
    "campaign": ["campaign", "run", "{plan}", "--workers", "1", "--out", "{out}"],
    "reproduce": ["reproduce", "yu2014", "--quick", "--out", "{out}"],
}  # fmt: skip
# a process inherits the peak of the one that starts it: this one is small
_LAUNCHER = """
import os, subprocess, sys
process = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
_, status, usage = os.wait4(process.pid, 0)
print(os.waitstatus_to_exitcode(status), usage.ru_maxrss)
"""
# what they take does not grow with a record or with a number of runs
_WITHOUT_RECORDS = ("simulate", "design", "tune", "reproduce", "models", "export")


def peak_memory(program: list[str]) -> float:
    """Return the largest resident memory of a process [bytes].

    Raises:
        RuntimeError: it fails.
    """
    done = subprocess.run([sys.executable, "-c", _LAUNCHER, *program], capture_output=True, check=False, text=True)
    code, size = map(int, done.stdout.split()[-2:])
    if code != 0:
        raise RuntimeError(f"{' '.join(program[-6:])} ends with {code}")
    return float(size) * (1 if sys.platform == "darwin" else _KIB)


def finer_records(target: Path) -> None:
    """Write the waterjet's records at ten times their rate, and the example's files that name them."""
    (target / "waterjet").mkdir(parents=True)
    for source in sorted((EXAMPLES / "waterjet").glob("*.csv")):
        header, *_ = source.read_text().splitlines()
        table = np.loadtxt(source, delimiter=",", skiprows=1)
        time = np.linspace(table[0, 0], table[-1, 0], FACTOR * (len(table) - 1) + 1)
        columns = [np.interp(time, table[:, 0], column) for column in table.T[1:]]
        finer = np.column_stack([time, *columns])
        np.savetxt(target / "waterjet" / source.name, finer, "%.9g", ",", header=header, comments="")
    for trial in EXAMPLES.glob("waterjet*.toml"):
        text = re.sub(r"^rate = (\d+).*$", lambda m: f"rate = {FACTOR * int(m[1])}", trial.read_text(), flags=re.M)
        (target / trial.name).write_text(text)


def plan_of(runs: int, target: Path) -> Path:
    """Write the example of a campaign with so many runs."""
    text = (EXAMPLES / "coverage.toml").read_text()
    target.write_text(re.sub(r"^seeds = \d+$", f"seeds = {runs}", text, flags=re.M))
    return target


def run(names: Sequence[str] = ()) -> list[Line]:
    """Peak memory as a table, MB."""
    program = [sys.executable, "-c", "from seatrial.cli import main; main()"]
    imports = "import numpy, scipy.optimize, numba, pandas, pydantic, typer"
    lines = [Line("importing the libraries alone", peak_memory([sys.executable, "-c", imports]) / 1e6, "MB")]
    with tempfile.TemporaryDirectory() as place:
        finer_records(Path(place) / "finer")
        fits = {}
        for size, data, runs in (
            ("", EXAMPLES, RUNS),
            (f", {FACTOR} times the data", Path(place) / "finer", FACTOR * RUNS),
        ):
            fits[size] = f"{place}/fit{len(fits)}"
            subprocess.run([*program, "identify", f"{data}/waterjet.toml", "--out", fits[size]], capture_output=True)
            for name in names or COMMANDS:
                if size and name in _WITHOUT_RECORDS:
                    continue
                plan = plan_of(runs, Path(place) / f"plan{len(fits)}.toml")
                values = {
                    "data": data,
                    "fit": fits[size],
                    "out": f"{place}/{name}{len(fits)}",
                    "runs": runs,
                    "plan": plan,
                }
                arguments = [part.format(**values) for part in COMMANDS[name]]
                lines.append(Line(name + size, peak_memory([*program, *arguments]) / 1e6, "MB"))
                print(f"  {lines[-1].quantity:<40} {lines[-1].value:>8.0f} MB", flush=True)
    return lines


if __name__ == "__main__":
    print(machine())
    run(sys.argv[1:])
