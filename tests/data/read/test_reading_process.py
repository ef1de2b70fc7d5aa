"""A file that ends its reader, or that takes memory or time without end, is one sentence."""

import sys
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.read.assemble import record_from_values
from seatrial.data.read.log import fault_text
from seatrial.data.read.registry import read_in_process

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


def test_rows_of_numbers_become_a_record() -> None:
    record = record_from_values("run", LAYOUT, np.arange(3.0), np.array([[1.0], [2.0], [3.0]]))
    np.testing.assert_array_equal(record["u"], [1.0, 2.0, 3.0])
    assert record.channel("u").label == "column 'speed'"


def test_what_a_library_says_is_cut() -> None:
    text = fault_text(ValueError("a long story " * 40 + "\nand its second line"))
    assert text.startswith("ValueError: a long story") and len(text) < 140 and "second" not in text
    assert fault_text(KeyError()) == "KeyError: "
