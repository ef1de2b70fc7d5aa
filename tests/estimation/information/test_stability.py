"""Course stability against the determinant written by hand, and its interval against drawn ships."""

import numpy as np
import pytest

from seatrial.estimation.information.stability import growth_rate, stability, straight_course_rates
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import kvlcc2, kvlcc2_l7
from seatrial.physics.models.waterjet import waterjet

SPEED = 0.8


def index_by_hand(values: dict[str, float]) -> float:
    """det of the sway-yaw equations of Song et al. 2025, eq. (1) linearised at v = r = 0, times (L/u)^2."""
    q, L, u = values["rho"] * values["L"] * values["d"] / 2, values["L"], SPEED
    sway, yaw = values["m"] + values["m_y"], values["I_z"] + values["J_z"]
    a = np.array(
        [
            [q * values["Y_v"] * u / sway, (q * values["Y_r"] * L * u - (values["m"] + values["m_x"]) * u) / sway],
            [q * L * values["N_v"] * u / yaw, q * L * values["N_r"] * L * u / yaw],
        ]
    )
    return float(np.linalg.det(a)) * (L / u) ** 2


def test_the_index_is_the_determinant_of_sway_and_yaw() -> None:
    model = waterjet()
    values = dict(zip(model.parameters.names, model.parameters.values, strict=True))
    found = stability(model, np.zeros((11, 11)), np.inf, SPEED, np.array([0.0, 1.866]), values["L"])
    assert found is not None
    assert found.index == pytest.approx(index_by_hand(values), rel=1e-9)
    assert found.lower == found.upper == found.index


def test_the_growth_rate_is_the_largest_eigenvalue() -> None:
    model, inputs = waterjet(), np.array([0.0, 1.866])
    found = stability(model, np.zeros((11, 11)), np.inf, SPEED, inputs, 9.8)
    assert found is not None
    largest = np.linalg.eigvals(straight_course_rates(model, SPEED, inputs)).real.max()
    assert found.growth_rate == growth_rate(model, SPEED, inputs) == largest


def test_the_interval_is_that_of_drawn_ships(rng: np.random.Generator) -> None:
    model, inputs = waterjet(), np.array([0.0, 1.866])
    names = model.parameters.free_names
    spread = 0.01 * np.abs([model.parameters[n].value for n in names])
    found = stability(model, np.diag(spread**2), np.inf, SPEED, inputs, 9.8)
    drawn = [
        np.linalg.det(straight_course_rates(model.with_values(dict(zip(names, values, strict=True))), SPEED, inputs))
        for values in np.array([model.parameters[n].value for n in names]) + spread * rng.standard_normal((2000, 11))
    ]
    assert found is not None
    half = 1.96 * float(np.std(drawn)) * (9.8 / SPEED) ** 2
    assert found.upper - found.index == pytest.approx(half, rel=0.1)


def clarke(masses: tuple[float, float, float], rows: tuple[float, float, float, float], unit: float) -> float:
    """C = Y_v (N_r - m x_G u) - N_v (Y_r - m u) over the determinant of inertia, times (L/U)^2.

    masses: M_vv, M_vr, M_rr; rows: Y_v, Y_r - m u, N_v, N_r - m x_G u, all SI.
    """
    (vv, vr, rr), (Y_v, Y_r, N_v, N_r) = masses, rows
    return (Y_v * N_r - N_v * Y_r) / (vv * rr - vr**2) * unit**2


def test_the_index_of_abkowitz_is_that_of_clarke() -> None:
    """Clarke, Gedling & Hine 1983: index from linear derivatives in rho/2 L^2 U^2."""
    linear = {"Y_v": -0.0207, "Y_r": 0.004, "N_v": -0.0090, "N_r": -0.0042}
    added = {"X_udot": -0.00145, "Y_vdot": -0.01465, "N_rdot": -0.0007, "U_n": 1.18}
    model = abkowitz().with_values(linear | added).with_ship(kvlcc2_l7().ship)
    p, u = {q.name: q.value for q in model.parameters}, 1.18
    found = stability(model, np.zeros((len(model.parameters.free),) * 2), np.inf, u, np.zeros(1), p["L"])
    force = 0.5 * p["rho"] * p["L"] ** 2 * u
    mass = 0.5 * p["rho"] * p["L"] ** 3
    masses = (
        p["m"] - p["Y_vdot"] * mass,
        p["m"] * p["x_G"],
        p["I_z"] + p["m"] * p["x_G"] ** 2 - p["N_rdot"] * mass * p["L"] ** 2,
    )
    rows = (
        force * p["Y_v"],
        force * p["L"] * p["Y_r"] - p["m"] * u,
        force * p["L"] * p["N_v"],
        force * p["L"] ** 2 * p["N_r"] - p["m"] * p["x_G"] * u,
    )
    assert found is not None
    assert found.index == pytest.approx(clarke(masses, rows, p["L"] / u), rel=1e-6)
    assert "the sides differ" not in found.text


def kvlcc2_by_hand(gamma: float, u: float, n: float) -> float:
    """Hull, propeller and rudder of Yasukawa & Yoshimura 2015 linearised about v = r = delta = 0."""
    p = {q.name: q.value for q in kvlcc2().parameters}
    L, q = p["L"], 0.5 * p["rho"] * p["L"] * p["d"]
    u_P = (1 - p["w_P0"]) * u
    J = u_P / (n * p["D_P"])
    K_T = p["k_0"] + p["k_1"] * J + p["k_2"] * J**2
    eta, slip = p["D_P"] / p["H_R"], 1 + p["kappa"] * (np.sqrt(1 + 8 * K_T / (np.pi * J**2)) - 1)
    u_R = p["epsilon"] * u_P * np.sqrt(eta * slip**2 + 1 - eta)
    lift = 0.5 * p["rho"] * p["A_R"] * p["f_alpha"] * u_R * gamma
    side, moment = (1 + p["a_H"]) * lift, (p["x_R_prime"] + p["a_H"] * p["x_H_prime"]) * L * lift
    arm, unit = p["l_R_prime"] * L, q * L
    masses = (
        p["m"] + p["m_y_prime"] * unit,
        p["m"] * p["x_G"],
        p["I_z"] + p["m"] * p["x_G"] ** 2 + p["J_z_prime"] * unit * L**2,
    )
    rows = (
        q * p["Y_v"] * u - side,
        q * L * p["Y_r"] * u - side * arm - (p["m"] + p["m_x_prime"] * unit) * u,
        q * L * p["N_v"] * u - moment,
        q * L**2 * p["N_r"] * u - moment * arm - p["m"] * p["x_G"] * u,
    )
    return clarke(masses, rows, L / u)


def test_the_index_of_kvlcc2_counts_both_sides_of_the_rudder_s_inflow() -> None:
    """gamma_R is .640 and .395: stable to one side, unstable to the other, the index is the mean."""
    model, u, n = kvlcc2(), 1.18, 10.4
    found = stability(model, np.zeros((len(model.parameters.free),) * 2), np.inf, u, np.array([0.0, n, 0.0, 0.0]), 7.0)
    starboard, port = (kvlcc2_by_hand(g, u, n) for g in (0.640, 0.395))
    assert found is not None
    assert starboard > 0 > port
    assert found.index == pytest.approx(0.5 * (starboard + port), abs=1e-4)
    assert f"C is {starboard:+.2g} beginning a turn to starboard and {port:+.2g} to port" in found.text


def test_words_follow_the_sign_and_the_interval() -> None:
    model, inputs = kvlcc2(), np.array([0.0, 10.4, 0.0, 0.0])
    certain, vague = (
        stability(model, spread * np.eye(len(model.parameters.free)), 11, 1.18, inputs, 7.0) for spread in (1e-8, 1.0)
    )
    assert certain is not None and vague is not None
    assert certain.index < 0 and "course unstable" in certain.text
    assert "cannot be determined" in vague.text and vague.growth_lower < 0.0 < vague.growth_upper


def test_a_model_of_yaw_alone_is_stable_where_its_time_constant_is_positive() -> None:
    model = nomoto().with_values({"K": 0.1, "T": 8.0})
    found = stability(model, np.zeros((len(model.parameters.free),) * 2), np.inf, 2.0, np.zeros(1), 16.0)
    assert found is not None
    assert found.index == pytest.approx(1.0)
    assert "dies out by a factor e in 8.0 s, 1.0 ship lengths" in found.text
