"""Fits of the examples that tests share: each is made once and kept by the hash of the code and files that make it."""

import hashlib
import os
import pickle
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path

from seatrial.core.results import Fit
from seatrial.data.trial import load_trial
from seatrial.estimation.identify import identify

REPOSITORY = Path(__file__).parents[1]
KEPT = REPOSITORY / ".pytest_cache" / "fits"
LAYERS = ("numerics", "core", "physics", "data", "estimation")  # all that `identify` may import


@cache
def example_fit(name: str) -> Fit:
    """Return what `identify` makes of an example that lies in the repository with its records; not to be changed."""
    path = KEPT / f"{name}-{_digest()}.pickle"
    if path.exists():
        return pickle.loads(path.read_bytes())
    fit = identify(load_trial(REPOSITORY / "examples" / f"{name}.toml"))
    KEPT.mkdir(parents=True, exist_ok=True)
    for earlier in KEPT.glob(f"{name}-*"):
        earlier.unlink(missing_ok=True)
    unfinished = KEPT / f"{os.getpid()}.unfinished"  # another process may make the same fit
    unfinished.write_bytes(pickle.dumps(fit))
    unfinished.replace(path)
    return fit


@cache
def _digest() -> str:
    """The hash of the code, of all examples with their records, and of the versions of what computes."""
    digest = hashlib.sha256(repr([sys.version, *map(version, ("numpy", "scipy", "numba", "sympy", "pandas"))]).encode())
    folders = [*(REPOSITORY / "src" / "seatrial" / layer for layer in LAYERS), REPOSITORY / "examples"]
    for path in sorted(p for folder in folders for p in folder.rglob("*") if p.is_file() and p.suffix != ".pyc"):
        digest.update(f"{path.relative_to(REPOSITORY)}\n".encode() + path.read_bytes())
    return digest.hexdigest()[:16]
