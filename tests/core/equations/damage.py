"""A program of its own: damages the entries of a compile cache in every way, and runs a small model after each.

Every run is a fork, so that a crash ends that run alone and nothing needs to be imported twice. Prints JSON: by kind of
entry and way of damage what the run returned, how it ended, what it logged, and whether the entry is whole again.
"""

import contextlib
import io
import json
import logging
import os
import random
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from seatrial.core.equations import Model, Sheet
from seatrial.core.equations.model import stored_model
from seatrial.numerics.kernels.cache import cache_folder, read_entry

KINDS = {"manifest": "model-*.json", "generated module": "model_*.py", "machine code": "*.rates-*.bin"}
OTHER = "from another model"


def flipped(content: bytes, place: int) -> bytes:
    changed = bytearray(content)
    changed[place] ^= 0x01
    return bytes(changed)


CONTENTS: dict[str, Callable[[bytes], bytes]] = {
    "emptied": lambda _: b"",
    "cut to half": lambda content: content[: len(content) // 2],
    "first byte flipped": lambda content: flipped(content, 0),
    "middle byte flipped": lambda content: flipped(content, len(content) // 2),
    "last byte flipped": lambda content: flipped(content, -1),
    "one byte appended": lambda content: content + b"\n",
    "random bytes": lambda content: random.Random(1).randbytes(len(content)),
    "text": lambda _: b"not what anyone wrote here\n",
    "without its first line": lambda content: content.partition(b"\n")[2],
    "of an older format": lambda content: content.replace(b"format 1", b"format 0", 1),
}


def folder(path: Path) -> None:
    path.unlink()
    path.mkdir()
    (path / "file").write_text("in the way")


def link_to_nowhere(path: Path) -> None:
    path.unlink()
    path.symlink_to(path.parent / "nowhere")


def link_to_a_copy(path: Path) -> None:
    copy = Path(shutil.copy(path, path.parent.parent))
    path.unlink()
    path.symlink_to(copy)


def pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


PLACES: dict[str, Callable[[Path], None]] = {
    "writable by others": lambda path: path.chmod(0o666),
    "a folder": folder,
    "a link to nowhere": link_to_nowhere,
    "a link to a copy": link_to_a_copy,
    "a pipe": pipe,
    **({"of another user": lambda path: os.chown(path, 12345, -1)} if os.getuid() == 0 else {}),
}
WAYS = (*CONTENTS, *PLACES, OTHER)


def small(slope: float) -> Model:
    sheet = Sheet("small", "invented")
    (x,) = sheet.states("x")
    a = sheet.parameter("a", 2.0)
    sheet.rate(x, slope * a * x)
    return sheet.model()


def result(slope: float) -> float:
    model, rate = stored_model(("small", slope), lambda: small(slope), ()), np.empty(1)
    model.compiled.rates(0.0, np.ones(1), np.empty(0), model.parameters.values, rate)
    return float(rate[0])


def run(slope: float = 3.0) -> dict[str, object]:
    """Return value, exit status and log of a run in a process of its own."""
    with tempfile.TemporaryFile("w+") as file:
        child = os.fork()
        if child == 0:
            log = io.StringIO()
            logging.getLogger("seatrial").addHandler(logging.StreamHandler(log))
            with contextlib.suppress(BaseException):
                value = result(slope)
                json.dump({"value": value, "log": log.getvalue().splitlines()}, file)
                file.flush()
                os._exit(0)
            os._exit(1)
        status = os.waitpid(child, 0)[1]
        file.seek(0)
        return {"status": status, **(json.load(file) if status == 0 else {})}


def entries(pattern: str) -> list[Path]:
    return sorted(cache_folder().glob(pattern))


def main() -> None:
    result(5.0)  # in this process, so that no fork imports or sets up the compiler again
    foreign = {kind: entries(pattern)[0].read_bytes() for kind, pattern in KINDS.items()}
    shutil.rmtree(cache_folder())
    cache_folder().mkdir(mode=0o700)
    answers: dict[str, dict[str, object]] = {"first": run()}
    for kind, pattern in KINDS.items():
        for way in WAYS:
            (path,) = entries(pattern)
            if way in PLACES:
                PLACES[way](path)
            else:
                path.write_bytes(foreign[kind] if way == OTHER else CONTENTS[way](path.read_bytes()))
            answers[f"{kind}, {way}"] = {**run(), "is_whole": read_entry(path.name) is not None}
    json.dump(answers, sys.stdout)


if __name__ == "__main__":
    main()
