"""What a loop is tuned for: variances of what it does in a sea, its drive's work, and what crews make of them."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import cache

import numpy as np
from scipy.special import ndtr

from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import G

# What moving an actuator costs in a sea: reversals and energy of its drive, drag of its surfaces.

SECONDS_PER_HOUR = 3600.0  # s, by definition
SEA_WATER = 1025.0  # kg/m^3, ITTC 7.5-02-01-03 at 15 degrees, rounded


@dataclass(frozen=True)
class ActuatorDrive:
    """What turns the actuator: inertia about its stock [kg m^2], efficiency of the drive, 0 to 1."""

    inertia: float
    efficiency: float = 1.0

    def energy(self, rate_variance: float) -> float:
        """Return the energy [J] of a reversal, of a rate of that variance [rad^2/s^2].

        W = I var(rate) / eta (Yu et al. 2014, eq. (3)): between two reversals the drive brings the actuator to a peak
        rate, I peak^2 / 2, and the mean square of the peaks of a narrow band is twice its variance (Rayleigh).
        """
        return self.inertia * rate_variance / self.efficiency

    def hourly_energy(self, rates: Array, dt: float) -> float:
        """Return the energy [J] in an hour of rates (n,) [rad/s] every dt [s]: the work by which they grow.

        I rate^2 / 2 is given whenever the rate grows, from zero where it changes sign, and nothing comes back. Of a
        smooth swing that is I peak^2 / 2.
        """
        grown = rates[1:] ** 2 - np.where(np.signbit(rates[1:]) == np.signbit(rates[:-1]), rates[:-1] ** 2, 0.0)
        work = 0.5 * self.inertia * np.maximum(grown, 0.0).sum() / self.efficiency
        return float(work * SECONDS_PER_HOUR / (dt * len(rates)))


@dataclass(frozen=True)
class LiftingSurface:
    """Fins or rudders that are turned: their area together [m^2], effective aspect ratio (twice that at a hull).

    Lift and drag are those of an unswept surface by Whicker & Fehlner 1958, DTMB Report 933: C_L = slope times angle,
    slope 1.8 pi a / (1.8 + sqrt(a^2 + 4)), and C_D rises by C_L^2 / (0.9 pi a). The angle is that of the actuator.
    """

    area: float
    aspect_ratio: float

    def hourly_energy(self, angle_variance: float, U: float) -> float:
        """Return the energy [J] in an hour of the drag by angles of that variance [rad^2] at U [m/s], at the hull.

        The propulsion's losses come on top. Beyond stall the drag is larger.
        """
        return self._drag_factor * angle_variance * 0.5 * SEA_WATER * U**3 * self.area * SECONDS_PER_HOUR

    @property
    def _drag_factor(self) -> float:
        """Return C_D - C_D0 for each rad^2."""
        a = self.aspect_ratio
        slope = 1.8 * math.pi * a / (1.8 + math.sqrt(a**2 + 4.0))  # Whicker & Fehlner 1958, as above
        return slope**2 / (0.9 * math.pi * a)  # Oswald factor 0.9, Whicker & Fehlner 1958


def reversals_per_hour(rate_rms: float, acceleration_rms: float) -> float:
    """Return how often a Gaussian angle turns back in an hour: two a zero up-crossing of its rate (Rice 1945, Bell
    System Technical Journal 24, part III).
    """
    return 2.0 * SECONDS_PER_HOUR / (2.0 * math.pi) * acceleration_rms / rate_rms


# What a loop is tuned for: variances of what it does in a sea, and what crews make of them.


_LEAST_VARIANCE = 1e-300  # of an actuator at rest, by which nothing is divided: rounding


class LoopSignal(Enum):
    """Where a variance is taken."""

    OUTPUT = "output"
    ACTUATOR = "actuator"
    POINT = "point"


@dataclass(frozen=True)
class WeightedVariance:
    """The variance of an operator on a signal of the loop: `magnitude` is |W(j omega)| at omega [rad/s].

    x: m forward of the origin, of the point whose downward motion the signal is; other signals have none.
    """

    signal: LoopSignal
    magnitude: Callable[[Array], Array]
    x: float = 0.0


@dataclass(frozen=True)
class Objective:
    """A number to be made small, of one or more variances.

    Attributes:
        variances: the variances it is made of, r.
        value: variances (n, r) -> (n,); gradient: variances (n, r) -> derivatives (n, r).
    """

    name: str
    unit: str
    variances: tuple[WeightedVariance, ...]
    value: Callable[[Array], Array]
    gradient: Callable[[Array], Array]


@cache
def _frequency_power(n: int) -> Callable[[Array], Array]:
    return lambda omega: omega**n


def _first_variance(variances: Array) -> Array:
    return variances[:, 0]


def variance(name: str, unit: str, signal: LoopSignal, power: int = 0) -> Objective:
    """Return the variance of the output or the actuator (power 0), of its rate (1), of its acceleration (2)."""
    return Objective(name, unit, (WeightedVariance(signal, _frequency_power(power)),), _first_variance, np.ones_like)


ENERGY = "energy of the actuator in an hour"


def hourly_energy(drive: ActuatorDrive | None, surface: LiftingSurface | None, U: float) -> Objective:
    """Return the energy [J] in an hour that a Gaussian actuator takes at U [m/s], of drive and drag."""
    reversal = 0.0 if drive is None else SECONDS_PER_HOUR / math.pi * drive.energy(1.0)
    drag = 0.0 if surface is None else surface.hourly_energy(1.0, U)

    def value(v: Array) -> Array:
        # the drive: I var(rate) / eta a reversal, reversals by Rice 1945
        with np.errstate(invalid="ignore"):
            energy = drag * v[:, 0] + reversal * np.sqrt(v[:, 1] * v[:, 2])
        return np.where(np.isfinite(v[:, 0]), energy, np.inf)

    def slope(v: Array) -> Array:
        ratio = np.sqrt(v[:, 2] / np.maximum(v[:, 1], _LEAST_VARIANCE))
        by_acceleration = 0.5 * reversal / np.maximum(ratio, _LEAST_VARIANCE)
        return np.stack([np.full(len(v), drag), 0.5 * reversal * ratio, by_acceleration], axis=1)

    rows = tuple(WeightedVariance(LoopSignal.ACTUATOR, _frequency_power(power)) for power in (0, 1, 2))
    return Objective(ENERGY, "J", rows, value, slope)


def squared_deviation(name: str, signal: LoopSignal, target: float, *, one_sided: bool) -> Objective:
    """(variance - target)^2 [unit^4] (Yu et al. 2014, eq. (2)); one-sided: only what exceeds the target counts."""

    def miss(variances: Array) -> Array:
        off = variances - target
        return np.maximum(off, 0.0) if one_sided else off

    row = WeightedVariance(signal, _frequency_power(0))
    return Objective(name, "", (row,), lambda v: miss(v)[:, 0] ** 2, lambda v: 2.0 * miss(v))


def motion_interruptions(height: float, friction: float = 0.25) -> Objective:
    """Tips a minute of a person standing `height` [m] above the axis of roll (Graham 1990, Nav. Eng. J. 102(2), 65-71).

    The lateral force estimator of roll alone is (g + height omega^2) phi; it exceeds `friction` g, the half stance over
    the height of the centre of gravity, on either side at the rate of Rice (1945) for a Gaussian process:
    60 / pi sqrt(v_2 / v_0) exp(-(friction g)^2 / (2 v_0)).
    """

    def lateral(omega: Array) -> Array:
        return G + height * omega**2

    def value(v: Array) -> Array:
        with np.errstate(invalid="ignore"):
            # 60 s a minute
            # crossings a minute of a narrow band, Rice 1945
            made = 60.0 / math.pi * np.sqrt(v[:, 1] / v[:, 0]) * np.exp(-((friction * G) ** 2) / (2.0 * v[:, 0]))
        return np.where(np.isfinite(v[:, 0]), made, np.inf)

    def slope(v: Array) -> Array:
        rate = value(v)
        by_first = rate * ((friction * G) ** 2 / (2.0 * v[:, 0] ** 2) - 0.5 / v[:, 0])
        return np.stack([by_first, 0.5 * rate / v[:, 1]], axis=1)

    rows = (WeightedVariance(LoopSignal.OUTPUT, lateral), WeightedVariance(LoopSignal.OUTPUT, lambda w: w * lateral(w)))
    return Objective("motion interruptions", "1/min", rows, value, slope)


def vertical_acceleration(x: float) -> Objective:
    """Return the variance of the vertical acceleration x metres forward of the origin, of heave and pitch."""
    row = WeightedVariance(LoopSignal.POINT, _frequency_power(2), x)
    return Objective(
        f"variance of the vertical acceleration at {x:g} m", "m^2/s^4", (row,), _first_variance, np.ones_like
    )


def motion_sickness_dose(x: float, duration: float) -> Objective:
    """Return the motion sickness dose value [m/s^1.5] of so many seconds at x [m]: sqrt(duration times the variance of
    the vertical acceleration weighted by W_f) (ISO 2631-1:1997, section 9; a third of it in per cent vomits).
    """
    row = WeightedVariance(LoopSignal.POINT, _weighted_acceleration, x)

    def value(v: Array) -> Array:
        return np.sqrt(duration * v[:, 0])

    def slope(v: Array) -> Array:
        return 0.5 * duration / value(v)[:, None]

    return Objective(f"motion sickness dose value at {x:g} m", "m/s^1.5", (row,), value, slope)


def motion_sickness_weighting(omega: Array) -> Array:
    """Return |W_f| at omega [rad/s] (ISO 2631-1:1997, annex A: band limits, transition and step by their f and Q)."""
    s, (f1, f2, f4, f5, f6) = 1j * omega, 2.0 * math.pi * np.array([0.08, 0.63, 0.25, 0.0625, 0.1])  # Hz, as printed
    Q4, Q5, Q6 = 0.86, 0.80, 0.80  # quality factors, as printed
    root = math.sqrt(2.0)
    limits = s**2 / (s**2 + root * f1 * s + f1**2) * f2**2 / (s**2 + root * f2 * s + f2**2)
    transition = f4**2 / (s**2 + f4 / Q4 * s + f4**2)
    step = (s**2 + f5 / Q5 * s + f5**2) / (s**2 + f6 / Q6 * s + f6**2)
    return np.abs(limits * transition * step)


def _weighted_acceleration(omega: Array) -> Array:
    return motion_sickness_weighting(omega) * omega**2


def motion_sickness_at(x: float) -> Objective:
    """Return the share of people sick within two hours x metres forward of the origin, of heave and pitch."""
    rows = tuple(WeightedVariance(LoopSignal.POINT, _frequency_power(power), x) for power in (1, 2))
    return _sickness(f"motion sickness at {x:g} m", rows)


def motion_sickness(lever: float) -> Objective:
    """Return the share of people sick within two hours, `lever` [m] off the axis: of the output alone."""
    rows = (
        WeightedVariance(LoopSignal.OUTPUT, lambda w: abs(lever) * w),
        WeightedVariance(LoopSignal.OUTPUT, lambda w: abs(lever) * w**2),
    )
    return _sickness("motion sickness", rows)


def _sickness(name: str, rows: tuple[WeightedVariance, ...]) -> Objective:
    """Return the share of people sick, of variances of vertical velocity and acceleration.

    O'Hanlon & McCauley 1974 as in `sea.wave_forces`: Phi((log10(0.798 sqrt(v_4) / g) - mu) / 0.4),
    mu = -0.819 + 2.32 log10(omega)^2, omega = sqrt(v_4 / v_2).
    """

    def score(v: Array) -> tuple[Array, Array]:
        ratio = 0.5 * np.log10(v[:, 1] / v[:, 0])
        return (np.log10(0.798 * np.sqrt(v[:, 1]) / G) + 0.819 - 2.32 * ratio**2) / 0.4, ratio  # constants as above

    def value(v: Array) -> Array:
        with np.errstate(invalid="ignore"):
            made = ndtr(score(v)[0])
        return np.where(np.isfinite(v[:, 0]), made, np.inf)

    def slope(v: Array) -> Array:
        z, ratio = score(v)
        density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi) / 0.4  # normal density; 0.4 as in `sea.wave_forces`
        half = 0.5 / math.log(10.0)
        by_first = density * 2.32 * 2.0 * ratio * half / v[:, 0]  # 2.32 as above
        by_second = density * (1.0 - 2.32 * 2.0 * ratio) * half / v[:, 1]  # 2.32 as above
        return np.stack([by_first, by_second], axis=1)

    return Objective(name, "1", rows, value, slope)
