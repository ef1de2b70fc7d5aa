"""Twenty kills of what writes folders of results; those of whole commands as a benchmark."""

import os
from pathlib import Path

import pytest
from benchmarks.kills import kills_while_saving


@pytest.mark.skipif(not hasattr(os, "fork"), reason="a copy of this process is killed")
def test_a_process_killed_while_saving_leaves_one_result_and_no_hindrance(tmp_path: Path) -> None:
    tally = kills_while_saving(tmp_path, 20, seed=1)
    assert (tally.killed, tally.broken, tally.leftovers) == (20, 0, [])
    assert tally.whole >= 1
