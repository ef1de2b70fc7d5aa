"""Hull, wake, propeller and rudder coefficients from main dimensions: prior means where no test says better."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from seatrial.core.values import Array, InputError, Ship
from seatrial.physics.hydro.excitation import SEA_WATER

# Open-water thrust of the Wageningen B series, as the quadratic in J that manoeuvring models take.

OOSTERVELD = "Oosterveld & van Oossanen 1975, Int. Shipbuilding Progress 22(251), 251-262, B series at Re 2e6"
# coefficient, powers of J, P/D, A_E/A_0, Z: the thrust polynomial of the source, the same in two transcriptions
_THRUST = np.array([
    (0.00880496, 0, 0, 0, 0), (-0.204554, 1, 0, 0, 0), (0.166351, 0, 1, 0, 0), (0.158114, 0, 2, 0, 0),
    (-0.147581, 2, 0, 1, 0), (-0.481497, 1, 1, 1, 0), (0.415437, 0, 2, 1, 0), (0.0144043, 0, 0, 0, 1),
    (-0.0530054, 2, 0, 0, 1), (0.0143481, 0, 1, 0, 1), (0.0606826, 1, 1, 0, 1), (-0.0125894, 0, 0, 1, 1),
    (0.0109689, 1, 0, 1, 1), (-0.133698, 0, 3, 0, 0), (0.00638407, 0, 6, 0, 0), (-0.00132718, 2, 6, 0, 0),
    (0.168496, 3, 0, 1, 0), (-0.0507214, 0, 0, 2, 0), (0.0854559, 2, 0, 2, 0), (-0.0504475, 3, 0, 2, 0),
    (0.010465, 1, 6, 2, 0), (-0.00648272, 2, 6, 2, 0), (-0.00841728, 0, 3, 0, 1), (0.0168424, 1, 3, 0, 1),
    (-0.00102296, 3, 3, 0, 1), (-0.0317791, 0, 3, 1, 1), (0.018604, 1, 0, 2, 1), (-0.00410798, 0, 2, 2, 1),
    (-0.000606848, 0, 0, 0, 2), (-0.0049819, 1, 0, 0, 2), (0.0025983, 2, 0, 0, 2), (-0.000560528, 3, 0, 0, 2),
    (-0.00163652, 1, 2, 0, 2), (-0.000328787, 1, 6, 0, 2), (0.000116502, 2, 6, 0, 2), (0.000690904, 0, 0, 1, 2),
    (0.00421749, 0, 3, 1, 2), (0.0000565229, 3, 6, 1, 2), (-0.00146564, 0, 3, 2, 2),
])  # fmt: skip
_HIGHEST_J, _POINTS = 0.6, 25  # to which the quadratic is fitted, and where: a ship's propeller works at 0.2 to 0.5


def thrust_coefficient(J: Array, pitch_ratio: float, area_ratio: float, blades: int) -> Array:
    """Return K_T of a B-series propeller at the advance ratios J, shape (n,)."""
    size, powers = _THRUST[:, 0], _THRUST[:, 1:]
    factors = pitch_ratio ** powers[:, 1] * area_ratio ** powers[:, 2] * float(blades) ** powers[:, 3]
    return np.asarray(J, dtype=float)[:, None] ** powers[:, 0] @ (size * factors)


def thrust_quadratic(pitch_ratio: float, area_ratio: float, blades: int) -> tuple[float, float, float]:
    """Return k_0, k_1, k_2 of K_T = k_0 + k_1 J + k_2 J^2, least squares over J from 0 to 0.6."""
    J = np.linspace(0.0, _HIGHEST_J, _POINTS)
    k_2, k_1, k_0 = np.polyfit(J, thrust_coefficient(J, pitch_ratio, area_ratio, blades), 2)
    return float(k_0), float(k_1), float(k_2)


# Hull, wake and rudder coefficients from main dimensions: prior means where no test says better.

ZHOU = "Zhou et al. 1983, regression on Motora's charts"
CLARKE = "Clarke, Gedling & Hine 1983, Trans. RINA 125, 45-68"
KIJIMA = "Kijima et al. 1990, The Naval Architect / PRADS, linear derivatives"
YOSHIMURA = "Yoshimura & Masumoto 2012, MARSIM, hydrodynamic database"
FUJII = "Fujii & Tuda 1961, gradient of rudder lift"
HARVALD = "Harvald 1983, Resistance and Propulsion of Ships, single screw"
# root mean square difference from the published values of KVLCC2 and Esso Osaka (tests/physics/hydro): the only spread
# that can be checked here; gamma_R over both sides
_INTERACTION_DEVIATIONS = {
    "w_P0": 0.18, "t_R": 0.14, "a_H": 0.04, "x_H_prime": 0.01, "l_R_prime": 0.19, "gamma_R_plus": 0.11,
    "gamma_R_minus": 0.11, "epsilon": 0.31, "kappa": 0.18, "f_alpha": 0.20,
}  # fmt: skip
# the same of the thrust; t_P differs by 0.01 from those two, and by 0.05 among ships (chosen), R_0 by its half (chosen)
_PROPULSION_DEVIATIONS = {"t_P": 0.05, "k_0": 0.02, "k_1": 0.06, "k_2": 0.03, "R_0": 0.011}
RESISTANCE = 0.022
"""Resistance over rho/2 L d U^2 of KVLCC2 (Yasukawa & Yoshimura 2015, table 3); of Esso Osaka 0.021."""


@dataclass(frozen=True)
class HullForm:
    """Main dimensions of a hull in metres, block coefficient, mass' = mass / (rho/2 L^2 d), x_G' = x_G / L."""

    L: float
    B: float
    d: float
    C_b: float
    x_G_prime: float = 0.0

    @classmethod
    def from_ship(cls, ship: Ship) -> "HullForm":
        """Return the form of a ship.

        The block coefficient of a ship that states its mass alone follows from that.

        Raises:
            InputError: L, B, d or C_b is not among its particulars.
        """
        size = ship.particulars
        missing = [n for n in ("L", "B", "d") if not size.get(n, 0.0) > 0.0]
        block, mass = size.get("C_b", 0.0), size.get("m", 0.0)
        if not block > 0.0 and mass > 0.0 and not missing:
            # m = rho C_b L B d (Archimedes)
            block = mass / (size.get("rho", SEA_WATER) * size["L"] * size["B"] * size["d"])
        missing += [] if block > 0.0 or mass > 0.0 else ["C_b"]
        if missing:
            names = ", ".join(missing)
            raise InputError(f"ship '{ship.name}' lacks {names} for empirical coefficients; add them under [ship]")
        return cls(size["L"], size["B"], size["d"], block, size.get("x_G", 0.0) / size["L"])

    @property
    def aspect_ratio(self) -> float:
        """k = 2 d / L."""
        return 2 * self.d / self.L

    @property
    def fullness(self) -> float:
        """C_b B / L."""
        return self.C_b * self.B / self.L

    @property
    def mass_prime(self) -> float:
        """Displacement over rho/2 L^2 d."""
        return 2 * self.fullness


@dataclass(frozen=True)
class EmpiricalEstimate:
    """Values of one method, its source, and whether the form lies where the method was fitted.

    deviations: standard deviation of those values whose scatter is known.
    """

    values: dict[str, float]
    source: str
    valid: bool
    limits: str
    deviations: dict[str, float] = field(default_factory=dict)


Range = tuple[float, float]


def _validity(form: HullForm, C_b: Range, L_B: Range, B_d: Range) -> tuple[bool, str]:
    pairs = ((form.C_b, C_b), (form.L / form.B, L_B), (form.B / form.d, B_d))
    limits = f"C_b {C_b[0]:g}-{C_b[1]:g}, L/B {L_B[0]:g}-{L_B[1]:g}, B/d {B_d[0]:g}-{B_d[1]:g}"
    return all(low <= value <= high for value, (low, high) in pairs), limits


def added_mass(form: HullForm) -> EmpiricalEstimate:
    """Return m_x', m_y', J_z' by Zhou's regression; outside merchant proportions it is an extrapolation."""
    C_b, L_B, d_B, dL_BB = form.C_b, form.L / form.B, form.d / form.B, form.d * form.L / form.B**2
    x = 0.398 + 11.97 * C_b * (1 + 3.73 * d_B) - 2.89 * C_b * L_B * (1 + 1.13 * d_B)  # regression of Zhou
    x += 0.175 * C_b * L_B**2 * (1 + 0.541 * d_B) - 1.107 * L_B * d_B  # regression of Zhou
    y = 0.882 - 0.54 * C_b * (1 - 1.6 * d_B) - 0.156 * (1 - 0.673 * C_b) * L_B  # regression of Zhou
    y += 0.826 * dL_BB * (1 - 0.678 * d_B) - 0.638 * C_b * dL_BB * (1 - 0.669 * d_B)  # regression of Zhou
    z = 0.01 * (33 - 76.85 * C_b * (1 - 0.784 * C_b) + 3.43 * L_B * (1 - 0.63 * C_b))  # regression of Zhou
    m = form.mass_prime
    values = {"m_x_prime": m * x / 100, "m_y_prime": m * y, "J_z_prime": m * z**2}
    # ranges of the forms that the regression was fitted to
    return EmpiricalEstimate(values, ZHOU, *_validity(form, (0.5, 0.85), (4.0, 8.0), (2.2, 4.0)))


def clarke(form: HullForm) -> EmpiricalEstimate:
    """Return linear derivatives and added masses by Clarke's regression (there over rho/2 L^2 U^2, here times L/d).

    Y_r, N_v and N_r here are hydrodynamic parts at constant speed, without rigid-body terms.
    """
    B_d, B_L, d_L = form.B / form.d, form.B / form.L, form.d / form.L
    S = math.pi * d_L**2 * form.L / form.d
    # coefficients of Clarke's regression
    values = {
        "Y_v": -S * (1 + 0.40 * form.C_b * B_d),
        "Y_r": -S * (-0.5 + 2.2 * B_L - 0.080 * B_d),
        "N_v": -S * (0.5 + 2.4 * d_L),
        "N_r": -S * (0.25 + 0.039 * B_d - 0.56 * B_L),
        "m_y_prime": S * (1 + 0.16 * form.C_b * B_d - 5.1 * B_L**2),
        "J_z_prime": S * (1 / 12 + 0.017 * form.C_b * B_d - 0.33 * B_L),
    }
    # ranges of the forms that the regression was fitted to
    return EmpiricalEstimate(values, CLARKE, *_validity(form, (0.5, 0.85), (5.0, 8.0), (2.0, 4.5)))


def kijima(form: HullForm) -> EmpiricalEstimate:
    """Linear derivatives by Kijima; his Y_r' - (m' + m_x') = -1.5 C_b B/L becomes Y_r' with the added mass of Zhou."""
    k, m_x = form.aspect_ratio, added_mass(form).values["m_x_prime"]
    # coefficients of Kijima's regression
    values = {
        "Y_v": -(math.pi / 2 * k + 1.4 * form.fullness),
        "Y_r": form.mass_prime + m_x - 1.5 * form.fullness,
        "N_v": -k,
        "N_r": -0.54 * k + k**2,
    }
    # ranges of the forms that the regression was fitted to
    return EmpiricalEstimate(values, KIJIMA, *_validity(form, (0.5, 0.85), (5.0, 8.0), (2.0, 4.5)))


_YOSHIMURA_ERRORS: Mapping[str, float] = MappingProxyType(
    {
        "X_vv": 0.029, "X_vr": 0.044, "X_rr": 0.024, "X_vvvv": 0.65, "Y_vvv": 1.2, "Y_vvr": 0.96, "Y_vrr": 0.36,
        "Y_rrr": 0.055, "N_vvv": 0.080, "N_vvr": 0.28, "N_vrr": 0.21,
    }
)  # fmt: skip
"""Root mean squares of published coefficients of KVLCC2 and Esso Osaka less the regressions of Yoshimura & Masumoto:
of cubic and higher terms, and of surge, of which these hold the order of magnitude only [1]."""


def yoshimura(form: HullForm) -> EmpiricalEstimate:
    """Return all hull coefficients of the MMG standard method but R_0, by the regressions of Yoshimura & Masumoto.

    Linear ones are good to about 25 % on KVLCC2, others only to their order of magnitude; X_rr with x_G m_y' rests on
    one transcription.
    """
    C_b, L_B, f, k = form.C_b, form.L / form.B, form.fullness, form.aspect_ratio
    m_x, m_y = (added_mass(form).values[n] for n in ("m_x_prime", "m_y_prime"))
    # coefficients of the regressions of Yoshimura & Masumoto
    values = {
        "X_vv": 1.15 * f - 0.18,
        "X_vr": m_y - 1.91 * f + 0.08,
        "X_rr": -0.085 * f + 0.008 - form.x_G_prime * m_y,
        "X_vvvv": -6.68 * f + 1.1,
        "Y_v": -(math.pi / 2 * k + 1.4 * f),
        "Y_r": m_x + 0.5 * f,
        "Y_vvv": -0.185 * L_B + 0.48,
        "Y_vvr": -0.75,
        "Y_vrr": -(0.26 * (1 - C_b) * L_B + 0.11),
        "Y_rrr": -0.051,
        "N_v": -k,
        "N_r": -0.54 * k + k**2,
        "N_vvv": -(-0.69 * C_b + 0.66),
        "N_vvr": 1.55 * f - 0.76,
        "N_vrr": -0.075 * (1 - C_b) * L_B - 0.098,
        "N_rrr": 0.25 * f - 0.056,
    }
    # ranges of the forms that the regression was fitted to
    validity = _validity(form, (0.5, 0.85), (2.5, 7.0), (2.1, 3.8))
    return EmpiricalEstimate(values, YOSHIMURA, *validity, dict(_YOSHIMURA_ERRORS))


def interaction_coefficients(form: HullForm, aspect_ratio: float) -> EmpiricalEstimate:
    """Return wake, rudder and interaction coefficients; `aspect_ratio` of the rudder is H_R^2 / A_R."""
    f = form.fullness
    # regressions of the sources named below
    values = {
        "w_P0": interaction_wake(form),
        "t_R": 0.39,
        "a_H": 0.627 * form.C_b - 0.153,
        "x_H_prime": -0.45,
        "l_R_prime": -0.9,
        "gamma_R_plus": 2.06 * f + 0.14,
        "gamma_R_minus": 2.06 * f + 0.14,
        "epsilon": -156.5 * f**2 + 41.6 * f - 1.76,
        "kappa": 0.55 - 0.8 * f,
        "f_alpha": 6.13 * aspect_ratio / (2.25 + aspect_ratio),
    }
    source = (
        f"w_P0 Taylor; t_R, l_R, gamma_R, kappa {YOSHIMURA}; a_H Quadvlieg 2013; x_H Aoki et al. 2006; "
        f"epsilon Kijima et al. 1990; f_alpha {FUJII}; through MANSIM"
    )
    # ranges of the forms that the regressions were fitted to
    valid, limits = _validity(form, (0.5, 0.85), (4.0, 8.0), (2.0, 4.5))
    return EmpiricalEstimate(values, source, valid, limits, dict(_INTERACTION_DEVIATIONS))


def propulsion(form: HullForm, pitch_ratio: float, area_ratio: float, blades: int) -> EmpiricalEstimate:
    """Return thrust deduction, open-water thrust of a single screw whose own curve nobody knows, and resistance."""
    wake = interaction_wake(form)
    k_0, k_1, k_2 = thrust_quadratic(pitch_ratio, area_ratio, blades)
    # t = 0.60 w + 0.01: Harvald 1983, single screw
    values = {"t_P": 0.60 * wake + 0.01, "k_0": k_0, "k_1": k_1, "k_2": k_2, "R_0": RESISTANCE}
    source = (
        f"t_P {HARVALD}; k_0, k_1, k_2 {OOSTERVELD}, P/D {pitch_ratio:g}, A_E/A_0 {area_ratio:g}, {blades} blades; "
        "R_0 of KVLCC2"
    )
    valid, limits = _validity(form, (0.5, 0.85), (4.0, 8.0), (2.0, 4.5))  # of merchant ships, as of the wake
    return EmpiricalEstimate(values, source, valid, limits, dict(_PROPULSION_DEVIATIONS))


def interaction_wake(form: HullForm) -> float:
    """Return the wake fraction of a single screw, 0.5 C_b - 0.05 (Taylor, as in Harvald 1983)."""
    return 0.5 * form.C_b - 0.05  # Taylor's formula, as in Harvald 1983


def displacement(form: HullForm, rho: float) -> EmpiricalEstimate:
    """Return the mass of the displaced water of density rho [kg/m^3], and its inertia with a gyradius of L/4."""
    mass = rho * form.C_b * form.L * form.B * form.d
    values = {"rho": rho, "m": mass, "I_z": mass * (0.25 * form.L) ** 2, "x_G": form.x_G_prime * form.L}
    source = "m = rho C_b L B d (Archimedes); gyradius L/4 (Yasukawa & Yoshimura 2015); x_G midship unless stated"
    return EmpiricalEstimate(values, source, valid=True, limits="any ship that floats at rest")


def cross_flow_coefficients(C_D: float, C_rY: float, C_rN: float) -> dict[str, float]:
    """Return cubic coefficients that stand in for a cross-flow drag integral of Yoshimura's low-speed model.

    -C_D integral of |v' + C x r'| (v' + C x r') over x in [-1/2, 1/2], C = C_rY for the force and C_rN for the
    moment, fitted by least squares over |v'| <= 0.5, |r'| <= 1 (uniform), where U' = 1.
    """
    import numpy as np

    # grid of 21 by 21 motions over the range above; chosen
    v, r = (a.ravel() for a in np.meshgrid(np.linspace(-0.5, 0.5, 21), np.linspace(-1.0, 1.0, 21)))
    x = (np.arange(100) + 0.5) / 100 - 0.5
    flow_Y, flow_N = (v[:, None] + c * x * r[:, None] for c in (C_rY, C_rN))
    Y = -C_D * np.mean(np.abs(flow_Y) * flow_Y, axis=1)
    N = -C_D * np.mean(np.abs(flow_N) * flow_N * x, axis=1)
    terms = np.column_stack([v**3, v**2 * r, v * r**2, r**3])
    names = ("vvv", "vvr", "vrr", "rrr")
    fit_Y, fit_N = (np.linalg.lstsq(terms, force, rcond=None)[0] for force in (Y, N))
    both = zip(("Y", "N"), (fit_Y, fit_N), strict=True)
    return {f"{force}_{name}": float(value) for force, fit in both for name, value in zip(names, fit, strict=True)}
