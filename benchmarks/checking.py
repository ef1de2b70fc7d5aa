"""Cost of reading and checking a long log: a million rows of twelve columns, against pandas on the same file.

`python benchmarks/checking.py [ROWS]`. Processor time of whole processes and of reading; memory at its peak above that
at the start of reading, in sizes of the array that the numbers of the file fill (8 bytes each).
"""

import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from measure import Line, at_most, machine

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.data.check.ship import zigzag

ROWS, COLUMNS = 1_000_000, 12
READ_LIMIT, CHECK_LIMIT_S, MEMORY_LIMIT = 1.5, 12.0, 4.0  # times pandas, s of CPU, times the array: required
REPEATS = 5
UNITS = {"x0": "m", "y0": "m", "psi": "rad", "u": "m/s", "v": "m/s", "r": "rad/s", "delta": "rad", "n": "rps",
         "phi": "rad", "wind_speed": "m/s", "wind_direction": "rad"}  # fmt: skip
COMMAND = "from seatrial.cli import main; main()"
# what a fresh process does: the memory at its start [bytes], then the work, then the peak (Linux)
CHILD = """
import re, resource
from pathlib import Path
from seatrial import api
from seatrial.data.draft import survey_log
from seatrial.data.trial import load_runs
import pandas
pandas.to_datetime(pandas.Series(["2026-05-14T09:20:00Z"]), utc=True)  # loads what it needs
def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
start = resident()
{work}
peak = re.search(r"VmHWM:\\s*(\\d+) kB", Path("/proc/self/status").read_text())
print(int(peak[1]) * 1024 - start)
"""


def write_files(folder: Path, rows: int) -> tuple[Path, Path]:
    """Write the log of a zigzag with noise, once with seconds and once with ISO time; six digits a number."""
    import pandas as pd

    ship, generator = zigzag(0.3, count=rows, noise=1.0), np.random.default_rng(2)
    columns = {symbol: ship[symbol] if symbol in ship else generator.normal(size=rows) for symbol in UNITS}
    frame = pd.DataFrame({"time": ship.time, **columns}).round(6)
    paths = folder / "seconds.csv", folder / "iso.csv"
    frame.to_csv(paths[0], index=False)
    stamps = pd.Timestamp("2026-05-14T09:20:00Z") + pd.to_timedelta(ship.time, unit="s")
    frame["time"] = stamps.strftime("%Y-%m-%dT%H:%M:%S.%f").str[:-3] + "Z"
    frame.to_csv(paths[1], index=False)
    for path in paths:
        channels = "\n".join(f'channels.{s} = {{ column = "{s}", unit = "{unit}" }}' for s, unit in UNITS.items())
        text = f'[[records]]\nfiles = "{path.name}"\ntime = {{ column = "time" }}\n{channels}\n'
        path.with_suffix(".toml").write_text(text, encoding="utf-8")
    return paths


def cpu_time(function: Callable[[], object], repeats: int = REPEATS) -> float:
    """Least processor time of several calls [s]."""
    spent = []
    for _ in range(repeats):
        began = time.process_time()
        function()
        spent.append(time.process_time() - began)
    return min(spent)


def child_cost(*command: str) -> tuple[float, str]:
    """Return processor time [s] and output of a process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, *command], capture_output=True, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def reading_lines(paths: tuple[Path, Path]) -> list[Line]:
    """Reading by a trial file, against pandas with the same columns as numbers."""
    import pandas as pd

    from seatrial.data.read import read_record
    from seatrial.data.trial import load_runs

    def with_dates() -> None:
        pd.to_datetime(pd.read_csv(paths[1])["time"], utc=True)

    lines = []
    for path, plain, kind in (
        (paths[0], lambda: pd.read_csv(paths[0]), "seconds"), (paths[1], with_dates, "ISO time, to_datetime")
    ):  # fmt: skip
        (run,) = load_runs(path.with_suffix(".toml"))
        (file,) = run.files
        read = partial(read_record, file.path, file.layout)
        ratio = cpu_time(read) / cpu_time(plain)
        lines.append(at_most(f"reading over pandas, {kind}", ratio, "", READ_LIMIT))
    return lines


def run(rows: int = ROWS) -> list[Line]:
    """Reading, then whole checks of the trial file and of the bare log, in processes of their own."""
    array = 8.0 * rows * COLUMNS  # bytes of a float64
    with tempfile.TemporaryDirectory() as folder:
        paths = write_files(Path(folder), rows)
        lines = reading_lines(paths)
        for path in paths:
            trial = path.with_suffix(".toml")
            for name, file in ((f"trial, {path.stem}", trial), (f"bare log, {path.stem}", path)):
                seconds, _ = child_cost("-c", COMMAND, "check", str(file))
                lines.append(at_most(f"check of a {name}: CPU time", seconds, "s", CHECK_LIMIT_S))
                work = f"api.check({str(file)!r})" if file is trial else f"survey_log(Path({str(file)!r}))"
                peak = float(child_cost("-c", CHILD.format(work=work))[1].split()[-1])
                lines.append(at_most(f"check of a {name}: peak memory", peak / array, "arrays", MEMORY_LIMIT))
    return lines


if __name__ == "__main__":
    print(machine())
    for line in run(int(sys.argv[1]) if len(sys.argv) > 1 else ROWS):
        print(f"{line.quantity:<46} {line.value:>8.3g} {line.unit:<8} {line.verdict}", flush=True)
