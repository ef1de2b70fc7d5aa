"""The published loop in both readings, in the seas of table 1, and the paper's objectives."""

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
from seatrial_studies.yu2014.published import DESIGN_ROW, HEIGHT, PUBLISHED_LOOP, PUBLISHED_VALUES, TARGET

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
    spectrum = sea.spectrum or ittc(HEIGHT)
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
