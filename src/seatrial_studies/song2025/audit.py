"""What the paper's own equations and numbers say when they are worked through again: every misprint with evidence."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.estimation.regress import (
    DIFFERENCED_AND_CENTRED,
    DerivativeOperator,
    Euler,
    RegressionMotion,
    build_systems,
    features,
)
from seatrial.physics.models import waterjet
from seatrial_studies.song2025.generalisation import prediction_accuracy
from seatrial_studies.song2025.published import (
    APPROACH_SPEED,
    BEAM,
    BLOCK,
    CORRECTED,
    DRAUGHT,
    LENGTH,
    MASS,
    TABLE_3,
    TABLE_4,
    TRUTH,
    CoefficientSet,
    MotionEquation,
    PublishedManoeuvre,
    Table2Column,
    manoeuvre_record,
    printed_coefficients,
    reference_record,
    replay_inputs,
    simulate_manoeuvre,
    symbol,
    with_expressions,
)

# Misprints that show when the equations are worked through: equations (1), (14), (27), thrust.

_FORCE_LETTERS = {MotionEquation.SURGE: "X", MotionEquation.SWAY: "Y", MotionEquation.YAW: "N"}


def parenthesis_factors() -> dict[MotionEquation, float]:
    """How often the rate of each equation comes out too large if 1/m + m_x is read as eq. (1) prints it, in SI units.

    For the reciprocal of the sum, (1/m + m_x)(m + m_x) is 1; so for m_y and for I_zz, J_zz.
    """
    p = TRUTH.craft().parameters
    pairs = {MotionEquation.SURGE: ("m", "m_x"), MotionEquation.SWAY: ("m", "m_y"), MotionEquation.YAW: ("I_z", "J_z")}
    return {
        equation: (1.0 / p[own].value + p[added].value) * (p[own].value + p[added].value)
        for equation, (own, added) in pairs.items()
    }


@dataclass(frozen=True, eq=False)
class Equation14System:
    """One equation of (14) along a record: features (n, k) times coefficients (k,) = target (n,), all in m^2/s^2."""

    names: tuple[str, ...]
    matrix: Array
    target: Array

    def solve(self) -> dict[str, float]:
        """Return the least-squares solution by coefficient."""
        scale = np.sqrt(np.mean(self.matrix**2, axis=0))
        found = np.linalg.lstsq(self.matrix / scale, self.target)[0] / scale
        return dict(zip(self.names, map(float, found), strict=True))


def equation_14_systems(record: Record) -> dict[MotionEquation, Equation14System]:
    """Eq. (14) corrected, from the model, with exact accelerations in place of differences.

    Rates times total inertia over rho L d / 2 (yaw: over rho L^2 d / 2).
    """
    craft = TRUTH.craft()
    at = features(craft, RegressionMotion.from_record(craft, record))
    p = craft.parameters
    theta = np.array([item.value for item in p.free])
    q = 0.5 * p["rho"].value * LENGTH * DRAUGHT
    inertias = {
        MotionEquation.SURGE: (p["m"].value + p["m_x"].value) / q,
        MotionEquation.SWAY: (p["m"].value + p["m_y"].value) / q,
        MotionEquation.YAW: (p["I_z"].value + p["J_z"].value) / (q * LENGTH),
    }
    made = {}
    for equation, inertia in inertias.items():
        state = craft.states.index(equation)
        columns = [j for j, n in enumerate(p.free_names) if n[0] == _FORCE_LETTERS[equation]]
        matrix = inertia * at.slope[:, state][:, columns]
        made[equation] = Equation14System(tuple(p.free_names[j] for j in columns), matrix, matrix @ theta[columns])
    return made


@dataclass(frozen=True)
class Equation14Fit:
    """What least squares on noise-free data and exact accelerations makes of one reading of eq. (14).

    Attributes:
        errors: coefficient -> error in per cent of the truth.
        residual: rms of what is left over rms of the target.
    """

    variant: str
    errors: dict[str, float]
    residual: float


def equation_14_fits(record: Record) -> tuple[Equation14Fit, ...]:
    """Eq. (14) corrected, then each misprint alone: [u^2, v^2, r^2] L^2, the sign of u r, L^3 in yaw."""
    corrected = equation_14_systems(record)
    surge, sway, yaw = (corrected[e] for e in MotionEquation)
    L, p = LENGTH, TRUTH.craft().parameters
    q = 0.5 * p["rho"].value * L * DRAUGHT
    ur = (p["m"].value + p["m_x"].value) / q * record["u"] * record["r"]
    r_dot = (p["I_z"].value + p["J_z"].value) / (q * L) * _yaw_acceleration(record)
    return (
        *(_equation_14_fit(f"{_FORCE_LETTERS[e]}, corrected", corrected[e]) for e in MotionEquation),
        _equation_14_fit("X, [u^2, v^2, r^2] L^2", replace(surge, matrix=surge.matrix * np.array([L**2, L**2, 1.0]))),
        _equation_14_fit("Y, - (m' + m_x') L u r", replace(sway, target=sway.target - 2.0 * ur)),
        _equation_14_fit("N, (I' + J') L^3 dr/dt", replace(yaw, target=yaw.target + (L - 1.0) * r_dot)),
    )


def _yaw_acceleration(record: Record) -> Array:
    craft = TRUTH.craft()
    at = features(craft, RegressionMotion.from_record(craft, record))
    theta = np.array([item.value for item in craft.parameters.free])
    return (at.known_rates + at.slope @ theta)[:, craft.states.index(MotionEquation.YAW)]


def _equation_14_fit(variant: str, system: Equation14System) -> Equation14Fit:
    found = system.solve()
    p = TRUTH.craft().parameters
    errors = {name: 100.0 * (value / p[name].value - 1.0) for name, value in found.items()}
    left = system.target - system.matrix @ np.array(list(found.values()))
    return Equation14Fit(variant, errors, float(np.linalg.norm(left) / np.linalg.norm(system.target)))


@dataclass(frozen=True)
class Equation27Readings:
    """Readings of eq. (27) for a correlation matrix A, 2-norms.

    Attributes:
        with_inverse: |A| |A^-1|, which is the largest over the smallest singular value, eq. (28).
        without_inverse: |A| |A|, if the inverse is left out.
    """

    with_inverse: float
    without_inverse: float


def equation_27_readings(correlation: Array) -> Equation27Readings:
    """Return the readings of eq. (27) for a correlation matrix (k, k)."""
    size = float(np.linalg.norm(correlation, 2))
    return Equation27Readings(size * float(np.linalg.norm(np.linalg.inv(correlation), 2)), size**2)


@dataclass(frozen=True)
class Thrust:
    """Jet velocity [m/s] that balances resistance at the stated speed, eq. (2), (3), and the thrust [N]."""

    jet_velocity: float
    thrust: float


def balancing_thrust() -> Thrust:
    """Root of rho A_j v_j (v_j - alpha u) = rho L d / 2 |X_uu| u^2 at 0.8 m/s; the density cancels in the velocity."""
    p = TRUTH.craft().parameters
    half = 0.5 * p["alpha"].value * APPROACH_SPEED
    per_density = 0.5 * LENGTH * DRAUGHT * -printed_coefficients(Table2Column.CFD)["X_uu"] * APPROACH_SPEED**2
    return Thrust(half + math.sqrt(half**2 + per_density / p["A_j"].value), p["rho"].value * per_density)


# Tables 1, 3 and 4 against our own series: condition numbers under either labelling, errors beside correlations.

LABELS_EXCHANGED = {
    MotionEquation.SURGE: MotionEquation.SWAY,
    MotionEquation.SWAY: MotionEquation.SURGE,
    MotionEquation.YAW: MotionEquation.YAW,
}


@dataclass(frozen=True)
class Table1Mass:
    """Density [kg/m^3], mass of the block rho C_b L B d [kg], and m' = m / (rho L^2 d / 2) with the printed mass."""

    density: float
    block: float
    nondimensional: float


def table_1_mass(density: float) -> Table1Mass:
    """Return what table 1's mass implies with a density."""
    return Table1Mass(density, density * BLOCK * LENGTH * BEAM * DRAUGHT, MASS / (0.5 * density * LENGTH**2 * DRAUGHT))


@dataclass(frozen=True, eq=False)
class FeatureConditions:
    """Condition numbers of the correlation matrices of each equation's features, table 3.

    Yaw's features v U, r U, r|r| are three of sway's five. Eigenvalues of a principal submatrix lie between those of
    the whole (Cauchy's interlacing theorem): sway's condition number is never below yaw's, whatever the record.

    Attributes:
        labels_exchanged: the printed ones, labels of surge and sway exchanged.
        plain: ours, features of eq. (14); improved: ours, differenced and centred, eq. (17), (18).
        correlations: ours, plain, each (k, k).
    """

    labels_exchanged: dict[MotionEquation, float]
    plain: dict[MotionEquation, float]
    improved: dict[MotionEquation, float]
    correlations: dict[MotionEquation, Array]


def feature_conditions(series: Record) -> FeatureConditions:
    """Of the consecutive zigzags, noise-free, at the record's own rate."""
    plain, improved = feature_correlations(series, Euler()), feature_correlations(series, DIFFERENCED_AND_CENTRED)
    swapped = {equation: TABLE_3[LABELS_EXCHANGED[equation]] for equation in MotionEquation}
    return FeatureConditions(
        swapped,
        {e: float(np.linalg.cond(a)) for e, a in plain.items()},
        {e: float(np.linalg.cond(a)) for e, a in improved.items()},
        plain,
    )


def feature_correlations(series: Record, operator: DerivativeOperator) -> dict[MotionEquation, Array]:
    """Return the correlation matrices (k, k) of the features of each equation."""
    craft = waterjet()
    made = build_systems(craft, [RegressionMotion.from_record(craft, series)], operator)
    return {MotionEquation(s.equations[0]): np.asarray(np.corrcoef(s.matrix, rowvar=False)) for s in made}


@dataclass(frozen=True)
class Table4Implication:
    """What a cell of table 4 says together with the reference's own motion.

    Attributes:
        largest: largest magnitude of the reference motion, m/s or rad/s.
        amplitude_ratio: ratio of standard deviations, predicted over reference, that CC and RMSE imply
            where the mean has no error, which would explain some of the RMSE; NaN where no prediction has both.
    """

    run: PublishedManoeuvre
    channel: str
    largest: float
    amplitude_ratio: float


def table_4_implications() -> tuple[Table4Implication, ...]:
    """Every cell: RMSE^2 = s^2 + s0^2 - 2 CC s s0 + (error of the mean)^2, s and s0 the standard deviations."""
    references = {run: reference_record(run) for run in TABLE_4}
    return tuple(_table_4_implication(run, c, references[run][c]) for run, said in TABLE_4.items() for c in said.cc)


def _table_4_implication(run: PublishedManoeuvre, channel: str, values: Array) -> Table4Implication:
    cc, deviation = TABLE_4[run].cc[channel], float(np.std(values))
    inner = cc**2 - 1.0 + (TABLE_4[run].rmse[channel] / deviation) ** 2
    amplitude = cc + math.sqrt(inner) if inner >= 0.0 else math.nan
    return Table4Implication(run, channel, float(np.max(np.abs(values))), amplitude)


# Misprints that show when the craft is simulated as printed: signs of table 2, equations (2) and (3).

# deg, nozzle angles of the zigzags and of the turn
ZIGZAGS, TURN_ANGLE = (10, 20, 35), 20


@dataclass(frozen=True)
class ReversedTurn:
    """What the sign of N_v does, CFD column.

    Attributes:
        yaw_rates: deg/s at the end of a turn with 20 deg to starboard, N_v corrected and as printed.
        completed_zigzags: zigzags of 10, 20 and 35 deg that come to their end, corrected and as printed.
    """

    yaw_rates: tuple[float, float]
    completed_zigzags: tuple[int, int]


def reversed_turn() -> ReversedTurn:
    """Steady turn and zigzags of the CFD column with N_v negative and as printed."""
    readings = (TRUTH, CoefficientSet(Table2Column.CFD))
    rates = [
        math.degrees(_final_value(manoeuvre_record(r.craft(), f"turning-circle:{TURN_ANGLE}"), "r")) for r in readings
    ]
    finished = [sum(simulate_manoeuvre(r.craft(), f"zigzag:{a}/{a}").is_completed for a in ZIGZAGS) for r in readings]
    return ReversedTurn((rates[0], rates[1]), (finished[0], finished[1]))


@dataclass(frozen=True)
class UndampedSway:
    """What the sign of the improved column's Y_vv does, N_v corrected, on the truth's nozzle history.

    Attributes:
        divergence_times: run -> s after which the motion leaves all bounds, as printed; infinite where it does not.
        corrected_cc: channel -> CC in the 35/35 zigzag with Y_vv negative.
        critical_drift: deg beyond which Y_v + Y_vv |v|/U is positive, so that sway is driven, as printed.
    """

    divergence_times: dict[PublishedManoeuvre, float]
    corrected_cc: dict[str, float]
    critical_drift: float


def undamped_sway() -> UndampedSway:
    """Return the 20/20 and 35/35 zigzags and the 35 deg turn with the improved column's Y_vv of either sign."""
    printed, corrected = CoefficientSet(Table2Column.IMPROVED, ("N_v",)).craft(), CORRECTED[2].craft()
    references = {
        run: reference_record(run)
        for run in (PublishedManoeuvre.ZIGZAG_20, PublishedManoeuvre.ZIGZAG_35, PublishedManoeuvre.TURN_35)
    }
    values, zigzag = printed_coefficients(Table2Column.IMPROVED), references[PublishedManoeuvre.ZIGZAG_35]
    return UndampedSway(
        {run: _divergence_time(printed, record) for run, record in references.items()},
        prediction_accuracy(zigzag, replay_inputs(corrected, zigzag)).cc,
        math.degrees(math.asin(-values["Y_v"] / values["Y_vv"])),
    )


@dataclass(frozen=True)
class PortStarboardAsymmetry:
    """What alpha v in place of alpha u in Y_P, eq. (3), and |v|, |r| in Y_H, N_H, eq. (2), do to a symmetric craft.

    Attributes:
        jet_yaw_rates: deg/s of yaw at the end of a 20 deg turn to starboard and to port, eq. (3) as printed.
        corrected_yaw_rates: deg/s of yaw with alpha u.
        hull_divergence_times: s after which the motion leaves all bounds on the nozzle history of these turns, eq. (2)
            as printed; infinite where it does not.
    """

    jet_yaw_rates: tuple[float, float]
    corrected_yaw_rates: tuple[float, float]
    hull_divergence_times: tuple[float, float]


def port_starboard_asymmetry() -> PortStarboardAsymmetry:
    """Return turns to either side."""
    craft = TRUTH.craft()
    jet, hull = jet_as_printed(craft), hull_as_printed(craft)
    sides = (f"turning-circle:{TURN_ANGLE}", f"turning-circle:{TURN_ANGLE}:port")
    turns, corrected = (
        [manoeuvre_record(jet, side) for side in sides],
        [manoeuvre_record(craft, side) for side in sides],
    )
    return PortStarboardAsymmetry(
        _pair([math.degrees(_final_value(turn, "r")) for turn in turns]),
        _pair([math.degrees(_final_value(turn, "r")) for turn in corrected]),
        _pair([_divergence_time(hull, turn) for turn in corrected]),
    )


def jet_as_printed(craft: Model) -> Model:
    """Return the side force of the jet with alpha v, eq. (3)."""
    rho, A_j, v_j, alpha, v, delta = (symbol(n) for n in ("rho", "A_j", "v_j", "alpha", "v", "delta"))
    return with_expressions(
        craft, "waterjet_jet_as_printed", {"Y_P": rho * A_j * v_j * (v_j - alpha * v) * sp.sin(delta)}
    )


def hull_as_printed(craft: Model) -> Model:
    """Y_H and N_H with |v| and |r| where v|v| and r|r| are meant, eq. (2)."""
    q, L, U, v, r_L = (symbol(n) for n in ("q", "L", "U", "v", "r_L"))
    Y_v, Y_r, Y_vv, Y_vr, Y_rr, N_v, N_r, N_rr = (symbol(n) for n in craft.parameters.free_names[3:])
    Y_H = q * (Y_v * v * U + Y_r * r_L * U + Y_vv * sp.Abs(v) + Y_rr * sp.Abs(r_L) + Y_vr * sp.Abs(v) * r_L)
    N_H = q * L * (N_v * v * U + N_r * r_L * U + N_rr * sp.Abs(r_L))
    return with_expressions(craft, "waterjet_hull_as_printed", {"Y_H": Y_H, "N_H": N_H})


def _divergence_time(craft: Model, record: Record) -> float:
    again = replay_inputs(craft, record)
    return math.inf if len(again) == len(record) else float(again.time[-1])


def _final_value(record: Record, channel: str) -> float:
    return float(record[channel][-1])


def _pair(values: list[float]) -> tuple[float, float]:
    return values[0], values[1]


# Whether the signs of table 2 are misprints under other values of what the paper leaves open.

TURN_PROGRAMME = "turning-circle:20"
# kg/m^3, customary densities
FRESH_WATER_DENSITY, SALT_WATER_DENSITY = 1000.0, 1025.0


def assumed_parameter_sets() -> tuple[dict[str, float], ...]:
    """Values of parameters that table 1 does not give, one set a choice.

    Our own; fresh water; each of the others a third less and more (the nozzle 0.05 L farther and nearer). J_z acts in
    sum with I_z alone.
    """
    p = waterjet().parameters
    made = [{}, {"rho": FRESH_WATER_DENSITY}]
    made += [{name: f * p[name].value} for name in ("m_x", "m_y", "I_z", "A_j") for f in (2.0 / 3.0, 4.0 / 3.0)]
    return (*made, *({"x_T": f * p["L"].value} for f in (-0.5, -0.4)))


@dataclass(frozen=True)
class SignCheck:
    """What the signs do under one choice.

    Attributes:
        yaw_rates: deg/s at the end of a 20 deg turn to starboard, CFD column, N_v corrected and as printed.
        completes_zigzag: whether the 20/20 zigzag is completed, N_v corrected and as printed.
        divergence_time: s in the 35/35 zigzag on the truth's nozzle history, improved column, N_v corrected;
            infinite where the motion stays bounded.
    """

    yaw_rates: tuple[float, float]
    completes_zigzag: tuple[bool, bool]
    divergence_time: float

    @property
    def confirms_misprints(self) -> bool:
        """The printed N_v reverses the turn and stops the zigzag, the printed Y_vv diverges; corrected, neither."""
        corrected, printed = self.yaw_rates
        return (
            corrected > 0.0 > printed and self.completes_zigzag == (True, False) and math.isfinite(self.divergence_time)
        )


def check_signs(assumed: Mapping[str, float]) -> SignCheck:
    """Return what the signs do under one choice (some 0.4 s)."""
    readings = (TRUTH, CoefficientSet(Table2Column.CFD), CoefficientSet(Table2Column.IMPROVED, ("N_v",)))
    corrected, printed, driven = (r.craft().with_values(assumed) for r in readings)
    zigzag = manoeuvre_record(corrected, PublishedManoeuvre.ZIGZAG_35)
    again = replay_inputs(driven, zigzag)
    return SignCheck(
        (
            _degrees_per_second(manoeuvre_record(corrected, TURN_PROGRAMME)["r"][-1]),
            _degrees_per_second(manoeuvre_record(printed, TURN_PROGRAMME)["r"][-1]),
        ),
        (
            simulate_manoeuvre(corrected, PublishedManoeuvre.ZIGZAG_20).is_completed,
            simulate_manoeuvre(printed, PublishedManoeuvre.ZIGZAG_20).is_completed,
        ),
        math.inf if len(again) == len(zigzag) else float(again.time[-1]),
    )


def _degrees_per_second(radians: float) -> float:
    return math.degrees(float(radians))


@dataclass(frozen=True, eq=False)
class SupportVectorAudit:
    """Numbers behind the verdicts on the print; no random number is drawn.

    Attributes:
        reversed_turn: sign of N_v, table 2.
        undamped_sway: sign of Y_vv, table 2, improved column.
        asymmetry: alpha v in eq. (3), |v| and |r| in eq. (2).
        parenthesis_factors: equation -> by what eq. (1) is too large without them.
        equation_14_fits: eq. (14) corrected, and with each misprint alone.
        equation_27_readings: eq. (27), sway.
        table_3_conditions: table 3.
        table_1_masses: table 1, in fresh and in salt water.
        thrust: the balance at the stated speed.
        table_4_implications: table 4.
        sign_checks: the signs of N_v and Y_vv again, under other choices.
    """

    reversed_turn: ReversedTurn
    undamped_sway: UndampedSway
    asymmetry: PortStarboardAsymmetry
    parenthesis_factors: dict[MotionEquation, float]
    equation_14_fits: tuple[Equation14Fit, ...]
    equation_27_readings: Equation27Readings
    table_3_conditions: FeatureConditions
    table_1_masses: tuple[Table1Mass, Table1Mass]
    thrust: Thrust
    table_4_implications: tuple[Table4Implication, ...]
    sign_checks: tuple[SignCheck, ...]


def audit(assumptions: Sequence[Mapping[str, float]]) -> SupportVectorAudit:
    """Everything: some 3 s, and 0.4 s for each of the `others` (`choices()` or some of them)."""
    series = reference_record(PublishedManoeuvre.CONSECUTIVE)
    of_features = feature_conditions(series)
    return SupportVectorAudit(
        reversed_turn(),
        undamped_sway(),
        port_starboard_asymmetry(),
        parenthesis_factors(),
        equation_14_fits(series),
        equation_27_readings(of_features.correlations[MotionEquation.SWAY]),
        of_features,
        (table_1_mass(FRESH_WATER_DENSITY), table_1_mass(SALT_WATER_DENSITY)),
        balancing_thrust(),
        table_4_implications(),
        tuple(check_signs(choice) for choice in assumptions),
    )
