"""The same search serves a ship with a rudder and two fins that move a ship up and down."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.data.trial import load_trial
from seatrial.estimation.design.asked import task_of
from seatrial.estimation.design.design import design
from seatrial.estimation.design.task import Task


def shortened(path: Path, duration: float) -> Task:
    return replace(task_of(load_trial(path)), duration=duration, draws=2, question="")


@pytest.mark.parametrize(
    ("example", "duration", "standard"),
    [("kvlcc2_design.toml", 100.0, "zigzag:20/20"), ("heave_pitch_design.toml", 40.0, "sine sweep")],
)
def test_the_example_is_designed_and_beats_its_standard_manoeuvres(
    repository: Path, example: str, duration: float, standard: str
) -> None:
    task = shortened(repository / "examples" / example, duration)
    made = design(task, 0, confirming=0, generations=60)
    against = {w.name: w for w in made.rivals}
    assert made.coefficients == task.model.parameters.free_names
    assert np.isfinite(made.designed.drawn).all()
    assert standard in against
    worth = {"worst": lambda w: w.worst, "mean": lambda w: w.mean}[made.criterion]
    within = [w for w in made.rivals if w.drift <= task.limits.drift and w.room <= task.limits.room]
    assert worth(made.designed) < min(worth(w) for w in within)
    assert {a.name for a in task.actuators} == set(made.orders[0].values)
