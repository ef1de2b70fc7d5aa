"""The same search serves a ship with a rudder and two fins that move a ship up and down."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.data.trial import load_trial
from seatrial.estimation.design.design import design
from seatrial.estimation.design.task import DesignTask, design_task


def shortened(path: Path, duration: float) -> DesignTask:
    task = design_task(load_trial(path))
    return replace(task, request=replace(task.request, duration=duration, draws=2), question="")


@pytest.mark.long(every=2)
@pytest.mark.parametrize(
    ("example", "duration", "standard"),
    [("kvlcc2_design.toml", 100.0, "zigzag:20/20"), ("heave_pitch_design.toml", 40.0, "sine sweep")],
)
def test_the_example_is_designed_and_beats_its_standard_manoeuvres(
    repository: Path, example: str, duration: float, standard: str
) -> None:
    task = shortened(repository / "examples" / example, duration)
    made = design(task, 0, confirmation_runs=0, generations=60)
    against = {w.name: w for w in made.baselines}
    assert made.coefficients == task.model.parameters.free_names
    assert np.isfinite(made.designed.sampled_relative_error).all()
    assert standard in against
    worth = {"worst": lambda w: w.worst, "mean": lambda w: w.mean}[made.criterion]
    within = [
        w for w in made.baselines if w.drift <= task.request.limits.drift and w.distance <= task.request.limits.sea_room
    ]
    assert worth(made.designed) < min(worth(w) for w in within)
    assert {a.name for a in task.request.actuators} == set(made.orders[0].values)
