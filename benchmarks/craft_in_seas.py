"""The craft of `waves.py` and `criteria.py`: equations written anew, with true values."""

import math
from collections.abc import Sequence
from functools import cache, partial

import numpy as np
from simulated_seas import Craft, Helm

import seatrial as st
from seatrial.physics.models.thruster_layout import CommandInput, Damping, ThrustCurve, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters

DEGREE = math.pi / 180.0  # rad
COMPASS, GYRO = 0.1 * DEGREE, 0.05 * DEGREE  # rad and rad/s, noise of a good compass and of a rate gyro; chosen
RUDDER = Helm(
    (1.0,), (0.0,), amplitude=15.0 * DEGREE, executes=(10.0 * DEGREE, 10.0 * DEGREE), limit=25.0 * DEGREE,
    slew=3.0 * DEGREE, gain=1.0, rate_gain=6.0,
)  # fmt: skip
"""Of a ship: steps and zigzags of common size, 3 deg/s of machinery, a PD autopilot that is well damped; chosen."""


@cache
def nomoto() -> Craft:
    """Return T r' + r = K delta (Nomoto et al. 1957), a ship of 50 m at 5 m/s; K and T of the wave-motion study."""
    K, T = 0.09, 11.0  # 1/s, s; chosen
    model = st.models.nomoto().with_values({"K": K, "T": T, "U": 5.0})
    A, B = np.array([[-1.0 / T, 0.0], [1.0, 0.0]]), np.array([K / T, 0.0])
    return _ship("nomoto", model, {"K": 0.1, "T": 10.0}, (A, B), T, 4.0 * DEGREE * K / T)


@cache
def second_order() -> Craft:
    """Return T1 T2 r'' + (T1 + T2) r' + r = K (delta + T3 delta'), fitted by the model of first order."""
    K, T1, T2, T3 = 0.09, 14.0, 2.0, 5.0  # 1/s, s, s, s; chosen
    T = T1 + T2 - T3  # s, of the first-order model that agrees at low frequency (Nomoto et al. 1957)
    A = np.array([[0.0, 1.0, 0.0], [-1.0 / (T1 * T2), -(T1 + T2) / (T1 * T2), 0.0], [1.0, 0.0, 0.0]])
    zero = K * T3 / (T1 * T2)  # of delta in r', the state r' - zero delta taking the place of r'
    B = np.array([zero, K / (T1 * T2) - (T1 + T2) / (T1 * T2) * zero, 0.0])
    model = st.models.nomoto().with_values({"K": K, "T": T, "U": 5.0})
    return _ship("second-order", model, {"K": 0.1, "T": 10.0}, (A, B), T, 4.0 * DEGREE * K / T)


def _ship(
    name: str, model: st.Model, guess: dict[str, float], linear: tuple[np.ndarray, np.ndarray], T: float, gust: float
) -> Craft:
    """A ship of 50 m at 5 m/s; a gust of size 1 is what a rudder of 4 deg does, as in the problem nomoto-gusts."""
    noise = {"psi": COMPASS, "r": GYRO, "u": 0.05, "v": 0.05, "x0": 0.5, "y0": 0.5}  # m/s and m, of a receiver; chosen
    ship = st.Ship("ship of 50 m", {"L": 50.0})
    return Craft(
        name, model, ship, ("delta",), RUDDER, 5.0, (0.0, 0.0, gust), T, noise, 900.0, guess=guess, linear=linear
    )


@cache
def waterjet() -> Craft:
    """Return the craft of Song et al. 2025 at 0.8 m/s; nozzle to port positive, jet velocity constant."""
    model = st.models.waterjet()
    p = {q.name: q.value for q in model.parameters}
    helm = Helm(
        (-1.0, 0.0), (0.0, 1.866), amplitude=20.0 * DEGREE, executes=(20.0 * DEGREE, 20.0 * DEGREE),
        limit=25.0 * DEGREE, slew=5.0 * DEGREE, gain=1.5, rate_gain=20.0,
    )  # fmt: skip
    # accelerations as of a nozzle at 20 deg, and in surge a force of the same size as in sway; noise: chosen
    gust, noise = (1.0e-3, 2.5e-3, 1.55e-3), {"u": 0.02, "v": 0.02, "r": 0.1 * DEGREE, "psi": 0.2 * DEGREE}
    ship = st.Ship("waterjet craft", {"L": p["L"]})
    return Craft(
        "waterjet", model, ship, ("delta", "v_j"), helm, 0.8, gust, 10.0, noise | {"x0": 0.2, "y0": 0.2}, 600.0,
        rates=partial(_waterjet, p), prior=0.3,
    )  # fmt: skip


def _waterjet(p: dict[str, float], nu: Sequence[float], inputs: Sequence[float]) -> tuple[float, float, float]:
    """Song et al. 2025, eqs. (1) to (3) with their misprints corrected."""
    (u, v, r), (delta, v_j), L = nu, inputs, p["L"]
    U, r_L, q = math.hypot(u, v), L * r, 0.5 * p["rho"] * L * p["d"]
    jet = p["rho"] * p["A_j"] * v_j * (v_j - p["alpha"] * u)  # eq. (3)
    X = q * (p["X_uu"] * u * u + p["X_vv"] * v * v + p["X_rr"] * r_L * r_L) + jet * math.cos(delta)  # eqs. (2), (3)
    side = (p["Y_v"] * v + p["Y_r"] * r_L) * U + p["Y_vv"] * v * abs(v) + p["Y_vr"] * abs(v) * r_L
    Y = q * (side + p["Y_rr"] * r_L * abs(r_L)) + jet * math.sin(delta)  # eqs. (2), (3)
    turn = (p["N_v"] * v + p["N_r"] * r_L) * U + p["N_rr"] * r_L * abs(r_L)
    N = q * L * turn + p["x_T"] * jet * math.sin(delta)  # eqs. (2), (3)
    m_u, m_v = p["m"] + p["m_x"], p["m"] + p["m_y"]
    return (X + m_v * v * r) / m_u, (Y - m_u * u * r) / m_v, N / (p["I_z"] + p["J_z"])  # eq. (1)


@cache
def thruster_craft() -> Craft:
    """Return a craft of 5 m with a thruster at each corner, set at 45 deg to the bow; coefficients chosen."""
    x, y, a = 1.8, 0.8, 0.25 * math.pi  # m forward and to starboard, rad
    corners = ((x, -y, a), (x, y, -a), (-x, y, a), (-x, -y, -a))
    names = ("port_bow", "starboard_bow", "starboard_stern", "port_stern")
    four = tuple(
        Thruster(n, *c[:2], CommandInput(f"command_{k}"), c[2], curve=ThrustCurve.QUADRATIC, lag=0.0,
                 same_as="" if k == 1 else names[0])
        for k, (n, c) in enumerate(zip(names, corners, strict=True), start=1)
    )  # fmt: skip
    true = {"k_f": 0.25, "k_b": 0.18, "X_u": -0.05, "X_uu": -0.1, "Y_v": -0.5, "Y_vv": -0.4, "N_r": -0.6, "N_rr": -0.8,
            "M_v": 1.2, "M_r": 2.5, "k_J": 0.0, "k_4": 0.0}  # fmt: skip
    model = thrusters(ThrusterLayout(four, Damping.DIAGONAL, 5.0, 1.0)).with_values(true)
    model = model.with_parameters(model.parameters.fixed("k_J", "k_4", "X_u"))
    columns = [(math.cos(b), math.sin(b), f * math.sin(b) - g * math.cos(b)) for f, g, b in corners]  # Fossen (9.1)
    turn = tuple(math.copysign(1.0, c[2]) for c in columns)
    pull = tuple((0.05 * c[0], 0.05 * c[1], 0.05 * math.copysign(1.0, c[2])) for c in columns)  # of orders; chosen
    helm = Helm(
        turn, (0.5,) * 4, amplitude=0.3, executes=(0.04, 20.0 * DEGREE), limit=0.15, slew=0.5, gain=0.15, rate_gain=0.4,
        is_each=True, station=pull,
    )  # fmt: skip
    noise = {"u": 0.03, "v": 0.03, "r": 0.3 * DEGREE, "psi": 0.3 * DEGREE, "x0": 0.1, "y0": 0.1}  # a small craft's
    return Craft(
        "thrusters", model, st.Ship("four thrusters", {"L": 5.0}), tuple(f"command_{k}" for k in range(1, 5)), helm,
        1.1, (0.02, 0.02, 0.03), 4.0, noise, 600.0, rates=partial(_thrusters, true, columns), prior=0.3,
    )  # fmt: skip


def _thrusters(
    p: dict[str, float], columns: list[tuple[float, float, float]], nu: Sequence[float], inputs: Sequence[float]
) -> tuple[float, float, float]:
    """Fossen 2021, eqs. (6.14) and (6.40), diagonal damping; thrust grows with the square of the command."""
    u, v, r = nu
    thrust = [(p["k_f"] if c > 0.0 else p["k_b"]) * c * abs(c) for c in inputs]
    X, Y, N = (sum(t * column[i] for t, column in zip(thrust, columns, strict=True)) for i in range(3))
    X += (p["X_u"] + p["X_uu"] * abs(u)) * u + p["M_v"] * v * r
    Y += (p["Y_v"] + p["Y_vv"] * abs(v)) * v - u * r  # M_u is 1: forces are those on each kg of it
    N += (p["N_r"] + p["N_rr"] * abs(r)) * r + (1.0 - p["M_v"]) * u * v
    return X, Y / p["M_v"], N / p["M_r"]


SCALE = 80.0 / 7.0  # of a ship of 80 m over the 7 m model of KVLCC2; chosen
HULL = ("Y_v", "Y_r", "N_v", "N_r", "N_vvr", "N_rrr")  # that are estimated: yaw and sway of moderate manoeuvres


@cache
def mmg() -> Craft:
    """Return a ship of 80 m of KVLCC2's form (Yasukawa & Yoshimura 2015) at 4 m/s; six hull terms are free."""
    values = st.models.parameter_set("kvlcc2")
    powers = {"L": 1, "B": 1, "d": 1, "x_G": 1, "D_P": 1, "H_R": 1, "A_R": 2, "m": 3, "I_z": 5}  # Froude's law
    ship = st.Ship("ship of 80 m", {n: v * SCALE ** powers.get(n, 0) for n, v in values.ship.particulars.items()})
    model = values.applied_to(st.models.mmg()).with_ship(ship)
    model = model.with_parameters(model.parameters.only_free(HULL))
    p = {q.name: q.value for q in model.parameters}
    n = 11.9 / math.sqrt(SCALE)  # 1/s, by which the model of 7 m keeps 1.18 m/s; from the balance of surge
    helm = Helm(
        (1.0, 0.0), (0.0, n), amplitude=15.0 * DEGREE, executes=(10.0 * DEGREE, 10.0 * DEGREE), limit=25.0 * DEGREE,
        slew=3.0 * DEGREE, gain=1.0, rate_gain=20.0,
    )  # fmt: skip
    noise = {"u": 0.05, "v": 0.05, "r": 0.02 * DEGREE, "psi": COMPASS, "x0": 0.5, "y0": 0.5}  # m/s, m: chosen
    # accelerations as of a rudder at 4 deg, rounded; chosen
    return Craft(
        "mmg", model, ship, ("delta", "n"), helm, 4.0, (1.0e-3, 1.8e-3, 1.7e-4), 20.0, noise, 900.0,
        rates=partial(_mmg, p), prior=0.3,
    )  # fmt: skip


def _mmg(p: dict[str, float], nu: Sequence[float], inputs: Sequence[float]) -> tuple[float, float, float]:
    """Yasukawa & Yoshimura 2015: hull, propeller and rudder ahead; equations of motion with x_G."""
    (u, v, r), (delta, n), L, rho = nu, inputs, p["L"], p["rho"]
    U = math.hypot(u, v)
    beta, w, q = math.atan2(-v, u), r * L / U, 0.5 * rho * L * p["d"] * U * U
    s = v / U
    X_H = q * (-p["R_0"] + p["X_vv"] * s**2 + p["X_vr"] * s * w + p["X_rr"] * w**2 + p["X_vvvv"] * s**4)
    cubic = [s**3, s**2 * w, s * w**2, w**3]
    names = ("vvv", "vvr", "vrr", "rrr")
    Y = q * (p["Y_v"] * s + p["Y_r"] * w + sum(p[f"Y_{k}"] * c for k, c in zip(names, cubic, strict=True)))
    N = q * L * (p["N_v"] * s + p["N_r"] * w + sum(p[f"N_{k}"] * c for k, c in zip(names, cubic, strict=True)))
    beta_P = beta - p["x_P_prime"] * w
    limit = p["C_2_plus"] if beta_P > 0.0 else p["C_2_minus"]
    wake = (1.0 - p["w_P0"]) * (1.0 + (1.0 - math.exp(-p["C_1"] * abs(beta_P))) * (limit - 1.0))
    J = u * wake / (n * p["D_P"])
    K_T = p["k_0"] + p["k_1"] * J + p["k_2"] * J**2
    X_P = (1.0 - p["t_P"]) * rho * n**2 * p["D_P"] ** 4 * K_T
    normal = _rudder_force(p, u * wake, K_T, J, U * (beta - p["l_R_prime"] * w), delta)
    X = X_H + X_P - (1.0 - p["t_R"]) * normal * math.sin(delta)
    Y -= (1.0 + p["a_H"]) * normal * math.cos(delta)
    N -= (p["x_R_prime"] + p["a_H"] * p["x_H_prime"]) * L * normal * math.cos(delta)
    unit, m, x_G = 0.5 * rho * L * L * p["d"], p["m"], p["x_G"]
    M_u, M_v, M_c = m + p["m_x_prime"] * unit, m + p["m_y_prime"] * unit, m * x_G
    M_r = p["I_z"] + m * x_G**2 + p["J_z_prime"] * unit * L * L
    Y_m, N_m, D = Y - M_u * u * r, N - M_c * u * r, M_v * M_r - M_c**2
    return (X + M_v * v * r + M_c * r * r) / M_u, (Y_m * M_r - N_m * M_c) / D, (N_m * M_v - Y_m * M_c) / D


def _rudder_force(p: dict[str, float], u_P: float, K_T: float, J: float, side: float, delta: float) -> float:
    """Normal force; side: U beta_R."""
    eta, inflow = p["D_P"] / p["H_R"], math.sqrt(1.0 + 8.0 * K_T / (math.pi * J**2))
    slip = 1.0 + p["kappa"] * (inflow - 1.0)
    u_R = p["epsilon"] * u_P * math.sqrt(eta * slip**2 + 1.0 - eta)
    v_R = (p["gamma_R_plus"] if side > 0.0 else p["gamma_R_minus"]) * side
    speed = math.hypot(u_R, v_R)
    return 0.5 * p["rho"] * p["A_R"] * p["f_alpha"] * speed * (u_R * math.sin(delta) - v_R * math.cos(delta))


CRAFT = {"nomoto": nomoto, "waterjet": waterjet, "thrusters": thruster_craft, "mmg": mmg}
