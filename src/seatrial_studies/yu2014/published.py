"""What Yu et al. 2014 print, and their loop in both readings with the regulators it has."""

import math
from dataclasses import dataclass
from enum import Enum
from functools import cache

import numpy as np
from scipy.optimize import brentq

from seatrial.core.values import Array
from seatrial.physics.loops import (
    EncounterSpectrum,
    HullFactor,
    K_alpha_at,
    LoopSignal,
    Objective,
    Performance,
    Preamplifier,
    TransferLoop,
    distinct_variances,
    fin_loop,
    sea_disturbance,
    squared_deviation,
    variance,
)
from seatrial.physics.sea import Spectrum, ittc
from seatrial_studies.study_file import Declared, read_study

# What Yu et al. 2014 print: table 1, the searched box, what they say of it, and what they leave open.

SOURCE = read_study("yu2014").source


@dataclass(frozen=True)
class ControllerResult:
    """One controller's numbers of a row: roll [deg], fin rate [deg/s], reduction of the roll [%]."""

    roll: float
    rate: float
    reduction: float

    @property
    def uncontrolled(self) -> float:
        """Return the roll without fins [deg] that the other two imply."""
        return self.roll / (1.0 - 0.01 * self.reduction)

    @property
    def uncontrolled_bounds(self) -> tuple[float, float]:
        """What rounding to the printed digits leaves open of it."""
        low = (self.roll - 0.005) / (1.0 - 0.01 * (self.reduction - 0.005))
        return low, (self.roll + 0.005) / (1.0 - 0.01 * (self.reduction + 0.005))

    @property
    def log_values(self) -> Array:
        """Return logarithms of roll, fin rate and what is left of the roll, (3,)."""
        return np.log([self.roll, self.rate, 1.0 - 0.01 * self.reduction])


@dataclass(frozen=True)
class Table1Row:
    """One row of table 1: speed [kn], heading to the waves [deg], both controllers."""

    speed: float
    heading: float
    traditional: ControllerResult
    genetic: ControllerResult

    @property
    def name(self) -> str:
        """Return the name of the row as in the table."""
        return f"{self.speed:.0f} / {self.heading:.0f}"


class PublishedNumbers(Declared):
    """What the study file quotes: the search, the fin, the records, table 1; units stand there."""

    height: float
    fin_limit: float
    saturation: float
    target_deg2: float
    inertia: float
    span: float
    aspect: float
    thickness: float
    density: float
    chord: float
    chord_of_lever: float
    record_seconds: float
    step: float
    table_1: tuple[Table1Row, ...]


PUBLISHED = PublishedNumbers.model_validate(read_study("yu2014").published)
TABLE_1 = PUBLISHED.table_1
DESIGN_ROW, DESIGN_ROW_AT_22_KN = TABLE_1[1], TABLE_1[4]

PUBLISHED_LOOP = fin_loop()
GAIN_NAMES = PUBLISHED_LOOP.gains.names
PUBLISHED_VALUES = PUBLISHED_LOOP.gain_values
LOWER, UPPER = (np.array(ends) for ends in zip(*((p.lower, p.upper) for p in PUBLISHED_LOOP.gains), strict=True))
TARGET = math.radians(1.0) ** 2 * PUBLISHED.target_deg2


# The published loop in both readings, in the seas of table 1, and the paper's objectives.

HULL_FACTOR = HullFactor(100.0, 10.5, 3.4)
# m/s, by definition
KNOT = 1852.0 / 3600.0
PREAMPLIFIER_LABELS = {Preamplifier.PRINTED: "as printed", Preamplifier.WASHOUT: "washout"}


class FinObjective(Enum):
    """What J2 makes of fin angles below the target."""

    PRINTED = "J2 as printed"
    ONE_SIDED = "J2 one-sided"


def paper_objectives(fin_objective: FinObjective) -> tuple[Objective, Objective, Objective]:
    """J1 = var(phi), J2 = (var(alpha) - target)^2, J3 = W without I / eta, which cancel (eqs. (2) to (4))."""
    return (
        variance("J1", "rad^2", LoopSignal.OUTPUT),
        squared_deviation("J2", LoopSignal.ACTUATOR, TARGET, one_sided=fin_objective is FinObjective.ONE_SIDED),
        variance("J3", "rad^2/s^2", LoopSignal.ACTUATOR, 1),
    )


VARIANCE_ROWS, _OBJECTIVE_COLUMNS = distinct_variances(paper_objectives(FinObjective.PRINTED))


def objective_values(variances: Array, fin_objective: FinObjective) -> Array:
    """J1, J2, J3 (m, 3) of variances (m, 3): roll, fin angle, fin rate; infinite where unstable."""
    made = [
        of.value(variances[:, place])
        for of, place in zip(paper_objectives(fin_objective), _OBJECTIVE_COLUMNS, strict=True)
    ]
    return np.stack(made, axis=1)


@dataclass(frozen=True)
class SeaCondition:
    """What the ship meets.

    Attributes:
        speed: kn; heading: deg, 0 following; spectrum: none for the paper's height; spreading: of cos^2s, none
            long-crested; name: for tables.
    """

    speed: float = DESIGN_ROW.speed
    heading: float = DESIGN_ROW.heading
    spectrum: Spectrum | None = None
    spreading: float | None = None
    name: str = ""


DESIGN_SEA = SeaCondition()


@cache
def effective_slope(sea: SeaCondition) -> EncounterSpectrum:
    """Return the effective wave slope."""
    spectrum = sea.spectrum or ittc(PUBLISHED.height)
    return sea_disturbance(
        spectrum,
        sea.speed * KNOT,
        math.radians(sea.heading),
        PUBLISHED_LOOP.disturbance,
        HULL_FACTOR,
        spreading=sea.spreading,
    )


@dataclass(frozen=True)
class RollResponse:
    """Of a loop in a sea: rms roll and fin angle [deg], fin rate [deg/s], roll without fins [deg], Ms."""

    roll: float
    fin: float
    rate: float
    uncontrolled: float
    Ms: float

    @property
    def reduction(self) -> float:
        """Return the reduction of the rms roll [%]."""
        return 100.0 * (1.0 - self.roll / self.uncontrolled)

    @property
    def saturation_percent(self) -> float:
        """Return the probability that a fin amplitude exceeds 22 deg, per cent (Rayleigh, as section 2.2)."""
        return 100.0 * math.exp(-(22.0**2) / (2.0 * self.fin**2))


def stabiliser_loop(preamplifier: Preamplifier, speed: float, K_q: float) -> TransferLoop:
    """At a speed [kn]; K_alpha grows with its square from 18 kn."""
    return fin_loop(preamplifier, K_q=K_q, K_alpha=K_alpha_at(speed, DESIGN_ROW.speed))


def performance(preamplifier: Preamplifier, sea: SeaCondition = DESIGN_SEA, K_q: float | None = None) -> Performance:
    """K_q: calibrated unless given."""
    made = stabiliser_loop(preamplifier, sea.speed, calibrated_K_q(preamplifier) if K_q is None else K_q)
    return Performance(made, effective_slope(sea), VARIANCE_ROWS)


def roll_response(loop_performance: Performance, gains: Array = PUBLISHED_VALUES) -> RollResponse:
    """Return the roll response at the gains (g,)."""
    found = loop_performance.evaluate(gains)
    roll, fin, rate = np.degrees(np.sqrt(found.variances[0]))
    return RollResponse(
        float(roll),
        float(fin),
        float(rate),
        math.degrees(math.sqrt(loop_performance.uncontrolled_variances[0])),
        float(found.Ms[0]),
    )


@cache
def calibrated_K_q(preamplifier: Preamplifier) -> float:
    """K_q at which the paper's gains reduce the roll as table 1 says where they were set; fitted, not published."""

    def excess_reduction(log_K: float) -> float:
        return (
            roll_response(performance(preamplifier, DESIGN_SEA, math.exp(log_K))).reduction
            - DESIGN_ROW.genetic.reduction
        )

    about = math.log(preamplifier.value)
    return math.exp(float(brentq(excess_reduction, about - 0.3, about + 0.3, xtol=1e-12)))  # type: ignore[arg-type]


# The regulators of section 1, which the paper sets to 1: what they would be if they did what their names say.

SPEEDS, HEIGHTS = (14.0, 18.0, 22.0), (2.0, 3.3, 4.5)  # kn, m; our choice, about the table's
_LEAST_GAIN, _MOST_GAIN = 1e-3, 1e2  # range of the sea regulator's factor; beyond it none is given


def speed_regulator(speed: float) -> float:
    """Return Gl at a speed [kn]: (U_0 / U)^2 keeps the loop gain where lift grows with the square of the speed."""
    return (DESIGN_ROW.speed / speed) ** 2


def sea_regulator(preamplifier: Preamplifier, height: float, speed: float = DESIGN_ROW.speed) -> float:
    """Return Gh at a significant height [m]: the factor on all gains at which the fin variance meets the target of J2.

    Beam sea; 1 is the largest value given, where the published gains keep the target; NaN where no factor keeps it.
    """
    of = performance(preamplifier, SeaCondition(speed, spectrum=ittc(height)))

    def excess(factor: float) -> float:
        fin = float(of.evaluate(factor * speed_regulator(speed) * PUBLISHED_VALUES, with_Ms=False).variances[0, 1])
        return np.log(fin / TARGET) if np.isfinite(fin) else 1.0

    if excess(1.0) <= 0.0:
        return 1.0
    return float(brentq(excess, _LEAST_GAIN, 1.0)) if excess(_LEAST_GAIN) < 0.0 else float("nan")  # type: ignore[arg-type]


@dataclass(frozen=True)
class RegulatorSetting:
    """Both regulators in one condition: values, reduction [%], fin rms [deg] and Ms with them, and without them."""

    speed: float
    height: float
    Gl: float
    Gh: float
    reductions: tuple[float, float]
    fins: tuple[float, float]
    Ms: tuple[float, float]


def regulator_settings(preamplifier: Preamplifier) -> tuple[RegulatorSetting, ...]:
    """Return both regulators over speeds and heights, beam sea."""
    return tuple(_setting(preamplifier, speed, height) for speed in SPEEDS for height in HEIGHTS)


def _setting(preamplifier: Preamplifier, speed: float, height: float) -> RegulatorSetting:
    of = performance(preamplifier, SeaCondition(speed, spectrum=ittc(height)))
    Gl, Gh = speed_regulator(speed), sea_regulator(preamplifier, height, speed)
    with_them, without = (roll_response(of, factor * PUBLISHED_VALUES) for factor in (Gl * Gh, 1.0))
    return RegulatorSetting(
        speed, height, Gl, Gh, (with_them.reduction, without.reduction), (with_them.fin, without.fin),
        (with_them.Ms, without.Ms),
    )  # fmt: skip
