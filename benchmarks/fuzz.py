"""Feed every parser, and `identify` itself, with damaged inputs: each must give a result or one clear sentence.

    python benchmarks/fuzz.py --inputs 2000000 --seed 1 [--target trial] [--finds FOLDER]

Inputs are well-formed samples and those of `fuzz_corpus` after random changes; the same seed gives the same ones. They
run in a child process without the net that `seatrial` spreads below unexpected exceptions, so that each of them counts:
a traceback, a warning of a library, a message of many lines, a NaN or infinity that nothing announces, 20 s of
processor time, the death of the process. One input for each different find is written to FOLDER; moved to `fuzz_corpus`
it is a sample from then on, and stays one when its cause has been corrected.
"""

import argparse
import math
import mmap
import os
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.fuzz_mutations import mutated
from benchmarks.fuzz_targets import TARGETS
from benchmarks.measure import Line, at_most

from seatrial.core.values import InputError, Record

CORPUS = Path(__file__).parent / "fuzz_corpus"
CPU_LIMIT_S = 20.0  # of one input: the inputs are tiny; an aim of this benchmark
WAIT_LIMIT_S = 600.0  # between two inputs: a child that waits for something and computes nothing; chosen
MESSAGE_LENGTH = 600  # letters: eight lines of a terminal; the command line cuts longer ones
INTERVAL_S = 0.2  # between two looks at a child; chosen
LEAST_SHARE = 1e-4  # of all inputs that the dearest target gets: 200 of two million; chosen
KINDS_OF_FIND = ("traceback", "hang", "death", "silent number", "warning", "message")
_COUNTER = struct.Struct("<q")


@dataclass
class Tally:
    """What was found: kind of find -> one line about each different one, with how often it occurred."""

    inputs: int = 0
    finds: dict[str, Counter[str]] = field(default_factory=dict)

    def add(self, kind: str, text: str) -> None:
        """Count a find."""
        self.finds.setdefault(kind, Counter())[text] += 1


def samples_of(name: str) -> list[bytes]:
    """Return the inputs that those of a target are made from."""
    return [*TARGETS[name].samples(), *(path.read_bytes() for path in sorted((CORPUS / name).glob("*")))]


def input_of(name: str, samples: list[bytes], seed: int, index: int) -> bytes:
    """Return an input of a target."""
    return mutated(samples, random.Random(f"{name} {seed} {index}"))


def finds_of(name: str, data: bytes) -> list[tuple[str, str]]:
    """Run an input and return what is wrong: kind and text of each find."""
    with _empty_folder() as place, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = []
        try:
            if text := hidden_number(TARGETS[name].run(data, place)):
                found.append(("silent number", text))
        except InputError as error:
            if len(str(error)) > MESSAGE_LENGTH or not str(error).strip():
                found.append(("message", f"too long: {_place(error)}"))
        except Exception as error:
            found.append(("traceback", f"{type(error).__name__}: {_place(error)} {str(error)[:80]!r}"))
    return [*found, *(("warning", f"{Path(w.filename).name}:{w.lineno} {w.message}") for w in caught)]


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    """The folder of this process, removed when it ends."""
    return tempfile.TemporaryDirectory()


@contextmanager
def _empty_folder() -> Iterator[Path]:
    """Give a folder that is empty, and empty it again: quicker than a new one for each input."""
    place = Path(_folder().name)
    try:
        yield place
    finally:
        for entry in os.scandir(place):
            shutil.rmtree(entry) if entry.is_dir(follow_symlinks=False) else Path(entry).unlink()


def hidden_number(value: object) -> str:
    """Return the first number of a result that is not finite; of a record, infinity and a channel without a number."""
    if isinstance(value, Record):
        channels = ((s, value[s]) for s in value.channels)
        return next((f"channel {s}" for s, v in channels if np.isinf(v).any() or np.isnan(v).all()), "")
    if isinstance(value, np.ndarray):
        return "" if np.isfinite(value).all() else "an array"
    if isinstance(value, float):
        return "" if math.isfinite(value) else repr(value)
    if isinstance(value, Mapping):
        value = list(value.values())
    if isinstance(value, Iterable) and not isinstance(value, str | bytes):
        return next((text for inner in value if (text := hidden_number(inner))), "")
    return ""


def _place(error: BaseException) -> str:
    """The line of the package in which an exception arose, and the last line of all."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if "seatrial" in frame.filename]
    names = [f"{Path(frame.filename).name}:{frame.lineno}" for frame in (*ours[-1:], frames[-1])]
    return " < ".join(dict.fromkeys(names))


def serve(name: str, seed: int, first: int, count: int, counter: Path, finds: Path) -> None:
    """Run inputs of a target one after another; the counter file says which, a line of output each find."""
    samples = samples_of(name)
    for data in TARGETS[name].samples():  # compiled code and imports do not count towards the limit
        finds_of(name, data)
    with counter.open("r+b") as file, mmap.mmap(file.fileno(), _COUNTER.size) as memory:
        for index in range(first, first + count):
            _COUNTER.pack_into(memory, 0, index)
            data = input_of(name, samples, seed, index)
            signal.setitimer(signal.ITIMER_VIRTUAL, CPU_LIMIT_S)
            for kind, text in finds_of(name, data):
                _keep(finds, name, kind, text, data)
                print(f"{index}\t{kind}\t{' '.join(text.split())}", flush=True)
        _COUNTER.pack_into(memory, 0, first + count)


def _keep(folder: Path, name: str, kind: str, text: str, data: bytes) -> None:
    """Write an input to the folder of finds, the first of each find only."""
    path = folder / name / "".join(c if c.isalnum() else "_" for c in f"{kind} {text.split(' ')[0]} {text}")[:100]
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


def fuzz(name: str, count: int, seed: int, finds: Path) -> Tally:
    """Run inputs of a target in child processes; one that dies or does not end costs one input."""
    tally, first = Tally(), 0
    with tempfile.TemporaryDirectory() as place:
        counter = Path(place) / "counter"
        while first < count:
            counter.write_bytes(_COUNTER.pack(first))
            command = [sys.executable, __file__, "--serve", name, str(seed), str(first), str(count - first)]
            with (Path(place) / "output").open("w+b") as output:
                process = subprocess.Popen([*command, str(counter), str(finds)], stdout=output, stderr=output)
                _wait(process, counter)
                output.seek(0)
                lines = output.read().decode(errors="replace").splitlines()
            for parts in (line.split("\t") for line in lines):
                if len(parts) == 3:
                    tally.add(parts[1], parts[2])
            first = _COUNTER.unpack(counter.read_bytes())[0]
            if process.returncode != 0:
                text = f"exit {process.returncode}: {lines[-1][:120] if lines else ''}"
                kind = "hang" if process.returncode in (-signal.SIGVTALRM, -signal.SIGKILL) else "death"
                tally.add(kind, f"input {first}, {text}")
                _keep(finds, name, kind, str(first), input_of(name, samples_of(name), seed, first))
                first += 1
    tally.inputs = count
    return tally


def _wait(process: subprocess.Popen[bytes], counter: Path) -> None:
    """Wait for a child; one that stays at the same input too long is killed."""
    index, waited = b"", 0.0
    while process.poll() is None:
        try:
            process.wait(INTERVAL_S)
        except subprocess.TimeoutExpired:
            now = counter.read_bytes()
            index, waited = now, 0.0 if now != index else waited + INTERVAL_S
            if waited > WAIT_LIMIT_S:
                process.kill()


def shares(inputs: int, names: list[str]) -> dict[str, int]:
    """Return how many inputs each target gets: the cheaper, the more, and none less than a share of all."""
    weights = {name: 1.0 / TARGETS[name].cost for name in names}
    fewest = max(1, round(LEAST_SHARE * inputs))
    return {name: max(fewest, round(inputs * weight / sum(weights.values()))) for name, weight in weights.items()}


def run(inputs: int = 2000, seed: int = 1, names: list[str] | None = None, finds: Path | None = None) -> list[Line]:
    """The tally of all targets as a table; every find is printed."""
    lines, all_finds, all_inputs = [], Counter[str](), 0
    for name, count in shares(inputs, names or list(TARGETS)).items():
        tally = fuzz(name, count, seed, finds or Path(tempfile.gettempdir()) / "seatrial-fuzz")
        total = sum(sum(counted.values()) for counted in tally.finds.values())
        lines.append(at_most(f"{name}: finds in {tally.inputs} inputs", total, "", 0))
        all_inputs += tally.inputs
        all_finds.update({kind: counted.total() for kind, counted in tally.finds.items()})
        print(f"{name}: {tally.inputs} inputs, {total} finds", flush=True)
        for kind, counted in tally.finds.items():
            for text, number in counted.most_common():
                print(f"    {kind} {number} times: {text}", flush=True)
    return [*lines, *(at_most(f"{kind} in all {all_inputs} inputs", all_finds[kind], "", 0) for kind in KINDS_OF_FIND)]


if __name__ == "__main__":
    if sys.argv[1:2] == ["--serve"]:
        serve(sys.argv[2], *map(int, sys.argv[3:6]), *map(Path, sys.argv[6:8]))
        sys.exit()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--inputs", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--target", choices=TARGETS, action="append")
    parser.add_argument("--finds", type=Path)
    options = parser.parse_args()
    for line in run(options.inputs, options.seed, options.target, options.finds):
        print(f"  {line.quantity:<50} {line.value:>8.0f} {line.verdict}")
