"""Linear heave and pitch in waves, with one or two fins: two coupled equations, eight or twelve unknowns.

The equations read the same with z up and theta bow down, as seakeeping has it (here z is down, theta bow up).
"""

from functools import cache

import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.physics.models.published import DAMPINGS, HEAVE_PITCH_COEFFICIENTS, HEAVE_PITCH_STIFFNESSES, MASSES

QI = "Qi et al. 2025, eq. (1)"
MENG = "Meng et al. 2014, eq. (1)"
STRIP = "Salvesen, Tuck & Faltinsen 1970, speed terms without a transom"
_ZERO_SPEED_COEFFICIENTS = (
    ("a33", "kg", "added mass, heave"),
    ("b33", "kg/s", "damping, heave"),
    ("a35_0", "kg m", "added mass between heave and pitch, at rest"),
    ("b35_0", "kg m/s", "damping between heave and pitch, at rest"),
    ("a55_0", "kg m^2", "added moment of inertia, at rest"),
    ("b55_0", "kg m^2/s", "damping, pitch, at rest"),
)
_COEFFICIENT_KINDS = {"a": "added mass", "b": "damping", "c": "restoring"}
_COUPLINGS = {"33": "heave", "35": "heave from pitch", "53": "pitch from heave", "55": "pitch"}


def _coefficients(sheet: Sheet) -> dict[str, sp.Symbol]:
    named = {}
    for name, unit in (MASSES | DAMPINGS | HEAVE_PITCH_STIFFNESSES).items():
        free = name in HEAVE_PITCH_COEFFICIENTS
        meaning = f"{_COEFFICIENT_KINDS[name[0]]}, {_COUPLINGS[name[1:]]}"
        latex = f"{name[0]}_{{{name[1:]}}}"
        named[name] = sheet.parameter(name, unit=unit, meaning=meaning, source=QI, free=free, latex=latex)
    return named


def _fin(sheet: Sheet, number: int) -> tuple[sp.Expr, sp.Expr]:
    """Return the force and moment of a fin: its angle held by the servo between samples."""
    angle = sheet.input(f"delta_f{number}", positive="down", is_held=True)
    slope = sheet.parameter(f"lift_{number}", 0.0, "N/rad", f"lift slope of fin {number}", scale=1.0)
    x = sheet.parameter(f"x_f{number}", 0.0, "m", f"place of fin {number}, forward of the origin", scale=1.0)
    lift = sheet.bind(f"L_f{number}", slope * angle, f"{MENG}, F_R", "N")
    return lift, -x * lift


def _assembled_model(name: str, meaning: str, *, is_held: bool = False) -> Model:
    sheet = Sheet(name, QI, meaning)
    states = sheet.states("z z_dot theta theta_dot")
    _plant(sheet, states, _coefficients(sheet), is_held=is_held)
    return sheet.model()


def _plant(sheet: Sheet, states: tuple[sp.Symbol, ...], c: dict[str, sp.Symbol], *, is_held: bool = False) -> None:
    """Write two coupled equations of motion with the coefficients `c`, whatever they are made of."""
    z, z_dot, theta, theta_dot = states
    F3 = sheet.input("F3", positive="down", is_held=is_held)
    M5 = sheet.input("M5", positive="bow up", is_held=is_held)
    m = sheet.parameter("m", unit="kg", meaning="mass")
    I5 = sheet.parameter("I5", unit="kg m^2", meaning="moment of inertia in pitch", latex="I_5")
    fins = [_fin(sheet, number) for number in (1, 2)]
    heave = F3 + sum((force for force, _ in fins), sp.Integer(0))
    pitch = M5 + sum((moment for _, moment in fins), sp.Integer(0))
    Z = sheet.bind(
        "Z", heave - c["b33"] * z_dot - c["c33"] * z - c["b35"] * theta_dot - c["c35"] * theta, f"{QI}; {MENG}", "N"
    )
    M = sheet.bind(
        "M", pitch - c["b53"] * z_dot - c["c53"] * z - c["b55"] * theta_dot - c["c55"] * theta, f"{QI}; {MENG}", "N m"
    )
    heave_mass = sheet.bind("m_3", m + c["a33"], QI, "kg")
    pitch_mass = sheet.bind("I_55", I5 + c["a55"], QI, "kg m^2")
    det = sheet.bind("det", heave_mass * pitch_mass - c["a35"] * c["a53"], "determinant of the mass matrix", "kg^2 m^2")
    sheet.rate(z, z_dot, QI)
    sheet.rate(z_dot, (pitch_mass * Z - c["a35"] * M) / det, f"{QI}, mass matrix inverted")
    sheet.rate(theta, theta_dot, QI)
    sheet.rate(theta_dot, (heave_mass * M - c["a53"] * Z) / det, f"{QI}, mass matrix inverted")


@cache
def heave_pitch() -> Model:
    """Return linear heave and pitch with states z [m, down], z_dot [m/s], theta [rad, bow up], theta_dot [rad/s].

    Inputs F3 [N], M5 [N m] of the waves, continuous between samples; delta_f1, delta_f2 [rad] of the fins, held.
    Free: a33 a35 a55 a53 b33 b35 b55 b53; c33 c35 c53 c55 may be freed too. The ship gives m, I5 and the stiffnesses.
    """
    return _assembled_model("heave_pitch", "heave and pitch in waves")


@cache
def heave_pitch_zoh() -> Model:
    """Return `heave_pitch` with the wave force held over each sample, as Qi et al. 2025, eq. (8), discretise it."""
    return _assembled_model("heave_pitch_zoh", "heave and pitch, wave force held between samples", is_held=True)


@cache
def heave_pitch_strip() -> Model:
    """Return heave and pitch at any speed from six coefficients at rest, tied by strip theory (b35 - b53 = 2 U a33).

    Inputs besides those of `heave_pitch`: u [m/s] and omega_e [rad/s], both constant in a record: the speed, and the
    frequency of encounter at which the speed terms are taken. Free: a33 b33 a35_0 b35_0 a55_0 b55_0; several speeds and
    headings are fitted together. Not affine: inputs run straight between samples, so record at 20 Hz.
    """
    sheet = Sheet("heave_pitch_strip", STRIP, "heave and pitch at any speed, strip theory")
    states = sheet.states("z z_dot theta theta_dot")
    u, omega_e = sheet.input("u", is_held=True), sheet.input("omega_e", is_held=True)
    at_rest = {}
    for name, unit, meaning in _ZERO_SPEED_COEFFICIENTS:
        latex = f"{name[0]}_{{{name[1:3]}}}" + ("^0" if name.endswith("_0") else "")
        at_rest[name] = sheet.parameter(name, unit=unit, meaning=meaning, source=STRIP, free=True, latex=latex)
    c = {
        name: sheet.parameter(name, unit=unit, meaning=f"restoring, {_COUPLINGS[name[1:]]}", source=QI)
        for name, unit in HEAVE_PITCH_STIFFNESSES.items()
    }
    a33, b33, a35, b35 = (at_rest[n] for n in ("a33", "b33", "a35_0", "b35_0"))
    c |= {"a33": a33, "b33": b33}
    lever = sheet.bind("lever", u / omega_e**2, STRIP, "m s")
    c["a35"] = sheet.bind("a35", a35 - lever * b33, STRIP, "kg m")
    c["a53"] = sheet.bind("a53", a35 + lever * b33, STRIP, "kg m")
    c["b35"] = sheet.bind("b35", b35 + u * a33, STRIP, "kg m/s")
    c["b53"] = sheet.bind("b53", b35 - u * a33, STRIP, "kg m/s")
    c["a55"] = sheet.bind("a55", at_rest["a55_0"] + u * lever * a33, STRIP, "kg m^2")
    c["b55"] = sheet.bind("b55", at_rest["b55_0"] + u * lever * b33, STRIP, "kg m^2/s")
    _plant(sheet, states, c)
    return sheet.model()
