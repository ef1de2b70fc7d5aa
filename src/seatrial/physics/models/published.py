"""Coefficients as named parameter sets with their sources, and start values where nothing is known."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, partial
from types import MappingProxyType

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Ship, spelling_hint

# Typical coefficients of the force of the wind, for starts of searches and priors.

SYMMETRIC = {"C_X1": -0.7, "C_Y1": -0.8, "C_N2": 0.0}
"""Those of a craft symmetrical fore and aft, where a search starts: the middle of typical values (Fossen 2021, section
10.1, c_x 0.5 to 0.9, c_y 0.7 to 0.95); the moment has either sign."""
TYPICAL_SPREAD = {"C_X1": 0.35, "C_Y1": 0.4, "C_N2": 0.1}
"""Standard deviations about them where the areas are estimates, too: half of the forces' (areas of ships of one length
differ by that); the moment's is the middle of its typical size, 0.05 to 0.20 (Fossen 2021, section 10.1)."""
TYPICAL = "Fossen 2021, section 10.1, typical values of craft symmetrical fore and aft"


# What formulas say of shallow water, and how far each is trusted.

TANG = "Tang et al. 2020, doi 10.1016/j.oceaneng.2019.106679"
KIJIMA = f"Kijima et al. 1990, J. Soc. Nav. Archit. Japan 168, shallow water; {TANG}"
LI_WU = f"Li & Wu 1990, added masses in shallow water; {TANG}"
FURUKAWA = "Furukawa et al. 2016, doi 10.18451/978-3-939230-38-0_33, resistance; one transcription"
SHARE_SPREAD = {
    **dict.fromkeys(("Y_v", "Y_r", "N_v", "N_r", "R_0"), 1.0), **dict.fromkeys(("m_y", "J_z"), 0.5),
    **dict.fromkeys(("w_P", "t_P", "gamma_R"), 0.5),
}  # fmt: skip
"""Standard deviation of each share about 1; chosen: exact flow past elliptic sections gives the tanker KVLCC2 0.6 of
the change of m_y by Li & Wu at h/d 1.5, half of it at 2 and a fifth at 5, and by slender-body theory Y_v would change
six times as much as by Kijima."""


def share_name(coefficient: str) -> str:
    """Return the parameter that is the share of a coefficient's published change: ``h_Y_v``."""
    return f"h_{coefficient}"


# What formulas say of the wake and the thrust deduction of two screws.

TAYLOR = "Taylor, as in Harvald 1983, two screws"
HOLTROP = "Holtrop & Mennen 1982, Int. Shipbuilding Progress 29, 166-170, two screws"
TWIN_SPREAD = {"w_P0": 0.08, "t_P": 0.05}
"""Standard deviations of the formulas, 1; chosen: shafts in the open and shafts in bossings differ by twice that."""


def twin_screw_formulas(C_b: float, B: float, d: float, D_P: float) -> dict[str, float]:
    """Return w_P0 and t_P of two screws from block coefficient, breadth, draught and diameter [m]."""
    # 0.55 C_b - 0.20: Taylor, two screws
    wake = 0.55 * C_b - 0.20
    # 0.325 C_b - 0.1885 D / sqrt(B T): Holtrop & Mennen 1982, two screws
    return {"w_P0": wake, "t_P": 0.325 * C_b - 0.1885 * D_P / (B * d) ** 0.5}


# How large the terms beyond the linear ones of an expansion in the motions are, of a ship of which nothing is known.

HIGHER_ORDER_SPREAD = {
    "X_uu": 0.003, "X_vv": 0.012, "X_vr": 0.017, "X_rr": 0.002, "X_dd": 0.004,
    "Y_vvv": 0.2, "Y_vvr": 0.18, "Y_vrr": 0.06, "Y_rrr": 0.003,
    "N_vvv": 0.02, "N_vvr": 0.08, "N_vrr": 0.005, "N_rrr": 0.003,
}  # fmt: skip
"""Standard deviations about 0, primes of rho/2 L^2 and rho/2 L^3: twice the root mean square of the three ships,
rounded up. X_uu, X_rr, X_dd and Y_rrr are wider, chosen: of small craft they hold resistance, place of G and rudder."""
HIGHER_ORDER = (
    "as large as of a Mariner (Chislett & Stroem-Tejsen 1965, Hy-6), KVLCC2 (Yasukawa & Yoshimura 2015) and S175 "
    "(Son & Nomoto 1981)"
)


# Names and units of the coefficients of heave and pitch, and start values where nothing is known of them.

MASSES = {"a33": "kg", "a35": "kg m", "a55": "kg m^2", "a53": "kg m"}
DAMPINGS = {"b33": "kg/s", "b35": "kg m/s", "b55": "kg m^2/s", "b53": "kg m/s"}
HEAVE_PITCH_STIFFNESSES = {"c33": "N/m", "c35": "N/rad", "c53": "N m/m", "c55": "N m/rad"}
HEAVE_PITCH_COEFFICIENTS = (*MASSES, *DAMPINGS)

START_DAMPING_RATIO = 0.3  # of critical, in both motions: chosen, of the order of a hull's at resonance


def physical_start_values(values: dict[str, float]) -> dict[str, float]:
    """Return start values of the eight coefficients from m, I5, c33 and c55.

    Added mass as large as the mass, no coupling, damping ratio 0.3 in both motions.
    """
    m, inertia = values["m"], values["I5"]
    start = dict.fromkeys(HEAVE_PITCH_COEFFICIENTS, 0.0)
    start["a33"], start["a55"] = m, inertia
    start["b33"] = 2.0 * START_DAMPING_RATIO * (values["c33"] * 2.0 * m) ** 0.5
    start["b55"] = 2.0 * START_DAMPING_RATIO * (values["c55"] * 2.0 * inertia) ** 0.5
    return start


_MEANING = {"m": "mass", "I5": "moment of inertia", "c33": "heave stiffness", "c55": "pitch stiffness"}


def with_start_values(model: Model, ship: Ship) -> Model:
    """Return heave and pitch with missing coefficients from mass, inertia and stiffness; other models as given.

    Raises:
        InputError: mass, inertia or stiffness is not positive.
    """
    absent = [n for n in model.parameters.missing if n.removesuffix("_0") in HEAVE_PITCH_COEFFICIENTS]
    model_values = {p.name: p.value for p in model.parameters}
    basis = {n: ship.particulars.get(n, model_values.get(n, float("nan"))) for n in _MEANING}
    if not absent or any(value != value for value in basis.values()):
        return model
    for name, value in basis.items():
        if value <= 0.0:
            raise InputError(f"{name} = {value:g} is not positive; the {_MEANING[name]} of a craft that floats is")
    start = physical_start_values(basis)
    values = {n: start[n.removesuffix("_0")] for n in absent}
    return model.with_values(values, source="start: added mass as mass, no coupling, damping ratio 0.3")


# Published coefficients as named parameter sets, each with its ship and its source.

YASUKAWA = "Yasukawa & Yoshimura 2015, J Mar Sci Technol 20, 37-52, doi 10.1007/s00773-014-0293-y"
MIYAUCHI = "Miyauchi et al. 2022, J Mar Sci Technol 27, 1065-1083, doi 10.1007/s00773-022-00889-3, captive tests"


@dataclass(frozen=True)
class ParameterSet:
    """Values of one model's parameters, their source, and the ship they belong to.

    Attributes:
        model: name of the model in the registry.
        values: parameter -> value in the model's units and signs.
        note: what was converted, chosen or doubtful.
    """

    name: str
    model: str
    ship: Ship
    values: Mapping[str, float] = field(default_factory=dict)
    source: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    def applied_to(self, model: Model) -> Model:
        """Return `model` with the ship's particulars and these values.

        Raises:
            InputError: the model lacks one of the parameters, or still misses a value.
        """
        return model.with_values(self.values, source=self.source).with_ship(self.ship)


QI2025 = "Qi et al. 2025, improved wild horse optimizer, tables 1-4"


# principal particulars of the 7 m model and of the ship; radius of gyration 0.25 L
_L7 = {"L": 7.00, "B": 1.27, "d": 0.46, "C_b": 0.810, "x_G": 0.25, "D_P": 0.216, "H_R": 0.345, "A_R": 0.0539}
# particulars of the ship, from the same table
_FULL = {"L": 320.0, "B": 58.0, "d": 20.8, "C_b": 0.810, "x_G": 11.2, "D_P": 9.86, "H_R": 15.80, "A_R": 112.5}


def _with_mass(particulars: Mapping[str, float], volume: float, rho: float) -> dict[str, float]:
    mass = rho * volume
    return {**particulars, "rho": rho, "m": mass, "I_z": mass * (0.25 * particulars["L"]) ** 2}


# hydrodynamic force coefficients; x_P' = -0.48 is the propeller's place, one transcription has -0.690
_KVLCC2 = {
    "R_0": 0.022, "X_vv": -0.040, "X_vr": 0.002, "X_rr": 0.011, "X_vvvv": 0.771,
    "Y_v": -0.315, "Y_r": 0.083, "Y_vvv": -1.607, "Y_vvr": 0.379, "Y_vrr": -0.391, "Y_rrr": 0.008,
    "N_v": -0.137, "N_r": -0.049, "N_vvv": -0.030, "N_vvr": -0.294, "N_vrr": 0.055, "N_rrr": -0.013,
    "m_x_prime": 0.022, "m_y_prime": 0.223, "J_z_prime": 0.011,
    "t_P": 0.220, "w_P0": 0.40, "x_P_prime": -0.48, "C_1": 2.0, "C_2_plus": 1.6, "C_2_minus": 1.1,
    "k_0": 0.2931, "k_1": -0.2753, "k_2": -0.1385,
    "t_R": 0.387, "a_H": 0.312, "x_H_prime": -0.464, "x_R_prime": -0.5, "l_R_prime": -0.710, "f_alpha": 2.747,
    "gamma_R_plus": 0.640, "gamma_R_minus": 0.395, "epsilon": 1.09, "kappa": 0.50,
}  # fmt: skip
_COEFFICIENTS = f"{YASUKAWA}, hydrodynamic force coefficients"
_PARTICULARS = f"{YASUKAWA}, principal particulars"


@cache
def kvlcc2_l7() -> ParameterSet:
    """Return the 7 m model of KVLCC2, scale 1:45.7, in fresh water."""
    ship = Ship("KVLCC2 model L7", _with_mass(_L7, 3.27, 1000.0), _PARTICULARS, 45.7)
    note = "k_2 is -0.1385; a transcription in circulation has -0.1359"
    return ParameterSet("kvlcc2", "mmg", ship, _KVLCC2, _COEFFICIENTS, note)


@cache
def kvlcc2_full() -> ParameterSet:
    """Return KVLCC2 at full scale in sea water; the same coefficients with the wake of the ship."""
    ship = Ship("KVLCC2", _with_mass(_FULL, 312600.0, 1025.0), _PARTICULARS)  # m^3 displaced; kg/m^3, sea water
    return ParameterSet(
        "kvlcc2-full", "mmg", ship, {**_KVLCC2, "w_P0": 0.35}, _COEFFICIENTS, "w_P0 0.35 at full scale, 0.40 for models"
    )


# particulars of the data set: m, m^2, kg and kg m^2; radius of gyration 0.25 L
_ESSO_SHIP = {
    "L": 3.0, "B": 0.489, "d": 0.201, "C_b": 0.83, "m": 244.6, "x_G": 0.094, "D_P": 0.084, "A_R": 0.0106,
    "H_R": 0.1279, "A_T": 0.135, "A_L": 0.520, "rho": 998.0, "I_z": 244.6 * (0.25 * 3.0) ** 2,
}  # fmt: skip

# as published, in rho/2 L d U^2; the cross-flow drag integral (C_D, C_rY, C_rN) and R_0 ahead and astern are converted
_ESSO = {
    "R_0": 0.02139, "X_vr": -0.0081, "Y_v": -0.3728, "Y_r": 0.116, "N_v": -0.1458, "N_r": -0.04849,
    "m_x_prime": 0.0467, "m_y_prime": 0.2579,
    "k_0": 0.3278, "k_1": -0.3223, "k_2": -0.156, "t_P": 0.22, "w_P0": 0.614, "x_P_prime": -0.517,
    "t_R": 0.19, "a_H": 0.393, "x_H_prime": -0.45, "x_R_prime": -0.5, "l_R_prime": -1.08, "epsilon": 1.42,
    "gamma_R_plus": 0.4406, "gamma_R_minus": 0.3506,
    "C_X0": -0.010466, "C_X1": -0.821992, "C_X3": 0.060274,
    "C_Y1": -1.058172, "C_Y3": -0.002321, "C_N1": 0.030728, "C_N2": -0.104116, "C_N3": 0.000880,
    "Y_nn": -0.000079, "Y_nu": 0.00799, "N_nn": 0.000035, "N_nu": -0.00317,
}  # fmt: skip
_ESSO_NOTE = (
    "cross-flow drag replaced by cubic terms; wake -0.871|b| + 0.359 b^2 by C_1 1.5, C_2 2.6; kappa = 0.288/1.42; "
    "K_T astern divided by 1 - t_P, which the source does not apply astern; kappa astern = 0.144 sqrt(8 0.22/pi); "
    "wind series without its fifth harmonics, signs for an apparent direction positive from starboard; "
    "H_R from aspect ratio 1.539; I_z (0.25 L)^2 m, J_z from the published I_z + J_z; k_1 -0.3223 has a variant -0.3323"
)


@cache
def esso_osaka() -> ParameterSet:
    """Return the 3 m model of Esso Osaka (data set of Osaka University): captive-test values, converted."""
    from seatrial.physics.hydro.empirical import cross_flow_coefficients

    source = "FRT-DS-ESSO data set, Wakita et al. 2022, Miyauchi et al. 2022"
    ship = Ship("Esso Osaka 3 m model", _ESSO_SHIP, source, 108.33)  # scale of the model, 1:108.33
    unit = 0.5 * 998.0 * 3.0**4 * 0.201  # rho/2 L^4 d [kg m^2], which makes a moment of inertia dimensionless
    # from the published values as the note says
    converted = {
        **cross_flow_coefficients(0.9665, 2.217, 0.8097),
        "J_z_prime": 0.0286 - _ESSO_SHIP["I_z"] / unit,
        "C_1": 1.5, "C_2_plus": 2.6, "C_2_minus": 2.6,
        "kappa": 0.288 / 1.42, "kappa_astern": 0.144 * (8 * 0.22 / 3.141592653589793) ** 0.5,
        "k_0_astern": -0.175 / 0.78, "k_1_astern": 0.330 / 0.78, "J_astern": -0.233, "J_side": -0.35,
        "f_alpha": 6.13 * 1.539 / (2.25 + 1.539), "U_0": 0.01,
    }  # fmt: skip
    return ParameterSet("esso-osaka", "mmg", ship, {**_ESSO, **converted}, MIYAUCHI, _ESSO_NOTE)


# The container ship S175 (SR 108), GM 0.3 m, 15 kn: primes of rho/2 L^3 and rho/2 L^5, K_T = k_0 + k_1 J.
SON_NOMOTO = (
    "Son & Nomoto 1981, J. Soc. Nav. Archit. Japan 150, 232-244, as printed by Fossen 1994, Guidance and Control of "
    "Ocean Vehicles, appendix E.1.3"
)
_S175_LENGTH, _S175_UNIT_MASS = 175.0, 0.5 * 1025.0 * 175.0**3  # m; rho/2 L^3 [kg]
# particulars, SI; inertias from the printed primes
_S175_SHIP = {
    "L": _S175_LENGTH, "B": 25.40, "d": 8.50, "volume": 21222.0, "C_b": 21222.0 / (175.0 * 25.40 * 8.50),
    "m": 0.00792 * _S175_UNIT_MASS, "rho": 1025.0, "D_P": 6.533, "A_R": 33.0376, "GM": 0.3,
    "I_x": 0.0000176 * _S175_UNIT_MASS * _S175_LENGTH**2, "I_z": 0.000456 * _S175_UNIT_MASS * _S175_LENGTH**2,
}  # fmt: skip
# as printed, dimensionless
_S175 = {
    "m_x_prime": 0.000238, "m_y_prime": 0.007049, "J_x_prime": 0.0000034, "J_z_prime": 0.000419,
    "l_x_prime": 0.0313, "l_y_prime": 0.0313, "alpha_y_prime": 0.05,
    "X_uu": -0.0004226, "X_vr": -0.00311, "X_vv": -0.00386, "X_rr": 0.00020, "X_phiphi": -0.00020,
    "Y_v": -0.0116, "Y_r": 0.00242, "Y_p": 0.0, "Y_phi": -0.000063, "Y_vvv": -0.109, "Y_rrr": 0.00177,
    "Y_vvr": 0.0214, "Y_vrr": -0.0405, "Y_vvphi": 0.04605, "Y_vphiphi": 0.00304, "Y_rrphi": 0.009325,
    "Y_rphiphi": -0.001368,
    "K_v": 0.0003026, "K_r": -0.000063, "K_p": -0.0000075, "K_phi": -0.000021, "K_vvv": 0.002843,
    "K_rrr": -0.0000462, "K_vvr": -0.000588, "K_vrr": 0.0010565, "K_vvphi": -0.0012012, "K_vphiphi": -0.0000793,
    "K_rrphi": -0.000243, "K_rphiphi": 0.00003569,
    "N_v": -0.0038545, "N_r": -0.00222, "N_p": 0.000213, "N_phi": -0.0001424, "N_vvv": 0.001492,
    "N_rrr": -0.00229, "N_vvr": -0.0424, "N_vrr": 0.00156, "N_vvphi": -0.019058, "N_vphiphi": -0.0053766,
    "N_rrphi": -0.0038592, "N_rphiphi": 0.0024195,
    "t_P": 0.175, "w_P0": 0.184, "tau_P": 1.09, "x_P_prime": -0.526, "k_0": 0.527, "k_1": -0.455,
    "kappa": 0.631, "epsilon": 0.921, "gamma_R": 0.088, "c_Rr": -0.156, "c_Rrrr": -0.275, "c_Rrrv": 1.96,
    "c_RX": 0.71, "a_H": 0.237, "x_R_prime": -0.5, "x_H_prime": -0.48, "z_R_prime": 0.033,
    "f_alpha": 6.13 * 1.8219 / (1.8219 + 2.25),
}  # fmt: skip


@cache
def s175() -> ParameterSet:
    """Return the container ship S175 with GM 0.3 m at 15 kn, full scale in sea water."""
    ship = Ship("container ship S175", _S175_SHIP, SON_NOMOTO)
    note = "m_y' 0.007049, where an early print has 0.000238; c_Pv and c_Pr are 0; f_alpha of the aspect ratio 1.8219"
    return ParameterSet("s175", "son_nomoto", ship, _S175, SON_NOMOTO, note)


# L from I5/m = (0.25 L)^2, B from the section area of table 1 over the draught
QI2025_SHIP = Ship(
    "ship of Qi et al. 2025",
    {"L": 60.0, "B": 16.2 / 2.27, "d": 2.27, "m": 4.42e5, "I5": 9.945e7,
     "c33": 3.15e6, "c35": 6.83e6, "c53": 6.83e6, "c55": 6.54e8},
    QI2025,
)  # fmt: skip
# in the order of HEAVE_PITCH_COEFFICIENTS, magnitudes as printed
_PRINTED_COEFFICIENTS = {
    90: (8.045e5, 7.753e6, 2.595e8, 1.479e7, 9.369e5, 1.159e7, 2.885e8, 3.324e6),
    135: (6.311e5, 3.281e6, 1.525e8, 7.865e6, 8.033e5, 9.429e6, 2.091e8, 2.267e6),
    180: (6.101e5, 2.663e6, 1.377e8, 6.611e6, 7.400e5, 8.951e6, 1.873e8, 2.356e6),
}
QI2025_HEADINGS = tuple(_PRINTED_COEFFICIENTS)


def theoretical_coefficients(heading: int) -> ParameterSet:
    """Return the theoretical coefficients at a heading to the waves of 90, 135 or 180 degrees, 18 kn; b53 negative."""
    values = dict(zip(HEAVE_PITCH_COEFFICIENTS, _PRINTED_COEFFICIENTS[heading], strict=True))
    values["b53"] = -values["b53"]
    note = "b53 negative by strip theory; the tables drop the sign"
    return ParameterSet(f"qi2025-{heading}", "heave_pitch", QI2025_SHIP, values, QI2025, note)


PARAMETER_SETS: dict[str, Callable[[], ParameterSet]] = {
    "kvlcc2": kvlcc2_l7,
    "kvlcc2-full": kvlcc2_full,
    "esso-osaka": esso_osaka,
    "s175": s175,
    **{f"qi2025-{heading}": partial(theoretical_coefficients, heading) for heading in QI2025_HEADINGS},
}


def parameter_set(name: str) -> ParameterSet:
    """Return a published set by name.

    Raises:
        InputError: there is none of that name; the nearest is given.
    """
    if name not in PARAMETER_SETS:
        raise InputError(f"unknown parameter set '{name}'{spelling_hint(name, sorted(PARAMETER_SETS))}")
    return PARAMETER_SETS[name]()


def container_ship() -> Model:
    """Return the model of Son & Nomoto with the published coefficients of the container ship S175."""
    from seatrial.physics.models.son_nomoto import son_nomoto

    return s175().applied_to(son_nomoto())


def kvlcc2() -> Model:
    """Return the MMG model of the 7 m KVLCC2 with its published coefficients."""
    from seatrial.physics.models.mmg import mmg

    return kvlcc2_l7().applied_to(mmg())
