"""Windows predicted open loop: the truth misses nothing, a wrong model by what a simulation says."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import Runs
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.predict.horizon_errors import predict_windows
from seatrial.physics.models import model_named
from seatrial.physics.simulate.replay import replay


@pytest.fixture(scope="module")
def records() -> list[Record]:
    """Two runs of 25 and 12 s of two thrusters worked by steps, without noise."""
    model = model_named("thrusters")
    runs = []
    for name, steps in (("long", 25), ("short", 12)):
        commands = np.repeat(np.random.default_rng(steps).uniform(-1.0, 1.0, size=(steps, 2)), 10, axis=0)
        inputs = {"command_1": commands[:, 0], "command_2": commands[:, 1]}
        planned = Record.from_arrays(name, 0.1 * np.arange(len(commands)), inputs)
        start = dict.fromkeys(model.states, 0.0) | {"c_port": commands[0, 0], "c_starboard": commands[0, 1]}
        runs.append(replay(model, planned, start))
    return runs


def test_the_truth_predicts_its_own_windows(records: list[Record]) -> None:
    model = model_named("thrusters")
    problem = output_error_problem(model, Runs.one_session_each(records, 1.0), 10.0, EstimateSettings())
    none = [np.zeros(0)] * len(records)
    found = predict_windows(problem, model, records, none, 10.0)
    assert found.run.tolist() == [0, 0, 1]
    assert max(found.rms().values()) < 1e-6
    wrong = predict_windows(problem, model.with_values({"k_f": 1.2}), records, none, 10.0)
    for scores, others in ((found.rms(0), wrong.rms(0)), (found.rms(1), wrong.rms(1))):
        assert set(scores) == {"u", "v", "r", "psi_deg", "position_m"}
        assert all(others[name] > 0.01 + scores[name] for name in ("u", "r", "position_m"))
