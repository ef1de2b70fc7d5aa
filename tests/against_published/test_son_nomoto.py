"""The container ship of Son & Nomoto 1981 against its equations in the prime system, written again and by SciPy."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial.core.values import Array, Record
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.published import container_ship, s175
from seatrial.physics.simulate.replay import replay
from seatrial.physics.simulate.steer import manoeuvre

C = s175().values
L, G, RHO, GM, D, A_R, VOLUME = 175.0, 9.81, 1025.0, 0.3, 6.533, 33.0376, 21222.0
RPM = 70.0


def prime_rates(state: Array, delta: float, n: float) -> list[float]:
    """Rates of (u, v, r, p, phi, psi, x, y); forces, masses and motions dimensionless as printed."""
    u, v, r, p, phi, psi, _, _ = state
    U = math.hypot(u, v)
    u, v, r, p = u / U, v / U, r * L / U, p * L / U
    powers = {"v": v, "r": r, "p": p, "phi": phi, "vvv": v**3, "rrr": r**3, "vvr": v * v * r, "vrr": v * r * r,
              "vvphi": v * v * phi, "vphiphi": v * phi**2, "rrphi": r * r * phi, "rphiphi": r * phi**2}  # fmt: skip
    hull = {force: sum(C[f"{force}_{term}"] * value for term, value in powers.items()) for force in "YKN"}
    w = v + C["x_P_prime"] * r
    u_P = u * (1 - C["w_P0"] + C["tau_P"] * w**2)
    J = u_P * U / (n * D)
    K_T = 0.527 - 0.455 * J
    u_R = u_P * C["epsilon"] * math.sqrt(1 + 8 * C["kappa"] * K_T / (math.pi * J**2))
    v_R = 0.088 * v - 0.156 * r - 0.275 * r**3 + 1.96 * r**2 * v
    F_N = -(6.13 * 1.8219 / (1.8219 + 2.25)) * A_R / L**2 * (u_R**2 + v_R**2) * math.sin(delta + math.atan(v_R / u_R))
    T = 2 * D**4 * K_T * n**2 / (U * L) ** 2
    m, m_x, m_y, J_z, J_x = 0.00792, 0.000238, 0.007049, 0.000419, 0.0000034
    weight = 2 * G * VOLUME / (L * U) ** 2
    X = (-0.0004226 * u * u - 0.00311 * v * r - 0.00386 * v * v + 0.0002 * r * r - 0.0002 * phi**2 + (1 - 0.175) * T
         + 0.71 * F_N * math.sin(delta) + (m + m_y) * v * r)  # fmt: skip
    side = F_N * math.cos(delta)
    Y = hull["Y"] + 1.237 * side - (m + m_x) * u * r
    K = hull["K"] - 1.237 * 0.033 * side + m_x * 0.0313 * u * r - weight * GM / L * phi
    N = hull["N"] + (-0.5 - 0.237 * 0.48) * side
    mass = np.array([[m + m_y, -m_y * 0.0313, m_y * 0.05],
                     [-m_y * 0.0313, 0.0000176 + J_x, 0.0],
                     [m_y * 0.05, 0.0, 0.000456 + J_z]])  # fmt: skip
    dv, dp, dr = np.linalg.solve(mass, [Y, K, N])
    cos, sin = math.cos(psi), math.sin(psi)
    return [X / (m + m_x) * U**2 / L, dv * U**2 / L, dr * (U / L) ** 2, dp * (U / L) ** 2, p * U / L,
            r * U / L * math.cos(phi), U * (u * cos - v * sin * math.cos(phi)),
            U * (u * sin + v * cos * math.cos(phi))]  # fmt: skip


CHANNELS = ("u", "v", "r", "p", "phi", "psi", "x0", "y0")


def integrated(record: Record, delta: Callable[[float], float]) -> Array:
    """The same inputs through the printed equations by an integrator of eighth order, (n, 8)."""
    start = [float(record[name][0]) for name in CHANNELS]
    solution = solve_ivp(
        lambda t, x: prime_rates(x, delta(t), RPM / 60), (0.0, float(record.time[-1])), start, "DOP853", record.time,
        rtol=1e-10, atol=1e-12, max_step=record.dt,
    )  # fmt: skip
    return solution.y.T


@pytest.mark.parametrize("text", ["turning-circle:10", "turning-circle:35", "zigzag:10/10", "zigzag:20/20"])
def test_manoeuvres_agree_with_an_independent_integration(text: str) -> None:
    record = manoeuvre(container_ship(), programme(text), dt=0.5, duration=900.0, inputs={"n": RPM / 60})
    other = integrated(record, lambda t: float(np.interp(t, record.time, record["delta"])))
    for name, column in zip(CHANNELS, other.T, strict=True):
        # mass: print gives m' 0.00792 and the volume, which differ by 5e-5; Runge-Kutta of 0.5 s
        size = np.abs(column).max()
        assert np.abs(record[name] - column).max() < 3e-4 * size, name


def test_a_decay_under_way_agrees_with_an_independent_integration() -> None:
    time = 0.5 * np.arange(601.0)
    inputs = Record.from_arrays("decay", time, {"n": np.full(601, RPM / 60), "delta": np.zeros(601)})
    start = dict.fromkeys(container_ship().states, 0.0) | {"u": 7.33, "phi": math.radians(10.0)}
    record = replay(container_ship(), inputs, start)
    other = integrated(record, lambda _: 0.0)
    assert np.abs(np.degrees(record["phi"] - other[:, 4])).max() < 0.01
    assert np.abs(np.degrees(record["psi"] - other[:, 5])).max() < 0.01
    heel = np.degrees(record["phi"])
    crossings = np.flatnonzero(np.diff(np.sign(heel)))
    inertia = 0.0000176 + 0.0000034 - (0.007049 * 0.0313) ** 2 / (0.00792 + 0.007049)  # sway follows
    natural = math.sqrt(RHO * G * VOLUME * GM / (inertia * RHO / 2 * L**5))
    assert 2 * np.mean(np.diff(time[crossings])) == pytest.approx(2 * math.pi / natural, rel=0.1)
    assert np.abs(heel[-100:]).max() < 5.0


def test_a_turn_heels_the_ship_inward_first_and_then_outward() -> None:
    turn = programme("turning-circle:10")
    record = manoeuvre(container_ship(), turn, dt=0.5, duration=1200.0, inputs={"n": RPM / 60})
    heel = np.degrees(record["phi"])
    inward = float(record.time[np.argmax(heel)])
    outward = float(record.time[np.argmin(heel)])
    assert heel.max() > 0.2  # a rudder below G, positive to starboard
    assert inward < outward
    assert heel[-1] < -3.0
    assert record["r"][-1] > 0.0
