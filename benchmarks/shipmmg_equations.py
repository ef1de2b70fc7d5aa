"""The equations that shipmmg 0.0.11 integrates, written as a seatrial model, with its own example ship (KVLCC2).

shipmmg follows Yasukawa & Yoshimura 2015 (doi 10.1007/s00773-014-0293-y) but measures speed and drift with
v - x_G r and nondimensionalises with v; the same is done here, so that the comparison is of integrators alone.
"""

import sympy as sp

from seatrial.core.equations import Model, Sheet

RHO, L, D = 1025.0, 7.00, 0.46
MASS = 3.27 * RHO

BASIC = {
    "L_pp": L, "B": 1.27, "d": D, "x_G": 0.25, "D_p": 0.216, "m": MASS, "I_zG": MASS * (0.25 * L) ** 2, "A_R": 0.0539,
    "eta": 0.216 / 0.345, "m_x": 0.022 * 0.5 * RHO * L**2 * D, "m_y": 0.223 * 0.5 * RHO * L**2 * D,
    "J_z": 0.011 * 0.5 * RHO * L**4 * D, "f_alpha": 2.747, "epsilon": 1.09, "t_R": 0.387, "x_R": -0.5 * L,
    "a_H": 0.312, "x_H": -0.464 * L, "gamma_R_minus": 0.395, "gamma_R_plus": 0.640, "l_R": -0.710, "kappa": 0.50,
    "t_P": 0.220, "w_P0": 0.40, "x_P": -0.650,
}  # fmt: skip
MANOEUVRING = {
    "k_0": 0.2931, "k_1": -0.2753, "k_2": -0.1385, "R_0": 0.022, "X_vv": -0.040, "X_vr": 0.002, "X_rr": 0.011,
    "X_vvvv": 0.771, "Y_v": -0.315, "Y_r": 0.083, "Y_vvv": -1.607, "Y_vvr": 0.379, "Y_vrr": -0.391, "Y_rrr": 0.008,
    "N_v": -0.137, "N_r": -0.049, "N_vvv": -0.030, "N_vvr": -0.294, "N_vrr": 0.055, "N_rrr": -0.013,
}  # fmt: skip
SPEED, RATE = 1.179, 10.4  # m/s, rps


def model() -> Model:
    """States u, v, r, x0, y0, psi; inputs delta [rad, positive turns to starboard], n [rps]."""
    sheet = Sheet("shipmmg", "shipmmg 0.0.11, mmg_3dof.simulate", "the peer's equations")
    u, v, r, x0, y0, psi = sheet.states("u v r x0 y0 psi")
    delta, n = sheet.input("delta"), sheet.input("n")
    p = {name: sheet.parameter(name, value) for name, value in (BASIC | MANOEUVRING).items()}
    rho, length = sheet.parameter("rho", RHO), p["L_pp"]
    v_x = sheet.bind("v_x", v - r * p["x_G"])
    U = sheet.bind("U", sp.sqrt(u**2 + v_x**2))
    beta = sheet.bind("beta", sp.asin(-v_x / U))
    v_p, r_p = sheet.bind("v_p", v / U), sheet.bind("r_p", r * length / U)
    w_P = sheet.bind("w_P", p["w_P0"] * sp.exp(-4 * (beta - p["x_P"] * r_p) ** 2))
    J = sheet.bind("J", (1 - w_P) * u / (n * p["D_p"]))
    K_T = sheet.bind("K_T", p["k_0"] + p["k_1"] * J + p["k_2"] * J**2)
    beta_R = sheet.bind("beta_R", beta - p["l_R"] * r_p)
    gamma_R = sheet.bind("gamma_R", sp.Piecewise((p["gamma_R_minus"], beta_R < 0), (p["gamma_R_plus"], True)))
    v_R = sheet.bind("v_R", U * gamma_R * beta_R)
    slip = sheet.bind("slip", 1 + p["kappa"] * (sp.sqrt(1 + 8 * K_T / (sp.pi * J**2)) - 1))
    u_R = sheet.bind("u_R", u * (1 - w_P) * p["epsilon"] * sp.sqrt(p["eta"] * slip**2 + 1 - p["eta"]))
    alpha_R = sheet.bind("alpha_R", delta - sp.atan2(v_R, u_R))
    F_N = sheet.bind("F_N", p["A_R"] * rho * p["f_alpha"] * (u_R**2 + v_R**2) * sp.sin(alpha_R) / 2)
    q = sheet.bind("q", rho * length * p["d"] * U**2 / 2)
    X_H = sheet.bind(
        "X_H",
        q * (-p["R_0"] + p["X_vv"] * v_p**2 + p["X_vr"] * v_p * r_p + p["X_rr"] * r_p**2 + p["X_vvvv"] * v_p**4),
    )
    X = sheet.bind("X", X_H - (1 - p["t_R"]) * F_N * sp.sin(delta) + (1 - p["t_P"]) * rho * K_T * n**2 * p["D_p"] ** 4)
    powers = {"v": v_p, "r": r_p, "vvv": v_p**3, "vvr": v_p**2 * r_p, "vrr": v_p * r_p**2, "rrr": r_p**3}
    Y_H = sheet.bind("Y_H", q * sum(p[f"Y_{name}"] * term for name, term in powers.items()))
    N_H = sheet.bind("N_H", q * length * sum(p[f"N_{name}"] * term for name, term in powers.items()))
    Y = sheet.bind("Y", Y_H - (1 + p["a_H"]) * F_N * sp.cos(delta))
    N = sheet.bind("N", N_H - (p["x_R"] + p["a_H"] * p["x_H"]) * F_N * sp.cos(delta))
    m, lever = p["m"], sheet.bind("lever", p["x_G"] * p["m"])
    M_x, M_y = sheet.bind("M_x", m + p["m_x"]), sheet.bind("M_y", m + p["m_y"])
    inertia = sheet.bind("inertia", p["I_zG"] + p["J_z"] + p["x_G"] * lever)
    v_rate = sheet.bind(
        "v_rate", (lever**2 * u * r - N * lever + (Y - M_x * u * r) * inertia) / (inertia * M_y - lever**2)
    )
    sheet.rate(u, (X + M_y * v * r + lever * r**2) / M_x)
    sheet.rate(v, v_rate)
    sheet.rate(r, (N - lever * (v_rate + u * r)) / inertia)
    sheet.rate(x0, u * sp.cos(psi) - v * sp.sin(psi))
    sheet.rate(y0, u * sp.sin(psi) + v * sp.cos(psi))
    sheet.rate(psi, r)
    return sheet.model()
