"""What an identified roll model says in the field's terms: period, damping, metacentric height, each with its range."""

from dataclasses import dataclass


@dataclass(frozen=True)
class IntervalEstimate:
    """A derived value with its 95 % interval, SI."""

    value: float
    lower: float
    upper: float

    def scaled(self, factor: float) -> "IntervalEstimate":
        """In another unit, or at another scale."""
        return IntervalEstimate(factor * self.value, factor * self.lower, factor * self.upper)


@dataclass(frozen=True)
class RollCharacteristics:
    """Roll as it follows from the coefficients, at rest and over the amplitude of a swing.

    Attributes:
        natural_period: s, at small angles; damping_ratio: b_1 over the critical 2 sqrt(c_1).
        gyradius: m, in roll with the added inertia in it, as it was assumed; assumed: in words.
        metacentric_height: m; its range is the coefficients' interval and the whole range of the gyradius.
        amplitude: rad, up to the largest recorded.
        damping: equivalent linear damping b_e, 1/s, over amplitude, with its band; period: s, likewise.
        swings: amplitude [rad], logarithmic damping [1/s] and period [s] of each recorded swing, without any model;
            empty where something drove her.
        spectrum: in waves that nobody measured: frequency [rad/s], recorded (smoothed) and expected density of roll
            [rad^2 s/rad]; curves over amplitude are empty then.
    """

    natural_period: IntervalEstimate
    damping_ratio: IntervalEstimate
    gyradius: IntervalEstimate | None
    gyradius_source: str
    metacentric_height: IntervalEstimate | None
    amplitude: tuple[float, ...]
    damping: tuple[float, ...]
    damping_lower: tuple[float, ...]
    damping_upper: tuple[float, ...]
    period: tuple[float, ...]
    period_lower: tuple[float, ...]
    period_upper: tuple[float, ...]
    swings: tuple[tuple[float, float, float], ...] = ()
    spectrum: tuple[tuple[float, float, float], ...] = ()
