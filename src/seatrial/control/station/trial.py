"""A station kept by the nonlinear craft: every direction of the current once, and craft that the fit allows."""

import math
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.disturbance_simulation import correlation_time, time_to_know
from seatrial.control.station.allocation import inverse_rows
from seatrial.control.station.craft import StationCraft
from seatrial.control.station.disturbances import DisturbanceSeries, StationDisturbance, joined, summed
from seatrial.control.station.station_loop import FILTER_SHARE, INTEGRAL_SHARE, StationLoop, station_point
from seatrial.core.results.station import StationTrial
from seatrial.core.values import Array, Channel, DivergedError, InputError, Provenance, Record, RecordKind, frozen
from seatrial.estimation.predict.draws import square_root
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.loops.loop import Sampling
from seatrial.physics.models.thruster_layout import MIN_LAG
from seatrial.physics.simulate.craft_control import StationController, StationRun, ThrusterOrders, keep_station

# time constants of the integral before what is counted, and counted of craft that are drawn; chosen
_RUN_IN, _COUNTED = 8.0, 40.0
_LEAST_S, _MOST_STEPS = 600.0, 400_000  # counted at least [s]; steps of a run at most; chosen
_STEP_SHARE = 0.25  # of the least lag of a thruster, of a step; chosen
_SHARE = 95.0  # per cent of the time within the radius
_KEPT_SAMPLES, _KEPT_S = 1000, 300.0  # of the record that is kept, and of how long a stretch [s]; chosen
_LOST_LENGTHS = 100.0  # lengths from the station at which a craft counts as having run away; chosen


@dataclass(frozen=True, eq=False)
class StationSetting:
    """What a station is tried in: a steady current [m/s], directions from which it comes [rad], what varies."""

    current: float
    directions: Array
    disturbances: tuple[StationDisturbance, ...]

    def series(self, direction: float, dt: float, count: int, seed: int) -> DisturbanceSeries:
        """Return one realisation with the steady current from a direction."""
        rng = np.random.default_rng(seed)
        varying = summed([one.series(dt, count, rng) for one in self.disturbances], count)
        gone = -self.current * dt * np.arange(count)
        drift = varying.drift + np.outer([math.cos(direction), math.sin(direction)], gone)
        return replace(varying, drift=drift)


@dataclass(frozen=True, eq=False)
class _Footprint:
    """A run after its run-in, by sample: distance [m], heading [rad], thrust over the largest, share given."""

    distance: Array
    heading: Array
    thrust: Array
    given: Array

    @property
    def radius(self) -> float:
        return float(np.percentile(self.distance, _SHARE))


@dataclass(frozen=True, eq=False)
class StationSimulator:
    """A loop as it runs on board, in a setting; seed of the first direction's realisation."""

    loop: StationLoop
    controller: StationController
    setting: StationSetting
    seed: int

    def respond(self, draws: int) -> StationTrial:
        """Return how the identified craft keeps its station, and how many of those drawn from its fit do.

        Raises:
            InputError: the identified craft leaves its station.
        """
        directions = self.setting.directions
        counted = max(self._least_time, time_to_know(self._correlation_time, len(directions)))
        runs = map_in_threads(lambda k: self._run(self.loop.craft, k, counted), list(range(len(directions))))
        feet = [self._footprint(run) for run in runs]
        worst = int(np.argmax([foot.radius for foot in feet]))
        if not feet[worst].radius < _LOST_LENGTHS * self.loop.craft.layout.length:
            raise InputError(
                f"station: in a current from {math.degrees(directions[worst]):.0f} deg off the bow the craft leaves "
                "its station, as its thrusters do not reach; give a slower current or less gusts"
            )
        drawn = draw_craft(self.loop.craft, draws, self.seed)
        radii = [radius for radius in map_in_threads(self._drawn_radius, list(enumerate(drawn))) if radius < math.inf]
        distance, heading, thrust, given = (
            np.concatenate([getattr(foot, name) for foot in feet])
            for name in ("distance", "heading", "thrust", "given")
        )
        return StationTrial(
            directions=directions,
            position=_rms(distance),
            radius=float(np.percentile(distance, _SHARE)),
            heading=_rms(heading),
            thrust=_rms(thrust),
            cut=float(np.mean(given < 1.0)),
            used=np.sqrt(np.mean(thrust**2, axis=0)),
            record=self._record(runs[worst], float(directions[worst])),
            draws=len(drawn),
            stable_draws=len(radii),
            worst_radius=max(radii, default=math.nan),
        )

    @property
    def _time_constant(self) -> float:
        """The slowest of the loop [s], that of the integral."""
        return float(self.loop.gains.lag.max()) / FILTER_SHARE / INTEGRAL_SHARE

    @property
    def _least_time(self) -> float:
        return max(_LEAST_S, _COUNTED * self._time_constant)

    @property
    def _correlation_time(self) -> float:
        """The longer of those of distance and heading by linear theory [s]; zero where nothing disturbs."""
        if not self.setting.disturbances:
            return 0.0
        spectrum = joined([one.spectrum() for one in self.setting.disturbances])
        by_force, by_water = self.loop.point.responses(spectrum.omega)
        pose = self.loop.sensitivity(spectrum.omega) @ np.concatenate([by_water, by_force], axis=2)
        energy = np.einsum("nij,njk,nik->in", pose, spectrum.shares, pose.conj()).real
        return max(correlation_time(spectrum.omega, each) for each in (energy[0] + energy[1], energy[2]) if each.any())

    def _run(self, craft: StationCraft, number: int, counted: float) -> StationRun:
        """Return the run of a craft in the current from the direction of that number, so many seconds counted."""
        directions, dt = self.setting.directions, self.controller.dt
        count = min(math.ceil((_RUN_IN * self._time_constant + counted) / dt), _MOST_STEPS)
        direction = float(directions[number % len(directions)])
        series = self.setting.series(direction, dt, count, self.seed + number)
        return keep_station(
            craft.pushed_model, self.controller, craft.resting_inputs, series.drift, series.forces, self.seed + number
        )

    def _first(self, run: StationRun) -> int:
        """Return the first sample that is counted."""
        return min(round(_RUN_IN * self._time_constant / run.dt), len(run.north) // 2)

    def _footprint(self, run: StationRun) -> _Footprint:
        first, largest = self._first(run), np.array([max(t.most, -t.least) for t in self.loop.craft.tables])
        distance = np.hypot(run.north[first:], run.east[first:])
        return _Footprint(distance, run.heading[first:], run.thrust[first:] / largest, run.given[first:])

    def _drawn_radius(self, numbered: tuple[int, StationCraft]) -> float:
        """Return the radius [m] of a craft drawn; infinite where its loop is not stable or it runs away."""
        number, craft = numbered
        direction = float(self.setting.directions[number % len(self.setting.directions)])
        there = replace(
            self.loop, point=station_point(craft, self.setting.current, direction, self.loop.inverse),
            slope=thrust_slopes(craft, self.loop.craft),
        )  # fmt: skip
        if not there.is_stable:
            return math.inf
        try:
            radius = self._footprint(self._run(craft, number, self._least_time)).radius
        except DivergedError:
            return math.inf
        return radius if radius < _LOST_LENGTHS * craft.layout.length else math.inf

    def _record(self, run: StationRun, direction: float) -> Record:
        """Return place and heading on station, minutes of it, the run-in left out."""
        first = self._first(run)
        end = min(len(run.north), first + round(_KEPT_S / run.dt))
        every = max(1, (end - first) // _KEPT_SAMPLES)
        series = {"x0": run.north, "y0": run.east, "psi": run.heading}
        channels = {
            name: Channel.from_notation(name, frozen(np.ascontiguousarray(values[first:end:every])))
            for name, values in series.items()
        }
        time = frozen(run.dt * every * np.arange(len(run.north[first:end:every])))
        source = f"station kept in a current from {math.degrees(direction):.0f} deg off the bow"
        return Record("station", time, channels, RecordKind.SIMULATED, provenance=Provenance(source))


def sampled_controller(loop: StationLoop, sampling: Sampling) -> StationController:
    """Return the controller of a loop as it runs on board."""
    craft, g = loop.craft, loop.gains
    rows = inverse_rows(craft, loop.inverse)
    orders = [
        ThrusterOrders(thruster, row, table.share, table.thrust)
        for thruster, row, table in zip(craft.thrusters, rows, craft.tables, strict=True)
    ]
    longest = max(_STEP_SHARE * float(craft.lags.min()), MIN_LAG)
    return StationController(g.KP, g.KI, g.KD, g.lag, sampling, orders, longest)


def draw_craft(craft: StationCraft, draws: int, seed: int) -> list[StationCraft]:
    """Return craft sampled from the Gaussian of the fit's free parameters; none where it has no covariance."""
    if not craft.covariance.size or not draws:
        return []
    free = craft.model.parameters.free
    spread = np.random.default_rng(seed).standard_normal((draws, len(free))) @ square_root(craft.covariance).T
    names, centre = [p.name for p in free], np.array([p.value for p in free])
    return [craft.with_values(dict(zip(names, point.tolist(), strict=True))) for point in centre + spread]


def thrust_slopes(craft: StationCraft, nominal: StationCraft) -> Array:
    """Return the thrust of each component over that of another craft, both at the command of half its thrust, (m,)."""
    ratios = []
    for own, known in zip(craft.tables, nominal.tables, strict=True):
        half = 0.5 * known.most
        share = float(np.interp(half, known.thrust, known.share))
        ratios.append(float(np.interp(share, own.share, own.thrust)) / half)
    return np.array(ratios)[list(craft.owner)]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
