"""A file that ends its reader, or that takes memory or time without end, is one sentence."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.read.assemble import record_from_values
from seatrial.data.read.reading_process import read_in_process
from seatrial.numerics.platform import limit_resources

LAYOUT = Layout("mat", ColumnSpec("time", "t", "s"), (ColumnSpec("u", "speed", "m/s"),))


@pytest.mark.parametrize(
    ("code", "sentence"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "its reader ends with code -11"),
        ("raise MemoryError", "needs more memory than such a file can fill"),
        ("import sys; sys.stdout.buffer.write(b'noise'); sys.stdout.flush(); os._exit(3)", "is damaged"),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="other codes")
def test_the_end_of_a_reader_is_one_sentence(
    code: str, sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the process imports this module in place of the one that reads .mat files
    package = tmp_path / "scipy"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "io.py").write_text(f"import os\ndef loadmat(*_, **__):\n    {code}\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "run.mat").write_bytes(b"MATLAB 5.0" + bytes(600))
    with pytest.raises(InputError, match=sentence):
        read_in_process("mat", tmp_path / "run.mat", LAYOUT)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limits")
@pytest.mark.parametrize("code", ["bytearray(10**12)", "\nwhile True: pass"])
def test_memory_and_time_are_limited(code: str) -> None:
    limits = f"from {limit_resources.__module__} import limit_resources; limit_resources(2**31, 1); "
    done = subprocess.run([sys.executable, "-c", limits + code], capture_output=True, check=False, timeout=60)
    assert done.returncode != 0
    assert b"MemoryError" in done.stderr or done.returncode < 0


def test_rows_of_numbers_become_a_record() -> None:
    record = record_from_values("run", LAYOUT, np.arange(3.0), np.array([[1.0], [2.0], [3.0]]))
    np.testing.assert_array_equal(record["u"], [1.0, 2.0, 3.0])
    assert record.channel("u").label == "column 'speed'"
