"""A straight track kept in each disturbance: linear theory, simulated without limits and with those of the rudder."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.control.disturbance_simulation import (
    LEAST_FREQUENCY,
    SEEDS,
    DisturbanceClock,
    actuator_rate,
    disturbance_clock,
    disturbance_realisation,
    named_signals,
)
from seatrial.control.task import Seaway, SlowDisturbance
from seatrial.control.track.linear_ship import DISTURBANCE, linear_ship
from seatrial.control.track.paths import CURRENT, EAST, HeadingLoop, Reach
from seatrial.core.results.tuning import DisturbanceSimulation
from seatrial.core.values import Array, DivergedError
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import TransferLoop
from seatrial.physics.simulate.closed_loop import UNLIMITED, ActuatorLimits, ClosedLoop
from seatrial.physics.simulate.craft_control import LineOfSight, follow_track

_YAW_RATE = "r"  # state whose rate the waves' yaw acceleration is


@dataclass(frozen=True, eq=False)
class TrackTrial:
    """What a track is tried with: the heading loop, the outer loop at its gains, guidance and limits."""

    heading: HeadingLoop
    outer: TransferLoop
    guidance: LineOfSight
    limits: ActuatorLimits

    def simulate(self, met: Seaway | SlowDisturbance, seed: int) -> DisturbanceSimulation:
        """Return rms of distance, rudder and its rate in one disturbance of the outer loop."""
        loop = met.disturbed(self.outer)
        clock, disturbed = disturbance_clock(met, loop, self.heading.loop), self._disturbed_state(met)
        ship = self.heading.ship
        run = ClosedLoop(
            linear_ship(ship, disturbed), self.heading.loop, self.heading.loop.gain_values, clock.dt, ship.actuator,
            DISTURBANCE, ship.output,
        )  # fmt: skip

        expected = self.predicted(met)

        def counted(omega: Array) -> Array:
            return np.hypot(
                *(np.abs(one) / rms for one, rms in zip(self._responses(met, omega), expected, strict=False))
            )

        def of_one(number: int) -> Array:
            series = disturbance_realisation(met, loop, clock, number, counted)
            return np.stack([self._mean_squares(run, series, clock, each) for each in (UNLIMITED, self.limits)])

        free, held = np.stack(map_in_threads(of_one, [seed + k for k in range(SEEDS)]), axis=1)
        rms = np.sqrt(free.mean(axis=0))
        error = free.std(axis=0, ddof=1) / math.sqrt(SEEDS) / (2.0 * rms)
        columns = (expected, rms, np.sqrt(held.mean(axis=0)), error)
        return DisturbanceSimulation(met.description, SEEDS, *(named_signals(column) for column in columns))

    def predicted(self, met: Seaway | SlowDisturbance) -> Array:
        """Return the rms of distance, rudder and its rate by linear theory, (3,)."""
        spectrum = met.exposure(met.disturbed(self.outer))
        w = spectrum.omega_e
        distance, rudder = (np.abs(one) ** 2 * spectrum.energy for one in self._responses(met, w))
        return np.sqrt([distance.sum(), rudder.sum(), (w**2 * rudder).sum()])

    def _responses(self, met: Seaway | SlowDisturbance, omega: Array) -> tuple[Complex, Complex]:
        """Return distance and rudder for a unit of the disturbance, each (n,), at omega (n,) [rad/s]."""
        loop, w = met.disturbed(self.outer), np.maximum(omega, LEAST_FREQUENCY)
        guidance = loop.gain_values @ loop.controller_terms(w)
        distance = loop.disturbance.frequency_response(w) / (1.0 + loop.open_loop(w))
        return distance, self.heading.rudder_response(self._reach(met), guidance, w)

    def _reach(self, met: Seaway | SlowDisturbance) -> Reach:
        if isinstance(met, Seaway):
            return self.heading.waves
        return CURRENT if met.path == CURRENT.track else self.heading.rudder

    def _disturbed_state(self, met: Seaway | SlowDisturbance) -> str:
        if isinstance(met, Seaway):
            return _YAW_RATE
        return EAST if met.path == CURRENT.track else self.heading.ship.actuator

    def _mean_squares(self, run: ClosedLoop, series: Array, clock: DisturbanceClock, limits: ActuatorLimits) -> Array:
        """Return mean squares of distance, rudder and its rate, (3,); infinite where the limits let the craft go."""
        try:
            made = follow_track(run, self.guidance, series, limits=limits)
        except DivergedError:
            return np.full(3, np.inf)
        rate = actuator_rate(run, made.actuator[clock.first :])
        return np.array([float(np.mean(x**2)) for x in (made.error[clock.first :], made.actuator[clock.first :], rate)])
