"""Every built-in model: exact Jacobians against differences, the mirror law, finite at rest and astern."""

import math
import os
import subprocess
import sys

import mpmath
import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.models import MODELS, model_named
from seatrial.physics.models.abkowitz import ROLLING_TERMS
from seatrial.physics.models.forces import variables_of
from seatrial.physics.models.mmg import mmg_roll, mmg_shallow
from seatrial.physics.models.published import (
    QI2025_SHIP,
    container_ship,
    esso_osaka,
    kvlcc2,
    kvlcc2_l7,
    theoretical_coefficients,
)
from seatrial.problems.twin_ships import twin_screw_ship

MIRRORED = {"v", "r", "r_rest", "psi", "y0", "phi", "p", "delta", "alpha_w", "alpha_f", "F2", "M4",
            "wind_direction", "n_difference", "v_j_difference", "bucket_difference"}  # fmt: skip
# parameters that change sign in the mirror; those split by side change places, unless each side has its own
ODD = {"Y_0", "N_0", "Y_T", "N_T", "Y_dd", "N_dd", "Y_nn", "Y_nu", "N_nn", "N_nu", "delta_0", "current_east",
       "phi_0"}  # fmt: skip
SIDES = {"C_2_plus": "C_2_minus", "gamma_R_plus": "gamma_R_minus"}

ABKOWITZ_SHIP = {"L": 7.0, "m": 3270.0, "x_G": 0.25, "I_z": 1e4, "rho": 1000.0, "U_n": 1.2}
INERTIA = {"X_udot": -0.001, "Y_vdot": -0.015, "Y_rdot": -0.001, "N_vdot": -0.001, "N_rdot": -0.0008}


def filled(name: str, rng: np.random.Generator) -> Model:
    """The model with a value other than zero for every parameter."""
    known = {"mmg": kvlcc2, "mmg_roll": rolling_kvlcc2, "son_nomoto": container_ship, "mmg_twin": twin_screw_ship,
             "mmg_shallow": shallow_kvlcc2}  # fmt: skip
    model = known.get(name, MODELS[name])()
    if name.startswith("abkowitz"):
        rolling = {"GM": 0.2, "I_x": 600.0, "K_pdot": -1e-5} if name == "abkowitz_roll" else {}
        small = {p.name: float(rng.normal(scale=0.01)) for p in model.parameters if p.value == 0.0}
        return model.with_values(small | ABKOWITZ_SHIP | INERTIA | {"prime": 0.7} | rolling)
    if name == "heave_pitch_strip":
        at_rest = {"a33": 6e5, "b33": 8e5, "a35_0": 5e6, "b35_0": 3e6, "a55_0": 1e8, "b55_0": 1.5e8}
        return model.with_values({**at_rest, "lift_1": 2e6, "x_f1": -25.0}).with_ship(QI2025_SHIP)
    if name.startswith("heave_pitch"):
        return (
            theoretical_coefficients(135)
            .applied_to(model)
            .with_values({"lift_1": 2e6, "x_f1": -25.0, "lift_2": 1e6, "x_f2": 20.0})
        )
    if name == "section":
        return model.with_values({p.name: float(rng.uniform(0.5, 1.5)) for p in model.parameters} | {"I_x": 5.0})
    small = {p.name: float(rng.normal(scale=0.01)) for p in model.parameters if p.value == 0.0}
    return model.with_values(small | ({"A_T": 0.3, "A_L": 1.1, "U_0": 0.02} if name in known else {}))


def rolling_kvlcc2() -> Model:
    """The 7 m tanker with levers, GM and roll inertia of a rolling ship; chosen."""
    ship = mmg_roll().with_values({"GM": 0.1, "I_x": 600.0, "J_x_prime": 1e-5})
    return kvlcc2_l7().applied_to(ship)


def shallow_kvlcc2() -> Model:
    """The 7 m tanker in water of a recorded depth."""
    return kvlcc2_l7().applied_to(mmg_shallow())


def call(model: Model, x: Array, u: Array, p: Array) -> Array:
    """Rates and outputs in one vector."""
    rates, out = np.empty(len(model.states)), np.empty(len(model.outputs))
    model.compiled.rates(0.0, x, u, p, rates)
    if len(out):
        model.compiled.outputs(0.0, x, u, p, out)
    return np.concatenate([rates, out])


def point(model: Model, rng: np.random.Generator) -> tuple[Array, Array]:
    """States and inputs of ordinary size; surge ahead or astern, propeller either way."""
    size = {"omega_e": 2.0, "F3": 1e5, "M5": 1e6, "u": 1.0, "v": 0.3, "r": 0.1, "n": 8.0, "wind_speed": 3.0, "v_j": 2.0}
    x = rng.normal(size=len(model.states)) * [size.get(s, 1.0) for s in model.states]
    return x, rng.normal(size=len(model.inputs)) * [size.get(i, 0.4) for i in model.input_names]


@pytest.fixture(scope="module", params=sorted(MODELS))
def model(request: pytest.FixtureRequest) -> Model:
    return filled(request.param, np.random.default_rng(7))


def test_jacobians_equal_central_differences(model: Model, rng: np.random.Generator) -> None:
    p = model.parameters.values
    n, columns = len(model.states), len(model.states) + len(model.inputs) + len(p)
    for _ in range(25):
        x, u = point(model, rng)
        base = np.concatenate([x, u, p])
        cut = (n, n + len(u))
        jacobian, g = np.zeros((n, columns)), np.zeros((len(model.outputs), columns))
        model.compiled.rates_tangent(0.0, x, u, p, np.empty(n), jacobian)
        if len(g):
            model.compiled.outputs_tangent(0.0, x, u, p, np.empty(len(g)), g)
        exact = np.vstack([jacobian, g])
        numeric = np.empty_like(exact)
        sizes = np.maximum(np.abs(base), np.where(base == 0.0, 1e-2, np.minimum(1e-2, 100.0 * np.abs(base))))
        for j in range(columns):
            h = 1e-6 * sizes[j]
            up, down = base.copy(), base.copy()
            up[j] += h
            down[j] -= h
            numeric[:, j] = (call(model, *np.split(up, cut)) - call(model, *np.split(down, cut))) / (2 * h)
        scale = np.abs(exact).max(axis=1, keepdims=True) + 1e-12
        np.testing.assert_allclose(exact / scale, numeric / scale, atol=2e-7)


@pytest.mark.parametrize("name", sorted(set(MODELS) - {"thrusters"}))  # its sides change places: test_thrusters.py
def test_the_mirrored_ship_makes_the_mirrored_motion(name: str, rng: np.random.Generator) -> None:
    model = filled(name, np.random.default_rng(7))
    values = dict(zip(model.parameters.names, model.parameters.values, strict=True))
    mirrored_values = {n: -v if n in ODD else v for n, v in values.items()}
    if model.name.startswith("abkowitz"):
        mirrored_values |= {t: v * _parity(t) for t, v in values.items() if t in ROLLING_TERMS}
    for plus, minus in SIDES.items():
        if plus in values and model.name != "mmg_twin":
            mirrored_values |= {plus: values[minus], minus: values[plus]}
    sign_x = np.array([-1.0 if s in MIRRORED else 1.0 for s in model.states])
    sign_u = np.array([-1.0 if i in MIRRORED else 1.0 for i in model.input_names])
    sign = np.concatenate([sign_x, np.ones(len(model.outputs))])
    q = np.array([mirrored_values[n] for n in model.parameters.names])
    for _ in range(50):
        x, u = point(model, rng)
        here, there = call(model, x, u, model.parameters.values), call(model, x * sign_x, u * sign_u, q)
        np.testing.assert_allclose(there, here * sign, rtol=1e-9, atol=1e-10)


def _parity(term: str) -> float:
    """Sign of a derivative in the mirror: odd letters of the variables and of the force must pair up."""
    odd = sum(variable != "u" for variable in variables_of(term[2:])) + (term[0] in "YKN")
    return -1.0 if odd % 2 else 1.0


@pytest.mark.parametrize("name", ["mmg", "abkowitz"])
def test_a_ship_that_cannot_heel_turns_as_in_the_plane(name: str, rng: np.random.Generator) -> None:
    flat = filled(name, np.random.default_rng(7))
    values = {p.name: p.value for p in flat.parameters}
    ship = rolling_kvlcc2() if name == "mmg" else MODELS["abkowitz_roll"]().with_values({"GM": 0.2, "I_x": 600.0})
    rolling = ship.with_values(values)
    for _ in range(20):
        x, u = point(flat, rng)
        inputs = dict(zip(flat.input_names, u.tolist(), strict=True))
        there = call(rolling, np.append(x, [0.0, 0.0]), np.array([inputs.get(n, 0.0) for n in rolling.input_names]),
                     rolling.parameters.values)  # fmt: skip
        np.testing.assert_allclose(there[:6], call(flat, x, u, flat.parameters.values)[:6], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("n", [-15.0, 0.0, 15.0])
@pytest.mark.parametrize("u", [-0.2, 0.0, 0.2])
@pytest.mark.parametrize("r", [-0.05, 0.0])
def test_berthing_speeds_are_finite(n: float, u: float, r: float) -> None:
    from seatrial.physics.models.mmg import mmg

    model = esso_osaka().applied_to(mmg())
    x, inputs = np.array([u, 0.0, r, 0.0, 0.0, 0.0]), np.array([0.3, n, 1.0, 1.0])
    jacobian = np.zeros((6, 6 + 4 + len(model.parameters)))
    out = np.empty(6)
    model.compiled.rates_tangent(0.0, x, inputs, model.parameters.values, out, jacobian)
    assert np.isfinite(out).all()
    assert np.isfinite(jacobian).all()
    assert abs(out[0]) < 0.1
    assert abs(out[2]) < 0.1


def test_the_propeller_brakes_and_accelerates_without_a_jump() -> None:
    model = kvlcc2()
    n = np.linspace(-12, 12, 2401)
    inputs = np.column_stack([np.full_like(n, 0.2), n, 0 * n, 0 * n])
    states = np.tile([0.8, 0.05, 0.01, 0.0, 0.0, 0.0], (len(n), 1))
    forces = model.forces(states, inputs)
    for name in ("thrust", "X_P", "u_R", "F_N"):
        assert np.abs(np.diff(forces[name])).max() < 0.02 * np.ptp(forces[name]), name
    assert forces["thrust"][0] < 0 < forces["thrust"][-1]


def test_positive_rudder_turns_to_starboard() -> None:
    model = kvlcc2()
    out = np.empty(6)
    model.compiled.rates(
        0.0, np.array([1.2, 0, 0, 0, 0, 0.0]), np.array([0.1, 10, 0, 0.0]), model.parameters.values, out
    )
    assert out[2] > 0


def test_wind_from_starboard_pushes_to_port_and_headwind_astern() -> None:
    from seatrial.physics.models.mmg import mmg

    model = esso_osaka().applied_to(mmg())
    states = np.zeros((2, 6))
    beam_and_head = np.array([[0.0, 0.0, 2.0, math.pi / 2], [0.0, 0.0, 2.0, 0.0]])
    forces = model.forces(states, beam_and_head)
    assert forces["Y_W"][0] < 0
    assert forces["X_W"][1] < 0
    assert abs(forces["Y_W"][1]) < 1e-12


def test_a_current_carries_ship_and_apparent_wind(rng: np.random.Generator) -> None:
    """Water moving with the air's own velocity: no wind is felt aboard a ship adrift."""
    from seatrial.physics.models.mmg import mmg

    model = esso_osaka().applied_to(mmg()).with_values({"current_north": -1.2, "current_east": 0.0, "U_0": 1e-9})
    states = np.zeros((1, 6))
    states[0, 3] = rng.uniform(-3, 3)
    forces = model.forces(states, np.array([[0.0, 0.0, 1.2, 0.0]]))
    assert abs(forces["V_A"][0]) < 1e-8


PROGRAM = """
import hashlib
from seatrial.core.equations.generate import source_text
from seatrial.core.equations.latex import latex_equations
from seatrial.physics.models import MODELS
for name in MODELS:
    model = MODELS[name]()
    text = source_text(model.equations) + repr(latex_equations(model))
    print(name, model.equation_hash, hashlib.sha256(text.encode()).hexdigest())
"""


def test_two_processes_generate_the_same_text() -> None:
    runs = [
        subprocess.run(
            [sys.executable, "-c", PROGRAM],
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        )
        for seed in ("1", "2")
    ]
    assert runs[0].stdout == runs[1].stdout
    assert len(runs[0].stdout.splitlines()) == len(MODELS)


def test_every_equation_names_its_source() -> None:
    from seatrial.core.equations.latex import latex_equations

    for name in MODELS:
        model = model_named(name)
        assert all(b.source for b in (*model.bindings, *model.equations.rates)), name
        lines = latex_equations(model)
        assert len(lines) == len(model.bindings) + len(model.states)
        assert all(line.latex.count("{") == line.latex.count("}") for line in lines)


def test_the_slipstream_keeps_its_digits_where_the_screw_pulls_astern() -> None:
    # z + sqrt(z^2 + U_0^4) of a negative z, with 50 digits
    model = kvlcc2()
    state = np.array([[1.2, 0.1, 0.02, 0.0, 0.0, 0.0]])
    held = np.array([[0.1, -9.0, 0.0, 0.0]])
    values = model.forces(state, held)
    assert values["z"][0] < -0.1
    with mpmath.workdps(50):
        z, U_0 = mpmath.mpf(float(values["z"][0])), mpmath.mpf(model.parameters["U_0"].value)
        exact = float(mpmath.sqrt((z + mpmath.sqrt(z**2 + U_0**4)) / 2))
    assert values["u_inf"][0] == pytest.approx(exact, rel=1e-14)
