"""The cache between processes: same text whatever the hash seed, nothing new on the second run, no folder no matter."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import hashlib, sys
import numpy as np
from seatrial.core.equations import Sheet
from seatrial.core.equations.generate import source_text
import sympy as sp
sheet = Sheet("yaw")
r, v = sheet.states("r v")
delta = sheet.input("delta")
a, b, c = (sheet.parameter(n, 1.0) for n in "abc")
U = sheet.bind("U", sp.sqrt(r**2 + v**2 + a))
sheet.rate(r, a * delta * U + b * sp.Abs(r) * v + c * r * v * delta)
sheet.rate(v, c * sp.sin(r * a + v * b + delta * c))
model = sheet.model()
out = np.empty(2)
model.compiled.rates(0.0, np.ones(2), np.ones(1), np.ones(3), out)
from seatrial.numerics.kernels.cache import cache_folder
text = source_text(model.equations)
print(hashlib.sha256(text.encode()).hexdigest(), model.equation_hash, out, cache_folder(), sep="|")
"""


def run(cache: Path, hash_seed: str, **more: str) -> list[str]:
    environment = {**os.environ, "SEATRIAL_CACHE": str(cache), "PYTHONHASHSEED": hash_seed, **more}
    command = [sys.executable, "-W", "error:Cannot cache", "-c", PROGRAM]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip().split("|")


def files(folder: Path) -> dict[Path, int]:
    return {p: p.stat().st_mtime_ns for p in folder.rglob("*") if p.is_file()}


def test_a_second_process_with_another_hash_seed_hits_the_cache(tmp_path: Path) -> None:
    first = run(tmp_path, "1")
    before = files(tmp_path)
    second = run(tmp_path, "4242")
    assert first == second
    assert {p.suffix for p in before} == {".py", ".bin"}
    assert files(tmp_path) == before


@pytest.mark.skipif(os.name != "posix", reason="needs a folder that cannot be made")
def test_a_folder_that_cannot_be_written_is_replaced_by_a_temporary_one(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    (tmp_path / "temporary").mkdir()
    replaced = run(tmp_path / "file" / "cache", "1", TMPDIR=str(tmp_path / "temporary"))
    assert Path(replaced[3]).is_relative_to(tmp_path / "temporary")
    assert not files(tmp_path / "temporary"), "the temporary folder outlives the process"
