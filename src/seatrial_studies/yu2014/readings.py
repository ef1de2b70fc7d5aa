"""The published loop in both readings, in the seas of table 1, and the paper's objectives."""

import math
from dataclasses import dataclass
from enum import Enum
from functools import cache

import numpy as np
from scipy.optimize import brentq

from seatrial.core.values import Array
from seatrial.physics.loops import Exposure, HullFactor, Performance, Seen, TransferLoop, exposure
from seatrial.physics.loops.fin import ROLL, K_alpha_at, Preamplifier, fin_loop
from seatrial.physics.loops.objective import Objective, off_target, variance
from seatrial.physics.loops.performance import rows_of
from seatrial.physics.sea.spectrum import Spectrum, ittc
from seatrial_studies.yu2014.published import FOUND, HEIGHT, SET_AT, TARGET

HULL = HullFactor(100.0, 10.5, 3.4)
KNOT = 1852.0 / 3600.0
WORDS = {Preamplifier.PRINTED: "as printed", Preamplifier.WASHOUT: "washout"}


class Fins(Enum):
    """What J2 makes of fin angles below the target."""

    PRINTED = "J2 as printed"
    ONE_SIDED = "J2 one-sided"


def objectives_of(fins: Fins) -> tuple[Objective, Objective, Objective]:
    """J1 = var(phi), J2 = (var(alpha) - target)^2, J3 = W without I / eta, which cancel (eqs. (2) to (4))."""
    return (
        variance("J1", "rad^2", Seen.OUTPUT),
        off_target("J2", Seen.ACTUATOR, TARGET, one_sided=fins is Fins.ONE_SIDED),
        variance("J3", "rad^2/s^2", Seen.ACTUATOR, 1),
    )


ROWS, _PLACES = rows_of(objectives_of(Fins.PRINTED))


def objectives(variances: Array, fins: Fins) -> Array:
    """J1, J2, J3 (m, 3) of variances (m, 3): roll, fin angle, fin rate; infinite where unstable."""
    made = [of.value(variances[:, place]) for of, place in zip(objectives_of(fins), _PLACES, strict=True)]
    return np.stack(made, axis=1)


@dataclass(frozen=True)
class Sea:
    """What the ship meets.

    Attributes:
        speed: kn; heading: deg, 0 following; spectrum: none for the paper's height; spreading: of cos^2s, none
            long-crested; name: for tables.
    """

    speed: float = SET_AT.speed
    heading: float = SET_AT.heading
    spectrum: Spectrum | None = None
    spreading: float | None = None
    name: str = ""


SETTING = Sea()


@cache
def met(sea: Sea) -> Exposure:
    """The effective wave slope."""
    spectrum = sea.spectrum or ittc(HEIGHT)
    return exposure(spectrum, sea.speed * KNOT, math.radians(sea.heading), ROLL, HULL, spreading=sea.spreading)


@dataclass(frozen=True)
class Motion:
    """Of a loop in a sea: rms roll and fin angle [deg], fin rate [deg/s], roll without fins [deg], Ms."""

    roll: float
    fin: float
    rate: float
    free: float
    peak: float

    @property
    def reduction(self) -> float:
        """Of the rms roll, per cent."""
        return 100.0 * (1.0 - self.roll / self.free)

    @property
    def saturated(self) -> float:
        """Probability that a fin amplitude exceeds 22 deg, per cent (Rayleigh, as section 2.2)."""
        return 100.0 * math.exp(-(22.0**2) / (2.0 * self.fin**2))


def loop(reading: Preamplifier, speed: float, K_q: float) -> TransferLoop:
    """At a speed [kn]; K_alpha grows with its square from 18 kn."""
    return fin_loop(reading, K_q=K_q, K_alpha=K_alpha_at(speed, SET_AT.speed))


def performance(reading: Preamplifier, sea: Sea = SETTING, K_q: float | None = None) -> Performance:
    """K_q: calibrated unless given."""
    made = loop(reading, sea.speed, calibrated(reading) if K_q is None else K_q)
    return Performance(made, met(sea), ROWS)


def motion(of: Performance, gains: Array = FOUND) -> Motion:
    """At some gains (g,)."""
    found = of.of(gains)
    roll, fin, rate = np.degrees(np.sqrt(found.variances[0]))
    return Motion(
        float(roll), float(fin), float(rate), math.degrees(math.sqrt(of.uncontrolled[0])), float(found.peak[0])
    )


@cache
def calibrated(reading: Preamplifier) -> float:
    """K_q at which the paper's gains reduce the roll as table 1 says where they were set; fitted, not published."""

    def off(log_K: float) -> float:
        return motion(performance(reading, SETTING, math.exp(log_K))).reduction - SET_AT.genetic.reduction

    about = math.log(reading.value)
    return math.exp(float(brentq(off, about - 0.3, about + 0.3, xtol=1e-12)))  # type: ignore[arg-type]
