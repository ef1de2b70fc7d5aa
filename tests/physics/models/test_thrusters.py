"""Craft with thrusters against closed forms, matrices of Fossen written out, and the laws of symmetry."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.models import MODELS
from seatrial.physics.models.thruster_layout import (
    CATAMARAN,
    AngleInput,
    CommandInput,
    Damping,
    ThrustCurve,
    Thruster,
    ThrusterLayout,
)
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.replay import trajectory
from seatrial.testing import check_model

ONE_AFT = Thruster("aft", -0.5, 0.0, CommandInput("command_1"), curve=ThrustCurve.LINEAR, lag=0.0)
NO_LOSS = {"k_J": 0.0, "k_4": 0.0}


def craft(*items: Thruster, damping: Damping = Damping.DIAGONAL, length: float = 1.0) -> Model:
    return thrusters(ThrusterLayout(items, damping, length))


def ahead(model: Model, command: float, seconds: float, dt: float = 0.02) -> tuple[Array, Array, Array]:
    """Time, states and outputs of a craft that starts from rest with every command at one value."""
    time = np.arange(0.0, seconds, dt)
    inputs = np.full((len(time), len(model.inputs)), command)
    return time, *trajectory(model, inputs, dt, np.zeros(len(model.states)))


def test_linear_drag_gives_an_exponential() -> None:
    model = craft(ONE_AFT).with_values({"k_f": 1.2, "X_u": -0.4, "X_uu": 0.0, "M_u": 1.0, **NO_LOSS})
    time, x, _ = ahead(model, 0.5, 8.0)
    np.testing.assert_allclose(x[:, 0], 1.5 * (1.0 - np.exp(-0.4 * time)), rtol=1e-7, atol=1e-10)


def test_quadratic_drag_gives_a_hyperbolic_tangent() -> None:
    model = craft(ONE_AFT).with_values({"k_f": 2.0, "X_u": 0.0, "X_uu": -0.5, **NO_LOSS})
    time, x, _ = ahead(model, 1.0, 6.0)
    np.testing.assert_allclose(x[:, 0], 2.0 * np.tanh(time), rtol=1e-6, atol=1e-9)


def test_thrust_follows_its_command_with_one_time_constant_up_and_another_down() -> None:
    model = craft(replace(ONE_AFT, lag=0.2)).with_values({"tau": 0.4, "tau_down": 0.1, "k_f": 1.0, **NO_LOSS})
    time = np.arange(0.0, 6.0, 0.01)
    inputs = np.where(time < 3.0, 1.0, 0.8)[:, None]
    _, thrust = trajectory(model, inputs, 0.01, np.array([0.0] * 6 + [0.8]))
    up, down = time < 2.9, time > 3.1
    # far from rest the two time constants mix by less than 0.01
    np.testing.assert_allclose(thrust[up, 0], 1.0 - 0.2 * np.exp(-time[up] / 0.4), atol=1e-3)
    settled = 0.8 + (thrust[down, 0][0] - 0.8) * np.exp(-(time[down] - time[down][0]) / 0.1)
    np.testing.assert_allclose(thrust[down, 0], settled, atol=1e-3)


def test_opposed_thrusters_turn_on_the_spot_at_the_speed_where_moments_balance() -> None:
    values = {"k_f": 1.1, "k_b": 1.1, "p_f": 2.0, "p_b": 2.0, "N_r": 0.0, "N_rr": -0.3, "X_u": -1.0, **NO_LOSS}
    model = thrusters(CATAMARAN).with_values(values)
    inputs = np.tile([1.0, -1.0], (2000, 1))
    x, _ = trajectory(model, inputs, 0.02, np.zeros(len(model.states)))
    assert x[-1, 2] == pytest.approx(math.sqrt(2 * 0.3 * 1.1 / 0.3), rel=1e-6)  # port ahead: to starboard
    assert x[-1, :2] == pytest.approx([0.0, 0.0], abs=1e-9)


def fossen_rates(values: dict[str, float], nu: Array, tau: Array) -> Array:
    """M^-1 (tau - C(nu) nu - D(nu) nu) with the matrices of Fossen 2021, eqs. (6.14), (6.40) and section 6.5."""
    u, v, r = nu
    M = np.array(
        [[values["M_u"], 0, 0], [0, values["M_v"], values["M_c"]], [0, values["M_c"], values["M_r"]]]
    )  # fmt: skip
    lateral = M[1, 1] * v + M[1, 2] * r
    C = np.array([[0, 0, -lateral], [0, 0, M[0, 0] * u], [lateral, -M[0, 0] * u, 0]])
    c = values
    D = -np.array([
        [c["X_u"] + c["X_uu"] * abs(u), 0, 0],
        [0, c["Y_v"] + c["Y_vv"] * abs(v) + c["Y_uv"] * abs(u), c["Y_r"] + c["Y_ur"] * u + c["N_fin"] * abs(u)],
        [c["N_u"] + c["N_uu"] * abs(u), c["N_v"] + c["N_uv"] * u + c["N_fin"] * abs(u),
         c["N_r"] + c["N_rr"] * abs(r) + c["N_ur"] * abs(u)],
    ])  # fmt: skip
    return np.linalg.solve(M, tau - C @ nu - D @ nu)


def test_a_fin_abaft_acts_as_its_lift_at_its_place_ahead_and_astern(rng: np.random.Generator) -> None:
    """Lift -K |u| (v + x r) at x, by hand: three coefficients, one of which counts twice."""
    K, x = 0.8, -0.6
    base = thrusters(CATAMARAN)
    still = {p.name: 0.0 for p in base.parameters if p.name[0] in "XYN"}
    fin = base.with_values(still | {"Y_uv": -K, "N_ur": -K * x**2, "N_fin": -K * x})
    bare = base.with_values(still)
    for u, v, r in rng.normal(size=(10, 3)):
        state = np.concatenate([[u, v, r], np.zeros(len(base.states) - 3)])
        lift = -K * abs(u) * (v + x * r)
        for name, force in (("Y_H", lift), ("N_H", x * lift)):
            added = [float(model.forces(state[None], np.zeros((1, 2)))[name][0]) for model in (fin, bare)]
            assert added[0] - added[1] == pytest.approx(force, abs=1e-12)


def test_rates_equal_the_matrices_of_fossen(rng: np.random.Generator) -> None:
    layout = ThrusterLayout(
        (
            Thruster("bow", 0.4, 0.1, CommandInput("command_1", 1500.0, 400.0), AngleInput("alpha_1"), lag=0.0),
            Thruster("stern", -0.5, -0.2, CommandInput("command_2", 1500.0, -400.0), 0.3, lag=0.0, dead_band=0.05),
        )
    )
    base = thrusters(layout)
    out = np.empty(6)
    for _ in range(50):
        values = {p.name: p.value + 0.3 * rng.normal() for p in base.parameters if p.name[0] in "XYN" and p.scale}
        curve = {
            f"{k}_{n}": float(rng.uniform(0.5, 2.0)) for k in ("k_f", "k_b", "p_f", "p_b") for n in ("bow", "stern")
        }
        curve = {k: max(v, 1.0) if k[0] == "p" else v for k, v in curve.items()}
        loss = {f"{k}_{n}": float(rng.uniform(0.0, 0.3)) for k in ("k_J", "k_4") for n in ("bow", "stern")}
        mass = {"M_u": 1.3, "M_v": 1.9, "M_c": 0.2, "M_r": 0.4}
        model = base.with_values(values | curve | loss | mass | {"Y_T": 0.0, "Y_NT": 0.0})
        p = {item.name: item.value for item in model.parameters}
        nu, alpha = rng.normal(size=3), rng.uniform(-3, 3)
        us = rng.uniform(1100, 1900, size=2)
        inputs = dict(zip(model.input_names, np.zeros(3), strict=True)) | {
            "command_1": us[0],
            "command_2": us[1],
            "alpha_1": alpha,
        }
        tau = np.zeros(3)
        for name, share, angle, x, y in (
            ("bow", (us[0] - 1500) / 400, alpha, 0.4, 0.1),
            ("stern", -(us[1] - 1500) / 400, 0.3, -0.5, -0.2),
        ):
            b = np.array([math.cos(angle), math.sin(angle), x * math.sin(angle) - y * math.cos(angle)])
            w = b @ nu
            m = max((abs(share) - p[f"dead_{name}"]) / (1 - p[f"dead_{name}"]), 0.0)
            way = "f" if share > 0 else "b"
            T = math.copysign(p[f"k_{way}_{name}"] * m ** p[f"p_{way}_{name}"], share)
            T = T - p[f"k_J_{name}"] * math.sqrt(T) * w if share > 0 else T * math.exp(-p[f"k_4_{name}"] * w**2)
            tau += b * T
        state = np.concatenate([nu, np.zeros(3)])
        order = np.array([inputs[n] for n in model.input_names])
        model.compiled.rates(0.0, state, order, model.parameters.values, out)
        np.testing.assert_allclose(out[:3], fossen_rates(p, nu, tau), rtol=1e-10, atol=1e-10)


def test_cross_flow_equals_a_fine_sum_over_the_hull() -> None:
    model = craft(ONE_AFT, damping=Damping.CROSS_FLOW, length=2.0)
    c = {p.name: p.value for p in model.parameters}
    x = np.linspace(-1.0, 1.0, 20001)
    for v, r in ((0.5, 0.0), (0.3, 0.2), (0.1, -0.8), (0.0, 0.6)):
        forces = model.forces(np.array([[0.0, v, r, 0.0, 0.0, 0.0]]), np.zeros((1, 1)))
        flow = v + x * r
        drag = -c["D_c"] * np.abs(flow) * flow
        assert forces["Y_flow"][0] == pytest.approx(np.trapezoid(drag, x), rel=1e-2, abs=1e-9)
        assert forces["N_flow"][0] == pytest.approx(np.trapezoid(x * drag, x), rel=1e-2, abs=1e-9)


def test_an_open_water_curve_is_the_propellers_polynomial_ahead() -> None:
    thruster = Thruster("screw", -3.0, 0.0, CommandInput("rpm_1"), curve=ThrustCurve.OPEN_WATER, diameter=0.5, lag=0.0)
    model = craft(thruster).with_values({"w_P": 0.2, "t_P": 0.1, "k_0": 0.45, "k_1": -0.3, "k_2": -0.15})
    n, u = np.array([4.0, 8.0, 8.0]), np.array([1.0, 1.0, 3.0])
    states = np.zeros((3, 6))
    states[:, 0] = u
    J = 0.8 * u / (n * 0.5)
    expected = 0.9 * 1025.0 * n**2 * 0.5**4 * (0.45 - 0.3 * J - 0.15 * J**2)
    np.testing.assert_allclose(model.forces(states, n[:, None])["T_screw"], expected, rtol=1e-12)
    assert model.forces(states, -n[:, None])["T_screw"].max() < 0.0


def test_knots_are_joined_by_straight_lines() -> None:
    knots = (-1.0, -0.4, 0.0, 0.5, 1.0)
    thruster = Thruster("aft", -0.5, 0.0, CommandInput("command_1"), curve=ThrustCurve.KNOTS, knots=knots, lag=0.0)
    model = craft(thruster).with_values({"T_0": -2.0, "T_1": -0.5, "T_3": 0.7, "T_4": 3.0, **NO_LOSS})
    c = np.linspace(-1.2, 1.2, 25)
    thrust = model.forces(np.zeros((25, 6)), c[:, None])["T_aft"]
    inside = np.abs(c) <= 1.0
    np.testing.assert_allclose(thrust[inside], np.interp(c[inside], knots, [-2.0, -0.5, 0.0, 0.7, 3.0]), atol=1e-12)
    assert thrust[-1] == pytest.approx(3.0 + 0.2 * 4.6)  # the last slope goes on


def test_an_azimuth_turns_no_faster_than_its_rate() -> None:
    thruster = Thruster("pod", -0.5, 0.0, CommandInput("command_1"), AngleInput("alpha_1", 0.2, 0.5), lag=0.0)
    model = craft(thruster)
    inputs = np.tile([0.0, 2.0], (400, 1))
    x, _ = trajectory(model, inputs, 0.02, np.zeros(7))
    angle = x[:, model.states.index("a_pod")]
    assert np.max(np.diff(angle)) / 0.02 == pytest.approx(0.5, rel=1e-9)
    assert angle[-1] == pytest.approx(2.0, abs=1e-4)


def mirrored(vector: Array, names: tuple[str, ...]) -> Array:
    """States or inputs of the mirrored craft: lateral ones change sign, sides change places."""
    swap = {"c_port": "c_starboard", "command_1": "command_2"}
    swap |= {b: a for a, b in swap.items()}
    by_name = dict(zip(names, vector, strict=True))
    return np.array([by_name[swap.get(n, n)] * (-1.0 if n in ("v", "r", "psi", "y0") else 1.0) for n in names])


def test_the_mirrored_craft_makes_the_mirrored_motion(rng: np.random.Generator) -> None:
    model = thrusters(CATAMARAN).with_values(
        {"N_ur": -0.4, "N_uv": 0.2, "Y_NT": 0.3, "M_c": 0.1, "k_J": 0.2, "k_4": 0.1}
    )
    here, there = np.empty(8), np.empty(8)
    for _ in range(30):
        x, u = rng.normal(size=8), rng.uniform(-1, 1, size=2)
        p = model.parameters.values
        model.compiled.rates(0.0, x, u, p, here)
        x, u = mirrored(x, model.states), mirrored(u, model.input_names)
        model.compiled.rates(0.0, x, u, p, there)
        np.testing.assert_allclose(there, mirrored(here, model.states), rtol=1e-12, atol=1e-12)


def test_an_azimuth_with_lags_and_cross_flow_conforms() -> None:
    thruster = Thruster("pod", -0.5, 0.2, CommandInput("command_1"), AngleInput("alpha_1", 0.5))
    check_model(thrusters(ThrusterLayout((thruster,), Damping.CROSS_FLOW, 1.2)), points=10)


def test_the_registry_has_two_fixed_thrusters_by_default() -> None:
    assert MODELS["thrusters"]().input_names == ("command_1", "command_2")
