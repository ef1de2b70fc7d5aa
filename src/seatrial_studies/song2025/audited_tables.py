"""Tables 1, 3 and 4 against our own series: condition numbers under either labelling, errors beside correlations."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.estimation.regress.features import Motion
from seatrial.estimation.regress.operators import Euler, Operator
from seatrial.estimation.regress.pipeline import IMPROVED
from seatrial.estimation.regress.system import systems
from seatrial.physics.models.waterjet import waterjet
from seatrial_studies.song2025.crafts import reference
from seatrial_studies.song2025.published import (
    BEAM,
    BLOCK,
    DRAUGHT,
    LENGTH,
    MASS,
    TABLE_3,
    TABLE_4,
    Equation,
    Run,
)

SWAPPED = {Equation.SURGE: Equation.SWAY, Equation.SWAY: Equation.SURGE, Equation.YAW: Equation.YAW}


@dataclass(frozen=True)
class Mass:
    """Density [kg/m^3], mass of the block rho C_b L B d [kg], and m' = m / (rho L^2 d / 2) with the printed mass."""

    density: float
    block: float
    nondimensional: float


def mass(density: float) -> Mass:
    """What table 1's mass is worth with a density."""
    return Mass(density, density * BLOCK * LENGTH * BEAM * DRAUGHT, MASS / (0.5 * density * LENGTH**2 * DRAUGHT))


@dataclass(frozen=True, eq=False)
class Conditions:
    """Condition numbers of the correlation matrices of each equation's features, table 3.

    Yaw's features v U, r U, r|r| are three of sway's five. Eigenvalues of a principal submatrix lie between those of
    the whole (Cauchy's interlacing theorem): sway's condition number is never below yaw's, whatever the record.

    Attributes:
        printed: as labelled; swapped: labels of surge and sway exchanged.
        plain: ours, features of eq. (14); improved: ours, differenced and centred, eq. (17), (18).
        correlations: ours, plain, each (k, k).
        is_possible: whether sway's is at least yaw's, as printed and swapped.
    """

    printed: dict[Equation, float]
    swapped: dict[Equation, float]
    plain: dict[Equation, float]
    improved: dict[Equation, float]
    correlations: dict[Equation, Array]
    is_possible: tuple[bool, bool]


def conditions(series: Record) -> Conditions:
    """Of the consecutive zigzags, noise-free, at the record's own rate."""
    plain, improved = correlations(series, Euler()), correlations(series, IMPROVED)
    swapped = {equation: TABLE_3[SWAPPED[equation]] for equation in Equation}
    return Conditions(
        dict(TABLE_3),
        swapped,
        {e: float(np.linalg.cond(a)) for e, a in plain.items()},
        {e: float(np.linalg.cond(a)) for e, a in improved.items()},
        plain,
        (_nested(TABLE_3), _nested(swapped)),
    )


def correlations(series: Record, operator: Operator) -> dict[Equation, Array]:
    """Correlation matrices (k, k) of the features of each equation."""
    craft = waterjet()
    made = systems(craft, [Motion.of(craft, series)], operator)
    return {Equation(s.equations[0]): np.asarray(np.corrcoef(s.matrix, rowvar=False)) for s in made}


def _nested(numbers: dict[Equation, float]) -> bool:
    return numbers[Equation.SWAY] >= numbers[Equation.YAW]


@dataclass(frozen=True)
class Implied:
    """What a cell of table 4 says together with the reference's own motion.

    Attributes:
        deviation: standard deviation of the reference motion, m/s or rad/s; largest: its largest magnitude.
        least: smallest root mean square error that the printed CC allows, deviation sqrt(1 - CC^2).
        amplitude: ratio of standard deviations, predicted over reference, that CC and RMSE together ask for without an
            error of the mean, which would explain some of the RMSE; NaN where no prediction has both.
    """

    run: Run
    channel: str
    deviation: float
    largest: float
    least: float
    amplitude: float


def implied_by_table_4() -> tuple[Implied, ...]:
    """Every cell: RMSE^2 = s^2 + s0^2 - 2 CC s s0 + (error of the mean)^2, s and s0 the standard deviations."""
    references = {run: reference(run) for run in TABLE_4}
    return tuple(_implied(run, c, references[run][c]) for run, said in TABLE_4.items() for c in said.cc)


def _implied(run: Run, channel: str, values: Array) -> Implied:
    cc, deviation = TABLE_4[run].cc[channel], float(np.std(values))
    inner = cc**2 - 1.0 + (TABLE_4[run].rmse[channel] / deviation) ** 2
    amplitude = cc + math.sqrt(inner) if inner >= 0.0 else math.nan
    largest = float(np.max(np.abs(values)))
    return Implied(run, channel, deviation, largest, deviation * math.sqrt(1.0 - cc**2), amplitude)
