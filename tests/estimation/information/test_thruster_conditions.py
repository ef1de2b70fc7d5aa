"""Commands and speeds along thrusters, by hand; how far commands leave the training runs."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.information.extrapolation import (
    extrapolation,
    extrapolation_index,
    motion_envelope,
    thruster_conditions,
)
from seatrial.physics.models.thruster_layout import AngleInput, CommandInput, Thruster, ThrusterLayout

LAYOUT = ThrusterLayout((
    Thruster("port", -0.5, -0.3, CommandInput("command_1", 1500.0, 400.0)),
    Thruster("turning", -0.5, 0.0, CommandInput("command_2"), angle=AngleInput("alpha_1")),
)).text()  # fmt: skip


def run(name: str, order: float, u: float) -> Record:
    ones = np.ones(20)
    return Record.from_arrays(name, 0.1 * np.arange(20), {
        "u": u * ones, "v": 0.2 * ones, "r": 0.1 * ones, "command_1": (1500.0 + 400.0 * order) * ones,
        "command_2": 0.5 * ones, "alpha_1": np.pi / 2 * ones,
    })  # fmt: skip


def test_speed_along_a_thruster_is_that_of_its_place_along_its_axis() -> None:
    """u - y r ahead; v + x r across (Fossen 2021, section 9.2)."""
    conditions = thruster_conditions(LAYOUT, [run("a", 0.5, 2.0)])
    assert np.allclose(conditions["port"].order, 0.5) and np.allclose(conditions["port"].speed, 2.03)
    assert np.allclose(conditions["turning"].speed, 0.2 - 0.05)
    assert thruster_conditions("", [run("a", 0.5, 2.0)]) == {}


def test_each_sample_lies_in_one_quadrant() -> None:
    quadrants = thruster_conditions(LAYOUT, [run("a", -0.5, 2.0)])["port"].quadrants()
    assert {name: float(np.max(size)) for name, size in quadrants.items() if np.any(size)} == {
        "astern, moving ahead": pytest.approx(0.5 * 2.03)
    }


def test_a_command_to_the_side_that_was_never_trained_is_far_outside() -> None:
    """From 0 to -0.5 of full command, and half the fastest speed times that in a quadrant never entered."""
    found = extrapolation(run("b", -0.5, 2.0), motion_envelope([run("a", 0.5, 2.0)], LAYOUT), LAYOUT)
    assert found is not None
    assert found.ratios["command port astern"] == pytest.approx(1.5)
    assert found.ratios["command port astern, moving ahead"] == pytest.approx(1.0 + 0.5 * 2.03 / np.hypot(2.0, 0.2))
    assert found.ratios["command port ahead"] == 1.0
    assert found.index == found.ratios["command port astern, moving ahead"]


def test_a_run_like_the_training_runs_is_inside_whatever_its_commands() -> None:
    assert extrapolation_index(run("b", 0.5, 2.0), [run("a", 0.5, 2.0)], LAYOUT) == pytest.approx(1.0)
    assert not [n for n in motion_envelope([run("a", 0.5, 2.0)]) if n.startswith("command")]
