"""Delay of commands, thrust over voltage, wind and rudders of craft with thrusters, against numbers worked out here."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.physics.models import model_named
from seatrial.physics.models.thruster_forces import lift_gradient
from seatrial.physics.models.thruster_layout import CommandInput, Damping, Rudder, ThrustCurve, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.replay import trajectory
from seatrial.testing import check_model

AFT = Thruster("aft", -0.5, 0.0, CommandInput("command_1"), curve=ThrustCurve.LINEAR, lag=0.0)
NO_LOSS = {"k_J": 0.0, "k_4": 0.0}
RUDDER = Rudder("delta", -0.52, 0.005, 0.1)
TWIN = ThrusterLayout(
    tuple(
        Thruster(
            name, -0.45, y, CommandInput(f"rpm_{k}"), curve=ThrustCurve.OPEN_WATER, diameter=0.08, lag=0.3,
            same_as=leader, rudder=RUDDER,
        )
        for k, (name, y, leader) in enumerate((("port", -0.15, "starboard"), ("starboard", 0.15, "")), start=1)
    ),
    Damping.FULL, 1.1, 25.0,
)  # fmt: skip


def forces(model: Model, state: dict[str, float], inputs: dict[str, float]) -> dict[str, float]:
    x = np.array([[state.get(s, 0.0) for s in model.states]])
    u = np.array([[inputs.get(n, 0.0) for n in model.input_names]])
    return {name: float(column[0]) for name, column in model.forces(x, u).items()}


def test_a_delayed_step_rises_as_two_equal_time_constants_do() -> None:
    model = thrusters(ThrusterLayout((replace(AFT, delay=0.4),))).with_values({"k_f": 1.0, **NO_LOSS})
    time = np.arange(0.0, 3.0, 0.01)
    _, thrust = trajectory(model, np.ones((len(time), 1)), 0.01, np.zeros(len(model.states)))
    late = time / 0.2
    np.testing.assert_allclose(thrust[:, 0], 1.0 - (1.0 + late) * np.exp(-late), atol=1e-6)
    assert np.trapezoid(1.0 - thrust[:, 0], time) == pytest.approx(0.4, rel=1e-3)  # late by the delay on the whole


def test_thrust_follows_a_power_of_the_voltage() -> None:
    model = thrusters(ThrusterLayout((AFT,), has_voltage=True)).with_values({"V_0": 14.8, "k_V": 1.6, "k_f": 2.0})
    at_rest = forces(model, {}, {"command_1": 0.5, "voltage": 13.0})
    assert at_rest["T_aft"] == pytest.approx(0.5 * 2.0 * (13.0 / 14.8) ** 1.6)


def test_wind_pushes_by_its_apparent_speed_and_direction() -> None:
    model = thrusters(ThrusterLayout((AFT,), mass=20.0, has_wind=True)).with_values(
        {"A_T": 0.3, "A_L": 0.8, "L": 1.2, "C_X1": -0.6, "C_Y1": -0.9, "C_N2": 0.1, "current_east": 0.4}
    )
    psi, u, v, speed, direction = 0.7, 1.1, -0.2, 6.0, 2.5
    by = forces(model, {"u": u, "v": v, "psi": psi}, {"wind_speed": speed, "wind_direction": direction})
    over_ground = u * np.array([math.cos(psi), math.sin(psi)]) + v * np.array([-math.sin(psi), math.cos(psi)])
    air = over_ground + [0.0, 0.4] + speed * np.array([math.cos(direction), math.sin(direction)])
    ahead = air @ [math.cos(psi), math.sin(psi)]
    across = air @ [-math.sin(psi), math.cos(psi)]
    pressure, gamma = 0.61 * (ahead**2 + across**2), math.atan2(across, ahead)
    assert by["X_W"] == pytest.approx(-0.6 * pressure * 0.3 * math.cos(gamma), rel=1e-5)
    assert by["Y_W"] == pytest.approx(-0.9 * pressure * 0.8 * math.sin(gamma), rel=1e-5)
    assert by["N_W"] == pytest.approx(0.1 * pressure * 0.8 * 1.2 * math.sin(2 * gamma), rel=1e-5)


def test_a_current_carries_the_craft_and_changes_no_force() -> None:
    model = thrusters(ThrusterLayout((AFT,)))
    x, u = np.array([0.8, 0.1, 0.2, 0.5, 0.0, 0.0]), np.array([0.3])
    still, moved = np.empty(6), np.empty(6)
    model.compiled.rates(0.0, x, u, model.parameters.values, still)
    drift = {"current_north": 0.3, "current_east": -0.2}
    model.compiled.rates(0.0, x, u, model.with_values(drift).parameters.values, moved)
    np.testing.assert_allclose(moved - still, [0, 0, 0, 0, 0.3, -0.2], atol=1e-14)


def mmg_twin() -> tuple[Model, Model]:
    """A craft with one screw and rudder on the centre line, as thrusters and as MMG, with the same coefficients."""
    thruster = replace(TWIN.thrusters[1], y=0.0, lag=0.0)
    craft = thrusters(ThrusterLayout((thruster,), Damping.FULL, 1.1, 25.0)).with_values(
        {"w_P": 0.1, "k_0": 0.4, "k_1": -0.3, "k_2": -0.1, "gamma_R": 0.45, "f_alpha": 2.2, "rho_P": 1000.0, "L": 1.1}
    )
    c = {p.name: p.value for p in craft.parameters}
    same = (
        "epsilon",
        "kappa",
        "kappa_astern",
        "l_R_prime",
        "f_alpha",
        "t_R",
        "a_H",
        "x_H_prime",
        "k_0",
        "k_1",
        "k_2",
    )
    values = {name: c[name] for name in same} | {
        "L": 1.1, "d": 0.1, "rho": 1000.0, "D_P": 0.08, "w_P0": 0.1, "t_P": 0.0, "A_R": 0.005, "H_R": 0.1,
        "x_R_prime": -0.52 / 1.1, "gamma_R_plus": 0.45, "gamma_R_minus": 0.45, "m": 1.0, "x_G": 0.0, "I_z": 1.0,
        "m_x_prime": 0.0, "m_y_prime": 0.0, "J_z_prime": 0.0,
    }  # fmt: skip
    return craft, model_named("mmg").with_values(values)


def test_a_rudder_behind_a_screw_is_that_of_the_mmg_method(rng: np.random.Generator) -> None:
    craft, mmg = mmg_twin()
    for _ in range(20):
        state = dict(zip("uvr", rng.normal(size=3) * [1.0, 0.2, 0.0], strict=True))
        n, delta = float(rng.uniform(5.0, 40.0)), float(rng.uniform(-0.6, 0.6))
        state["u"] = abs(state["u"])  # MMG has no wake astern, and no yaw in the screw's inflow
        here = forces(craft, state, {"rpm_2": n, "delta": delta})
        there = forces(mmg, state, {"n": n, "delta": delta})
        for axis in "XYN":
            assert here[f"{axis}_R_starboard"] == pytest.approx(there[f"{axis}_R"], rel=1e-9, abs=1e-12)


def test_the_lift_gradient_is_that_of_the_aspect_ratio() -> None:
    assert lift_gradient(RUDDER) == pytest.approx(6.13 * 2.0 / 4.25)


def test_rudders_to_starboard_turn_to_starboard_and_mirror(rng: np.random.Generator) -> None:
    model = thrusters(TWIN)
    both = {"rpm_1": 30.0, "rpm_2": 30.0, "delta": 0.3}
    speed = {"u": 1.0, "c_port": 30.0, "c_starboard": 30.0}
    assert forces(model, speed, both)["N_sum"] > 0.0
    v, r, n = rng.normal(size=3)
    here = forces(model, speed | {"v": v, "r": r, "c_port": 20.0 + n}, both)
    there = forces(model, speed | {"v": -v, "r": -r, "c_starboard": 20.0 + n}, both | {"delta": -0.3})
    for axis, sign in (("X", 1.0), ("Y", -1.0), ("N", -1.0)):
        assert here[f"{axis}_sum"] == pytest.approx(sign * there[f"{axis}_sum"], rel=1e-9)


def test_everything_at_once_has_exact_derivatives() -> None:
    screw = replace(TWIN.thrusters[1], delay=0.3)
    check_model(thrusters(replace(TWIN, thrusters=(screw,), has_wind=True, has_voltage=True)), points=6)


def test_everything_is_finite_at_rest() -> None:
    model = thrusters(replace(TWIN, has_wind=True, has_voltage=True))
    out = np.empty(len(model.states))
    u = np.array([12.0 if n == "voltage" else 0.0 for n in model.input_names])
    model.compiled.rates(0.0, np.zeros(len(model.states)), u, model.parameters.values, out)
    assert np.all(np.isfinite(out))
