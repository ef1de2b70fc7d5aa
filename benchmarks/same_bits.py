"""The same seed gives the same bits: one and two threads, the order of sets and dicts, a cold and a warm cache.

`python benchmarks/same_bits.py [example ...]` runs the command of each example, by default one of each kind, once in
each circumstance, and compares every file of the result's folder byte by byte, but for the time that it took.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from measure import Line, at_most, machine

EXAMPLES = Path(__file__).parents[1] / "examples"
DEFAULT = {
    "fin_decay": ("identify",),
    "waterjet": ("identify",),
    "fin_stabiliser": ("tune",),
    "heave_pitch_design": ("design",),
    "heave_pitch_follow": ("follow", "--once"),
}
"""Example -> command with its options."""
CIRCUMSTANCES: dict[str, dict[str, str]] = {
    "one thread": {"OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"},
    "two threads": {"NUMBA_NUM_THREADS": "2"},
    "hash seed 1": {"PYTHONHASHSEED": "1"},
    "hash seed 2": {"PYTHONHASHSEED": "2"},
    "cold cache": {"SEATRIAL_CACHE": "cold"},
    "the same cache, warm": {"SEATRIAL_CACHE": "cold"},
}
"""Variables of the environment in each; a cache is called by the name of its folder."""
_TIME = re.compile(
    rb'"(elapsed_s|cpu_s|(compiled|lsim)_(record_s|ratio))": [^,}\n]+|[0-9.]+ s of computing'
)  # what may differ


def command_of(trial: Path) -> list[str]:
    """Return the command of an example without its folder of results; of others it is `identify`."""
    name, *options = DEFAULT.get(trial.stem, ("identify",))
    return [name, str(trial), *options]


def folder_bytes(trial: Path, place: Path, environment: dict[str, str]) -> dict[str, bytes]:
    """Return name and content of the files that the command of an example writes, without times.

    Raises:
        RuntimeError: the command fails.
    """
    if cache := environment.get("SEATRIAL_CACHE"):
        environment = environment | {"SEATRIAL_CACHE": str(place / cache)}
        (place / cache).mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=place) as out:
        program = [sys.executable, "-c", "from seatrial.cli import main; main()", *command_of(trial)]
        done = subprocess.run(
            [*program, "--out", f"{out}/result"], env=os.environ | environment, capture_output=True, check=False
        )
        if done.returncode != 0:
            raise RuntimeError(f"{trial.name} ends with {done.returncode}: {done.stderr.decode()[-200:]}")
        files = sorted(Path(out, "result").iterdir())
        return {file.name: _TIME.sub(b"", file.read_bytes()) for file in files if file.suffix != ".html"}


def differences(trial: Path, circumstances: dict[str, dict[str, str]]) -> list[str]:
    """Return the circumstances in which a file differs from those of the first."""
    with tempfile.TemporaryDirectory() as place:
        results = {name: folder_bytes(trial, Path(place), more) for name, more in circumstances.items()}
    first = next(iter(results.values()))
    return [
        f"{name}: {', '.join(file for file in first if content.get(file) != first[file])}"
        for name, content in results.items()
        if content != first
    ]


def run(names: tuple[str, ...] = tuple(DEFAULT)) -> list[Line]:
    """Circumstances with other bits, as a table."""
    lines = []
    for name in names:
        differing = differences(EXAMPLES / f"{name}.toml", CIRCUMSTANCES)
        print("\n".join(differing), end="\n" if differing else "")
        lines.append(at_most(f"{name}: of {len(CIRCUMSTANCES)} circumstances with other bits", len(differing), "", 0))
    return lines


if __name__ == "__main__":
    print(machine())
    for line in run(tuple(sys.argv[1:]) or tuple(DEFAULT)):
        print(f"  {line.quantity:<50} {line.value:>4.0f} {line.verdict}")
