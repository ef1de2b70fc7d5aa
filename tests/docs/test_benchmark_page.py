"""The optimiser and the estimator of docs/benchmark.md are entered as files, as the page says; each has 20 lines."""

import re
from pathlib import Path

import pytest

import seatrial as st

BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("number", [0, 1])
def test_a_method_of_the_page_is_entered_as_a_file(number: int, repository: Path, tmp_path: Path) -> None:
    block = BLOCK.findall((repository / "docs" / "benchmark.md").read_text(encoding="utf-8"))[number]
    lines = [line for line in block.splitlines() if line.strip() and '"""' not in line and "import" not in line]
    assert len(lines) <= 20
    path = tmp_path / "mine.py"
    path.write_text(block, encoding="utf-8")
    result = st.benchmark(
        "qi2025-135-whole", tmp_path / "out", methods=str(path), against=("random",), runs=2, workers=1
    )
    mine = next(m for m in result.problems[0].methods if not m.is_built_in)
    assert mine.failures == 0 and mine.median < 10.0  # type: ignore[operator]
    assert (mine.intervals > 0) == (number == 1)
