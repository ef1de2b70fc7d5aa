"""What the benchmark of memory measures, and the finer records that it makes."""

import sys
from pathlib import Path

import numpy as np
import pytest
from benchmarks.memory import EXAMPLES, finer_records, peak_memory


@pytest.mark.skipif(sys.platform == "win32", reason="the system says nothing of an ended process's memory")
def test_the_peak_is_that_of_the_process() -> None:
    small, large = (peak_memory([sys.executable, "-c", f"b'x' * {size}"]) for size in (1, 10**8))
    assert large - small == pytest.approx(1e8, rel=0.05)


def test_finer_records_have_ten_times_the_rows_and_the_same_values(tmp_path: Path) -> None:
    finer_records(tmp_path)
    source = next((EXAMPLES / "waterjet").glob("*.csv"))
    old, new = (np.loadtxt(p, delimiter=",", skiprows=1) for p in (source, tmp_path / "waterjet" / source.name))
    assert len(new) == 10 * (len(old) - 1) + 1
    np.testing.assert_allclose(new[::10], old, rtol=1e-8, atol=1e-9)
