"""Tables 1, 3 and 4 against our own series: condition numbers under either labelling, errors beside correlations."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.estimation.regress import (
    DIFFERENCED_AND_CENTRED,
    DerivativeOperator,
    Euler,
    RegressionMotion,
    build_systems,
)
from seatrial.physics.models import waterjet
from seatrial_studies.song2025.craft_models import reference_record
from seatrial_studies.song2025.published import (
    BEAM,
    BLOCK,
    DRAUGHT,
    LENGTH,
    MASS,
    TABLE_3,
    TABLE_4,
    MotionEquation,
    PublishedManoeuvre,
)

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
        printed: as labelled; labels_exchanged: labels of surge and sway exchanged.
        plain: ours, features of eq. (14); improved: ours, differenced and centred, eq. (17), (18).
        correlations: ours, plain, each (k, k).
        is_possible: whether sway's is at least yaw's, as printed and swapped.
    """

    printed: dict[MotionEquation, float]
    labels_exchanged: dict[MotionEquation, float]
    plain: dict[MotionEquation, float]
    improved: dict[MotionEquation, float]
    correlations: dict[MotionEquation, Array]
    is_possible: tuple[bool, bool]


def feature_conditions(series: Record) -> FeatureConditions:
    """Of the consecutive zigzags, noise-free, at the record's own rate."""
    plain, improved = feature_correlations(series, Euler()), feature_correlations(series, DIFFERENCED_AND_CENTRED)
    swapped = {equation: TABLE_3[LABELS_EXCHANGED[equation]] for equation in MotionEquation}
    return FeatureConditions(
        dict(TABLE_3),
        swapped,
        {e: float(np.linalg.cond(a)) for e, a in plain.items()},
        {e: float(np.linalg.cond(a)) for e, a in improved.items()},
        plain,
        (_is_nested(TABLE_3), _is_nested(swapped)),
    )


def feature_correlations(series: Record, operator: DerivativeOperator) -> dict[MotionEquation, Array]:
    """Return the correlation matrices (k, k) of the features of each equation."""
    craft = waterjet()
    made = build_systems(craft, [RegressionMotion.from_record(craft, series)], operator)
    return {MotionEquation(s.equations[0]): np.asarray(np.corrcoef(s.matrix, rowvar=False)) for s in made}


def _is_nested(numbers: dict[MotionEquation, float]) -> bool:
    return numbers[MotionEquation.SWAY] >= numbers[MotionEquation.YAW]


@dataclass(frozen=True)
class Table4Implication:
    """What a cell of table 4 says together with the reference's own motion.

    Attributes:
        deviation: standard deviation of the reference motion, m/s or rad/s; largest: its largest magnitude.
        least_rmse: smallest root mean square error that the printed CC allows, deviation sqrt(1 - CC^2).
        amplitude_ratio: ratio of standard deviations, predicted over reference, that CC and RMSE imply
            where the mean has no error, which would explain some of the RMSE; NaN where no prediction has both.
    """

    run: PublishedManoeuvre
    channel: str
    deviation: float
    largest: float
    least_rmse: float
    amplitude_ratio: float


def table_4_implications() -> tuple[Table4Implication, ...]:
    """Every cell: RMSE^2 = s^2 + s0^2 - 2 CC s s0 + (error of the mean)^2, s and s0 the standard deviations."""
    references = {run: reference_record(run) for run in TABLE_4}
    return tuple(_table_4_implication(run, c, references[run][c]) for run, said in TABLE_4.items() for c in said.cc)


def _table_4_implication(run: PublishedManoeuvre, channel: str, values: Array) -> Table4Implication:
    cc, deviation = TABLE_4[run].cc[channel], float(np.std(values))
    inner = cc**2 - 1.0 + (TABLE_4[run].rmse[channel] / deviation) ** 2
    amplitude = cc + math.sqrt(inner) if inner >= 0.0 else math.nan
    largest = float(np.max(np.abs(values)))
    return Table4Implication(run, channel, deviation, largest, deviation * math.sqrt(1.0 - cc**2), amplitude)
