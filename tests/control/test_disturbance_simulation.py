"""A heading kept in simulated disturbances: as linear theory predicts without limits, worse with tight ones."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.control.loop_files import AUTOPILOT, model_file, nomoto, write_loop_file

from seatrial.control.loopfile.load import tuning_task
from seatrial.control.simulation import SIGNALS, correlation_time, simulate_disturbances
from seatrial.control.task import TuningTask
from seatrial.physics.loops import Sampling

SEAS = """
[[seas]]
spectrum = "ittc"
height = 1.5
heading = { value = 135, unit = "deg" }
[[seas]]
spectrum = "ittc"
height = 1.5
heading = { value = 45, unit = "deg" }
[demand]
"""


@pytest.fixture
def task(tmp_path: Path) -> TuningTask:
    model_file(tmp_path, nomoto())
    return tuning_task(write_loop_file(tmp_path, AUTOPILOT, ("[demand]\n", SEAS)))


def test_simulations_without_limits_have_the_predicted_rms(task: TuningTask) -> None:
    """From the bow, from the quarter, where the ship overtakes waves, and in a slow disturbance.

    Rates are those from sample to sample, which are (omega T)^2 / 24 less.
    """
    task = replace(task, loop=replace(task.loop, sampling=Sampling(0.25)))
    made = simulate_disturbances(task, task.loop, task.loop.gain_values, seed=0)
    assert [one.disturbance for one in made] == [met.description for met in task.disturbances]
    for one in made:
        for name in SIGNALS:
            off = one.unlimited[name] - one.predicted[name]
            assert abs(off) < 4.0 * one.standard_error[name] + 0.01 * one.predicted[name], (one.disturbance, name)
            assert one.standard_error[name] < 0.06 * one.predicted[name]


def test_tight_limits_are_kept_and_cost_heading(task: TuningTask) -> None:
    limits = replace(task.constraints, limit=np.radians(2.0), rate=np.radians(1.0))
    tight = replace(task, constraints=limits, disturbances=task.disturbances[:1])
    sea = simulate_disturbances(tight, task.loop, task.loop.gain_values, seed=0)[0]
    assert sea.limited["output"] > 1.02 * sea.unlimited["output"]
    assert sea.limited["actuator_rate"] <= limits.rate
    assert sea.limited["actuator"] <= limits.limit


def test_seeds_decide_the_realisations(task: TuningTask) -> None:
    gains, slow = task.loop.gain_values, replace(task, disturbances=task.disturbances[-1:])
    one, same, other = (simulate_disturbances(slow, task.loop, gains, seed)[0] for seed in (0, 0, 9))
    assert one == same
    assert one.unlimited != other.unlimited


def test_the_correlation_time_of_a_slow_disturbance_is_that_of_its_lag() -> None:
    """A Gauss-Markov process below 0.2 rad/s forgets in 5 s (Gelb 1974, section 3.8)."""
    omega = np.geomspace(1e-5, 1e4, 40_000)
    energy = 2.0 * 0.2 / math.pi / (omega**2 + 0.2**2) * np.gradient(omega)
    assert correlation_time(omega, energy) == pytest.approx(5.0, rel=0.03)
