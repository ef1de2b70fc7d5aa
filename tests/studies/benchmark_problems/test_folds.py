"""Folds of measured trials, where the records are; a plain reason where they are not."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial_studies.benchmark_problems import folds


def test_a_fold_of_the_blueboat_repeats_itself(monkeypatch: pytest.MonkeyPatch, data_folder: Path) -> None:
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder))
    (problem,) = folds.blueboat_problems()
    draw, again = problem.draw(1), problem.draw(1)
    assert draw.start is not None and draw.trial is not None and again.trial is not None
    assert [run.name for run in draw.trial.runs] == [run.name for run in again.trial.runs]
    assert 0.0 < draw.yardstick.error(draw.start) < 3.0
    assert np.isfinite(draw.fitness(draw.start[None], 0)[0])


@pytest.mark.parametrize("make", [folds.kvlcc2_problems, folds.esso_osaka_problems])
def test_the_others_are_there_too(monkeypatch: pytest.MonkeyPatch, data_folder: Path, make: object) -> None:
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder))
    (problem,) = make()  # type: ignore[operator]
    assert problem.budget > 0 and problem.title


def test_without_the_records_the_reason_is_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SEATRIAL_DATA", raising=False)
    with pytest.raises(InputError, match="SEATRIAL_DATA is not set; set it to their folder"):
        folds.kvlcc2_problems()
