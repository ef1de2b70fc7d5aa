"""Runs of the trials that a poster shows: their measures, corrected for the estimated current, and how exactly read."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from seatrial.core.values import InputError

if TYPE_CHECKING:
    from seatrial.core.results import Fit, Prediction
    from seatrial.core.results.poster import MeasuredRun, PosterQuantity
    from seatrial.core.results.prediction import EstimatedCurrent
    from seatrial.core.values import Record
    from seatrial.physics.manoeuvres import ObservedManoeuvre


@dataclass(frozen=True, eq=False)
class Reading:
    """A measured run and what is read from it.

    Attributes:
        current: estimated of its session; None: none, and distances are over ground.
        has_ground_velocity: whether u and v are over ground.
        length: of the ship, m; seed: of the draws of sensor noise.
    """

    measured: "Record"
    manoeuvre: "ObservedManoeuvre"
    current: "EstimatedCurrent | None"
    has_ground_velocity: bool
    length: float
    seed: int

    @property
    def run(self) -> "MeasuredRun":
        """The run's name and the speed of its current."""
        from seatrial.core.results.poster import MeasuredRun

        return MeasuredRun(self.measured.name, None if self.current is None else self.current.speed)

    @cached_property
    def values(self) -> dict[str, float]:
        """Measures of the run, corrected for the current."""
        return self._values_in(self.current)

    @cached_property
    def half_widths(self) -> dict[str, float]:
        """Half width of the 95 % interval of each: noise of the sensors, and standard error of the current."""
        import numpy as np

        from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
        from seatrial.estimation.predict.prediction_intervals import reading_errors
        from seatrial.physics.sensors.measured_outputs import without_current

        record = without_current(self.measured, self.current, self.has_ground_velocity)
        noise = reading_errors(record, self.length, np.random.default_rng(self.seed))
        level, shifts = two_sided_quantile(STORED_LEVEL, np.inf), self._shifts_of_the_current()
        return {name: level * float(np.hypot(error, shifts.get(name, 0.0))) for name, error in noise.items()}

    def _shifts_of_the_current(self) -> dict[str, float]:
        """What one standard error of the current changes of each measure, both components added in squares."""
        if self.current is None:
            return {}
        c = self.current
        north, east = (self._values_in(one) for one in
                       (replace(c, north=c.north + c.north_error), replace(c, east=c.east + c.east_error)))  # fmt: skip
        return {name: math.hypot(north.get(name, value) - value, east.get(name, value) - value)
                for name, value in self.values.items()}  # fmt: skip

    def _values_in(self, current: "EstimatedCurrent | None") -> dict[str, float]:
        from seatrial.physics.manoeuvres import measures
        from seatrial.physics.sensors.measured_outputs import without_current

        record = without_current(self.measured, current, self.has_ground_velocity)
        return measures(record, self.length, reference=self.manoeuvre)


def readings_of(fit: "Fit") -> tuple[Reading, ...]:
    """Return what is read from the measured runs of a fit, in order; of those with heading and rudder."""
    readings = (_reading(fit, p) for p in fit.predictions if not p.is_reference_simulated)
    return tuple(reading for reading in readings if reading is not None)


def measured_quantity(name: str, runs: Sequence[Reading]) -> "PosterQuantity | None":
    """Return the largest value that runs measured, the safe side of distances and overshoots; None: none shows it."""
    from seatrial.core.results.poster import Basis, PosterQuantity
    from seatrial.physics.manoeuvres import bounded_interval

    showing = [run for run in runs if name in run.values]
    if not showing:
        return None
    largest = max(showing, key=lambda one: one.values[name])
    value, repeats = largest.values[name], tuple(one.values[name] for one in showing)
    half = largest.half_widths.get(name)
    ends = None if half is None else bounded_interval(name, value, half)
    return PosterQuantity(
        name, value, *(ends or (None, None)), Basis.MEASURED, repeats=repeats if len(repeats) > 1 else ()
    )


def _reading(fit: "Fit", p: "Prediction") -> Reading | None:
    """None where the run has no heading, and neither a rudder nor thrusters that turn."""
    from seatrial.core.results.prediction import estimated_current
    from seatrial.physics.manoeuvres import ObservedManoeuvre
    from seatrial.physics.models.thruster_layout import layout_of, with_steering_order
    from seatrial.physics.sensors.measured_outputs import shows_ground_velocity

    measured = with_steering_order(p.measured, layout_of(fit.model)) if fit.model.has_thrusters else p.measured
    try:
        manoeuvre = ObservedManoeuvre.from_record(measured)
    except InputError:
        return None
    return Reading(
        measured, manoeuvre, estimated_current(p, fit.offsets), shows_ground_velocity(fit.model), fit.ship.length,
        fit.seed,
    )  # fmt: skip
