"""Readings that stand for none do not hide from a draft what a column is."""

from pathlib import Path

import numpy as np
from tests.data.draft.test_draft import BASE, TRUTH, guesses, write


def test_a_yaw_rate_with_sentinels_is_recognised_by_the_heading(tmp_path: Path) -> None:
    rate = np.degrees(TRUTH["r"])
    rate[[100, 101, 900]] = -999.0
    result = guesses(write(tmp_path / "run.csv", BASE | {"rot": rate}))
    assert (result["r"].unit, result["r"].is_open) == ("deg/s", False)
