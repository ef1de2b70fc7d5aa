"""Measures of craft with thrusters on records written by hand."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres.measures import commands_of, thrust_measures

TIME = 0.1 * np.arange(400)


def record(**channels: np.ndarray) -> Record:
    still = {"command_1": np.full(400, 0.5), "command_2": np.full(400, 0.5), "u": np.zeros(400), "psi": np.zeros(400)}
    return Record.from_arrays("run", TIME, still | channels)


def test_commands_are_the_numbered_channels() -> None:
    assert commands_of(record(delta=np.zeros(400))) == ("command_1", "command_2")


def test_a_spin_has_its_rate_and_the_time_of_a_turn() -> None:
    found = thrust_measures(record(psi=np.angle(np.exp(0.5j * TIME))))
    assert found == pytest.approx(
        {"steady_yaw_rate_deg_s": np.degrees(0.5), "time_360_s": 4.0 * np.pi, "time_constant_s": 0.0}  # at once
    )


def test_a_straight_run_has_speed_and_time_constant() -> None:
    found = thrust_measures(record(u=2.0 * (1.0 - np.exp(-TIME / 3.0))))
    assert found == pytest.approx({"steady_speed": 2.0, "time_constant_s": 3.0}, rel=1e-3)


def test_a_stop_is_read_from_the_change_of_commands_to_rest() -> None:
    u = np.where(TIME < 10.0, 2.0, 2.0 - 0.25 * (TIME - 10.0))
    found = thrust_measures(record(u=u, command_1=np.where(TIME <= 10.0, 0.5, -0.5)))
    assert found == pytest.approx({"approach_speed": 2.0, "stopping_time_s": 8.0, "stopping_distance_m": 8.0})


def test_a_zigzag_has_overshoots_behind_its_executes() -> None:
    psi = 0.5 * np.sin(0.5 * TIME)
    executes = (np.pi / 6.0 + np.pi * np.arange(6)) / 0.5  # at 15 deg on the way to 0.5 rad and back
    command = 0.5 + 0.3 * (-1.0) ** np.searchsorted(executes, TIME)
    found = thrust_measures(record(psi=psi, u=np.full(400, 1.5), command_1=command))
    step = np.degrees(0.25 * np.cos(np.pi / 6.0) * 0.1)  # of the heading in a sample, within which an execute is known
    assert found["overshoot_1_deg"] == pytest.approx(np.degrees(0.5 - 0.25), abs=step)
    assert found["period_s"] == pytest.approx(4.0 * np.pi, rel=0.01)


def test_commands_that_step_at_will_are_no_manoeuvre() -> None:
    steps = np.repeat([0.1, 0.7, -0.3, 0.4, 0.2], 80)
    assert thrust_measures(record(psi=0.5 * np.sin(0.5 * TIME), command_1=steps)) == {}


def test_what_is_missing_is_named() -> None:
    with pytest.raises(InputError, match="has no 'psi'"):
        thrust_measures(record().without("psi"))
