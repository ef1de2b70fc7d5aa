"""Gains for the craft as its coefficients are: heave and pitch with a fin, and a craft that steers."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from tests.control.loop_files import RIDE_CONTROL, heave_pitch_file, model_file, write_loop_file

from seatrial.control.controller import shortfall
from seatrial.control.craft_proposals import CraftNow, propose_for_craft
from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.loopfile.load import tuning_task
from seatrial.control.task import TuningTask
from seatrial.data.example_series import JET_VELOCITY, true_model
from seatrial.data.folder.model_file import ModelFile, read_model_file


def ride(folder: Path) -> tuple[Callable[[ModelFile], TuningTask], ModelFile]:
    """A ride control on any model file of its ship, and the one it was written with."""
    heave_pitch_file(folder)
    loop = write_loop_file(folder, RIDE_CONTROL)
    return lambda file: tuning_task(loop, model_file=file), read_model_file(folder / "model.toml")


def craft(base: ModelFile, scale: float = 1.0, relative: float = 0.01) -> CraftNow:
    """The model's own coefficients, pitch damping and stiffness of the moment times `scale`."""
    names = ("a33", "a35", "a53", "a55", "b33", "b35", "b53", "b55")
    value = np.array([base.model.parameters[n].value for n in names])
    value[names.index("b55")] *= scale
    return CraftNow(names, value, np.diag((relative * value) ** 2), 120.0, 0.0)


def test_gains_are_those_of_the_craft_of_the_moment(tmp_path: Path) -> None:
    task_of, base = ride(tmp_path)
    proposal = propose_for_craft(task_of, base, craft(base), np.array([0.0, 0.0]))
    assert proposal.has_gains and proposal.is_new and proposal.margins is not None
    assert proposal.margins.stable_draws == proposal.margins.draws > 0
    task = task_of(base)
    judged = gain_evaluator(task).evaluate(np.array([[proposal.gains[n] for n in task.loop.gains.names]]))
    assert judged.is_feasible[0]
    again = propose_for_craft(task_of, base, craft(base), np.array(list(proposal.gains.values())))
    assert not again.is_new and again.gains == proposal.gains
    damped = propose_for_craft(task_of, base, craft(base, 3.0), None)
    assert damped.gains != proposal.gains


def test_a_craft_that_steers_has_gains_that_follow_its_demand(tmp_path: Path, repository: Path) -> None:
    text = (repository / "examples" / "waterjet_autopilot.toml").read_text(encoding="utf-8")
    loop = tmp_path / "loop.toml"
    loop.write_text(text.replace("../results/waterjet/model.toml", "model.toml"), encoding="utf-8")
    truth = true_model()
    base = replace(read_model_file(model_file(tmp_path, truth)), approach={"v_j": JET_VELOCITY})
    value = np.array([truth.parameters[n].value for n in truth.parameters.free_names])
    now = CraftNow(truth.parameters.free_names, value, np.diag((0.03 * value) ** 2), 600.0, 100.0)

    def task_of(file: ModelFile) -> TuningTask:
        return tuning_task(loop, model_file=file)

    proposal = propose_for_craft(task_of, base, now, None)
    assert proposal.has_gains and proposal.start == 100.0
    task = task_of(now.file(base, value))
    gains = np.array([proposal.gains[n] for n in task.loop.gains.names])
    assert shortfall(task, task.loop, gains)[0] == 0.0
    weak = propose_for_craft(task_of, base, now, 0.02 * gains)  # those on board do not follow the demand
    assert weak.is_new and "no longer hold" in weak.reasons[1]


def test_coefficients_that_are_not_known_are_named(tmp_path: Path) -> None:
    task_of, base = ride(tmp_path)
    proposal = propose_for_craft(task_of, base, craft(base, relative=0.3), None)
    assert not proposal.has_gains
    assert proposal.reasons[0].startswith("a33, a35, a53, a55, b33, b35, b53, b55 not known to 15 % yet")
