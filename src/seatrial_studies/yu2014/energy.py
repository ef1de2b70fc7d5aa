"""Energy, the paper's point: W in joules, what propulsion loses to fin drag and roll, reversals of the fins.

W = I int S dω / eta (eq. (3)) is a kinetic energy: of both fins turning at their rms rate, over the drive's efficiency.
What the main engine loses is estimated, since the paper names it (introduction) and gives no formula.
"""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro import Complex
from seatrial.physics.loops import ActuatorDrive, Performance, reversals_per_hour
from seatrial_studies.yu2014.published import (
    ASPECT,
    CHORD,
    INERTIA,
    PUBLISHED_VALUES,
    SPAN,
    TABLE_1,
    ControllerResult,
)
from seatrial_studies.yu2014.published_loop import HULL_FACTOR, KNOT, performance
from seatrial_studies.yu2014.table_1_fit import Table1Fit

WATTS_PER_KILOWATT = 1000.0  # W, by definition
EFFICIENCY = 0.8  # eta of the fin drive, not printed; assumed: saved shares do not depend on it
SEA_WATER = 1025.0  # kg/m^3, density
GRAVITY = 9.80665  # m/s^2, standard
BLOCK_COEFFICIENT = 0.5  # of the assumed box of 100 x 10.5 x 3.4 m; assumed, a slender patrol ship
# roll radius of gyration with added mass over the breadth: C sqrt(g) / pi of T = 2 C B / sqrt(GM) with C = 0.373 +
# 0.023 B/d - 0.043 L/100 = 0.401 for 100 x 10.5 x 3.4 m (2008 IS Code, IMO resolution MSC.267(85), part A, 2.3)
GYRADIUS_SHARE = 0.4
PLANT_DAMPING = 0.3796  # s, coefficient of s of G_phi: 2 zeta T
PLANT_PERIOD_SQUARED = 1.43242  # s^2, coefficient of s^2 of G_phi
# drag coefficient of NACA 0015 at zero lift: Whicker & Fehlner 1958, DTMB Report 933, as later texts on fins quote it
PROFILE_DRAG = 0.0065
OSWALD = 0.9  # efficiency in C_L^2 / (0.9 pi a_e); Whicker & Fehlner 1958, quoted likewise


@dataclass(frozen=True)
class FinEnergy:
    """What one controller costs in one condition.

    Attributes:
        work: W of eq. (3), J.
        fin_power, roll_power: estimates of what propulsion loses to the drag of both fins and to roll, W; NaN where the
            motion that they need is not known.
        reversals: of the fins in an hour; NaN likewise.
    """

    work: float
    fin_power: float = math.nan
    roll_power: float = math.nan
    reversals: float = math.nan


@dataclass(frozen=True)
class EnergyComparison:
    """One row of table 1: the traditional PID and the GA, as printed and as fitted by us; ratios are GA over PID."""

    row: str
    printed_rate_ratio: float
    fitted_rate_ratio: float
    printed: tuple[FinEnergy, FinEnergy]
    fitted: tuple[FinEnergy, FinEnergy]

    @staticmethod
    def saved(pair: tuple[FinEnergy, FinEnergy]) -> float:
        """Return what the GA saves of W, per cent."""
        return 100.0 * (1.0 - pair[1].work / pair[0].work)


def work(rate: float) -> float:
    """Return W [J] of eq. (3) at an rms fin rate [deg/s]."""
    return ActuatorDrive(INERTIA, EFFICIENCY).energy(math.radians(rate) ** 2)


def lift_slope() -> float:
    """Return C_L per radian at twice the aspect ratio, the hull a mirror (Whicker & Fehlner 1958, eq. (1), linear)."""
    a = 2.0 * ASPECT
    return 1.8 * math.pi * a / (1.8 + math.sqrt(a**2 + 4.0))  # 1.8: 0.9 of 2 pi, over pi; unswept


def fin_drag_power(fin_rms: float, speed: float) -> float:
    """Return the mean power [W] that two fins of an rms angle [deg] drag at a speed [kn]: D U of both.

    C_D = C_D0 + C_L^2 / (0.9 pi a_e) (Whicker & Fehlner 1958, DTMB Report 933), mean over a Gaussian fin angle.
    """
    U = speed * KNOT
    C_L_squared = (lift_slope() * math.radians(fin_rms)) ** 2
    C_D = PROFILE_DRAG + C_L_squared / (OSWALD * math.pi * 2.0 * ASPECT)
    return 2.0 * 0.5 * SEA_WATER * U**3 * SPAN * CHORD * C_D


def roll_power(roll_rate_rms: float) -> float:
    """Return the mean power [W] that roll damping dissipates at an rms roll rate [deg/s]: an upper bound of the loss.

    2 zeta T (Delta g GM) var(roll rate): the moment of damping times the rate (Himeno 1981, Prediction of Ship Roll
    Damping, University of Michigan, Department of Naval Architecture and Marine Engineering, Report 239).
    Waves feed the motion, so that the engine loses this at most. GM from the plant's period by a gyradius of 0.4 B.
    """
    hull = HULL_FACTOR
    mass = SEA_WATER * hull.L * hull.B * hull.T * BLOCK_COEFFICIENT
    inertia = mass * (GYRADIUS_SHARE * hull.B) ** 2
    restoring = inertia / PLANT_PERIOD_SQUARED  # N m/rad: T^2 is inertia over restoring
    return PLANT_DAMPING * restoring * math.radians(roll_rate_rms) ** 2


def fin_energy(loop_performance: Performance, gains: Array, speed: float, level: float = 1.0) -> FinEnergy:
    """Return the energy of gains in a sea; `level` multiplies all motions."""
    loop, w = loop_performance.loop, loop_performance.spectrum.omega_e
    roll = loop.disturbance.frequency_response(w) / (1.0 + loop.with_gains(gains).open_loop(w))
    fin = roll * (gains @ loop.controller_terms(w))

    def rms(response: Complex, power: int) -> float:
        energy = np.abs(response) ** 2 * loop_performance.spectrum.energy * np.abs(w) ** (2 * power)
        return level * math.degrees(math.sqrt(float(np.sum(energy))))

    rate = rms(fin, 1)
    return FinEnergy(
        work(rate), fin_drag_power(rms(fin, 0), speed), roll_power(rms(roll, 1)), reversals_per_hour(rate, rms(fin, 2))
    )


def compare_energy(fit: Table1Fit) -> tuple[EnergyComparison, ...]:
    """Return every row of table 1 as printed, and with the fitted loop, sea and baseline."""
    rows = []
    for row in TABLE_1:
        sea = fit.sea(row.heading, row.speed)
        of = performance(fit.preamplifier, sea, fit.K_q)
        fitted = tuple(fin_energy(of, gains, row.speed, fit.level) for gains in (fit.baseline, PUBLISHED_VALUES))
        rows.append(
            EnergyComparison(
                row.name,
                row.genetic.rate / row.traditional.rate,
                math.sqrt(fitted[1].work / fitted[0].work),
                (_printed(row.traditional), _printed(row.genetic)),
                (fitted[0], fitted[1]),
            )
        )
    return tuple(rows)


def _printed(column: ControllerResult) -> FinEnergy:
    return FinEnergy(work(column.rate))
