"""Tracks to be kept: legs, corners, and the distance that a craft leaves them by."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from seatrial.control.ship import draw_parameters, plant_and_disturbance, rate_response
from seatrial.control.task import TrackDemand, TrimmedShip
from seatrial.core.results.tuning import CornerResponse
from seatrial.core.values import Array, Channel, DivergedError, InputError, Record, frozen
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.simulate.closed_loop import ActuatorLimits, ClosedLoop, fastest_motion, simulation_step
from seatrial.physics.simulate.craft_control import LineOfSight, PlannedTrack, TrackRun, follow_track
from seatrial.physics.simulate.replay import series_record

# How rudder, heading order, waves and current reach heading and track of a craft with a heading loop, linearised.

EAST = "y0"
"""State that is the distance to starboard of a track to the north."""


@dataclass(frozen=True)
class Reach:
    """Transfer functions of one thing to the heading and to the distance from the track, without any control."""

    heading: Block
    track: Block


CURRENT = Reach(Block("current to psi", (0.0,)), Block("current to y0", (1.0,), (1.0, 0.0)))
"""A current across the track [m/s]: it carries the craft away and leaves its heading."""


@dataclass(frozen=True, eq=False)
class HeadingLoop:
    """A craft with the heading loop that its rudder is in, at that loop's own gains."""

    ship: TrimmedShip
    loop: TransferLoop

    @cached_property
    def rudder(self) -> Reach:
        """What the rudder does."""
        return Reach(self.loop.plant, plant_and_disturbance(replace(self.ship, output=EAST))[0])

    @cached_property
    def waves(self) -> Reach:
        """What a yaw acceleration [rad/s^2] does."""
        return Reach(rate_response(self.ship, "r"), rate_response(replace(self.ship, output=EAST), "r"))

    @cached_property
    def _controller(self) -> tuple[Array, Array]:
        """Numerator and denominator of the controller from the heading error to the rudder."""
        return replace(self.loop.continuous, plant=Block("none")).fraction(self.loop.gain_values)

    @cached_property
    def _characteristic(self) -> Array:
        """d k + a n of the heading loop with the controller n / k."""
        n, k = self._controller
        plant = self.rudder.heading
        return np.asarray(np.polyadd(np.polymul(plant.den, k), np.polymul(plant.num, n)), dtype=np.float64)

    def order_to_track(self) -> Block:
        """Return what the heading order does to the distance from the track, b n / (s (d k + a n))."""
        n, _ = self._controller
        b = _over(self.rudder.track, self.rudder.heading)
        num, den = np.polymul(b, n), np.polymul(self._characteristic, [1.0, 0.0])
        return _block("heading order to y0", num, den)

    def disturbance_to_track(self, reach: Reach) -> Block:
        """Return what a disturbance does to the distance from the track, the heading kept at its order.

        With g / d to the heading and h / (d s) to the track: (h (d k + a n) - b n g) / (d s (d k + a n)). The model's
        own poles d cancel exactly, which they must where it is unstable by itself.
        """
        if reach == CURRENT:
            return CURRENT.track
        n, _ = self._controller
        b, h = _over(self.rudder.track, self.rudder.heading), _over(reach.track, self.rudder.heading)
        g = np.array(reach.heading.num) * (self.rudder.heading.den[0] / reach.heading.den[0])
        num = np.polysub(np.polymul(h, self._characteristic), np.polymul(np.polymul(b, n), g))
        reduced, rest = np.polydiv(num, self.rudder.heading.den)
        if np.abs(rest).max(initial=0.0) > _REST * np.abs(num).max():
            raise InputError(
                f"'{reach.heading.name}' reaches states of model '{self.ship.model.name}' that its rudder does not: a "
                "track cannot be tuned in it; leave that disturbance out"
            )
        return _block(f"{reach.track.name}, heading kept", reduced, np.polymul(self._characteristic, [1.0, 0.0]))

    def rudder_response(self, reach: Reach, guidance: Complex, omega: Array) -> Complex:
        """Return rudder for a unit of a disturbance with psi_d = -guidance y, (n,), at omega (n,) [rad/s]."""
        K = self.loop.gain_values @ self.loop.continuous.controller_terms(omega)
        P, G = ((way.heading.frequency_response(omega), way.track.frequency_response(omega))
                for way in (self.rudder, reach))  # fmt: skip
        return -K * (G[0] + guidance * G[1]) / (1.0 + K * (P[0] + guidance * P[1]))


_REST = 1e-6  # of the largest coefficient, below which the rest of a division is rounding; chosen


def _over(track: Block, heading: Block) -> Array:
    """Return b of track = b / (d s), d the heading's denominator.

    Raises:
        InputError: the denominators are of other kinds.
    """
    common = np.polymul(heading.den, [1.0, 0.0]) / heading.den[0]
    if len(track.den) != len(common) or not np.allclose(np.array(track.den) / track.den[0], common, rtol=_REST):
        raise InputError(
            f"'{track.name}' and '{heading.name}' do not belong to one craft: the distance from a track is to be the "
            "integral of what heading and sway make of it; take a model with heading and position"
        )
    return np.array(track.num) * (heading.den[0] / track.den[0])


def _block(name: str, num: ArrayLike, den: ArrayLike) -> Block:
    """Return num / den with a leading 1 below."""
    above, below = np.asarray(num, dtype=np.float64), np.asarray(den, dtype=np.float64)
    return Block(name, tuple((above / below[0]).tolist()), tuple((below / below[0]).tolist()))


# A corner of a track, taken by the nonlinear model within its limits in a steady current, and by ships of the fit.

# time constants Delta / U of the track before and after the corner; chosen
_BEFORE, _AFTER = 8.0, 20.0
_STEP_SHARE, _MOST_STEPS = 0.1, 40_000  # of the fastest pole's time constant, of a step; steps at most; chosen
_LAST_PART = 0.25  # of a run, in which a track that is kept stays within the acceptance; chosen
_SAMPLES = 1000  # of the record that is kept; chosen
ERROR, CURRENT_NORTH, CURRENT_EAST = "cross_track_error", "current_north", "current_east"


@dataclass(frozen=True, eq=False)
class CornerTrial:
    """How a corner is taken: the heading loop, guidance, limits, the demand, and the craft's speed U [m/s]."""

    heading: HeadingLoop
    guidance: LineOfSight
    limits: ActuatorLimits
    demand: TrackDemand
    U: float

    def respond(self, outer: TransferLoop, draws: int, seed: int) -> CornerResponse:
        """Return the corner by the identified craft and the worst of those drawn.

        A craft drawn keeps the track where its linear loop is stable and it settles on the new leg in simulation; one
        without a trim does not.
        """
        track = self._track
        nominal = self._run(self.heading.ship, track)
        sample = draw_parameters(self.heading.ship, draws, seed)
        runs = [self._run_of(ship, track) for ship in sample.ships if self._is_stable(ship, outer)]
        kept = [run is not None and self.is_kept(run) for run in runs]
        worst = [math.inf if run is None else self._overshoot(run) for run in runs]
        return CornerResponse(
            turn=self.demand.turn,
            acceptance=self.demand.acceptance,
            current=self.demand.current,
            record=self._record(nominal, track),
            overshoot=self._overshoot(nominal),
            worst_overshoot=max(worst, default=math.nan),
            stable_draws=sum(kept),
            draws=sample.draws,
            is_kept=self.is_kept(nominal),
        )

    @property
    def _track(self) -> PlannedTrack:
        return PlannedTrack(_BEFORE * self._time * self.U, self.demand.turn, self.demand.acceptance)

    def settles(self) -> bool:
        """Return whether the identified craft settles on the new leg."""
        return self.is_kept(self._run(self.heading.ship, self._track))

    def is_kept(self, run: TrackRun) -> bool:
        """Return whether a craft stays within the circle of acceptance in the last part of a run, on the new leg."""
        last = run.error[round((1.0 - _LAST_PART) * len(run.error)) :]
        return run.new_leg < len(run.error) - len(last) and bool(np.max(np.abs(last)) <= self.demand.acceptance)

    @property
    def _time(self) -> float:
        return self.guidance.lookahead / self.U

    @property
    def _step(self) -> float:
        loop = self.heading.loop
        longest = max(_STEP_SHARE / fastest_motion(loop), (_BEFORE + _AFTER) * self._time / _MOST_STEPS)
        return simulation_step(loop.required_sampling, longest)

    def _run(self, ship: TrimmedShip, track: PlannedTrack) -> TrackRun:
        """Return the run of a craft that a steady current sets towards the outside of the turn."""
        outward = -math.copysign(self.demand.current, track.turn)
        set_to = {CURRENT_NORTH: -outward * math.sin(track.turn), CURRENT_EAST: outward * math.cos(track.turn)}
        model = ship.model.with_values({name: v for name, v in set_to.items() if name in ship.model.parameters})
        loop, dt = self.heading.loop, self._step
        closed = ClosedLoop(model, loop, loop.gain_values, dt, ship.actuator, "", ship.output, ship.state, ship.inputs)
        count = math.ceil((_BEFORE + _AFTER) * self._time / dt)
        return follow_track(closed, self.guidance, np.zeros(count), track, self.limits)

    def _overshoot(self, run: TrackRun) -> float:
        """Return how far [m] the craft goes beyond the new leg, to the outside."""
        return max(0.0, float(np.max(-math.copysign(1.0, self.demand.turn) * run.error[run.new_leg :])))

    def _run_of(self, ship: TrimmedShip, track: PlannedTrack) -> TrackRun | None:
        """Return the run of a craft; None where it diverges."""
        try:
            return self._run(ship, track)
        except (DivergedError, InputError):
            return None

    def _is_stable(self, ship: TrimmedShip, outer: TransferLoop) -> bool:
        """Return whether heading and track are stable with that craft."""
        there = HeadingLoop(ship, replace(self.heading.loop, plant=plant_and_disturbance(ship)[0]))
        try:
            poles = replace(outer, plant=there.order_to_track()).closed_loop_poles
        except InputError:
            return False
        return bool(poles.real.max() < 0.0)

    def _record(self, run: TrackRun, track: PlannedTrack) -> Record:
        """Return position, heading, rudder and distance, the corner at the origin."""
        names, every = self.heading.ship.model.states, max(1, len(run.error) // _SAMPLES)
        series: dict[str, Array] = {name: run.states[::every, names.index(name)] for name in ("x0", "y0", "psi")}
        series["x0"] = series["x0"] - track.corner
        series[self.heading.ship.actuator] = run.actuator[::every]
        source = f"line of sight around loop '{self.heading.loop.name}' at a corner"
        error = Channel(frozen(np.ascontiguousarray(run.error[::every])), "m", "body", "starboard")
        return series_record("corner", self._step * every, series, source).with_channel(ERROR, error)
