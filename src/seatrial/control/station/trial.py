"""A station kept in current, wind and waves: what disturbs it, and trials by simulation."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.ship import drawn_values
from seatrial.control.simulation import (
    correlation_time,
    frequency_band,
    gauss_markov,
    sum_harmonics,
    time_to_know,
    wave_components,
)
from seatrial.control.station.craft import StationCraft, thruster_orders
from seatrial.control.station.station_loop import FILTER_SHARE, INTEGRAL_SHARE, StationLoop, station_point
from seatrial.control.task import Seaway
from seatrial.core.results.station import StationTrial
from seatrial.core.values import Array, DivergedError, InputError, Record
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import HullFactor, YawAcceleration
from seatrial.physics.loops.loop import Sampling
from seatrial.physics.models.thruster_layout import MIN_LAG
from seatrial.physics.simulate.craft_control import StationController, StationRun, keep_station
from seatrial.physics.simulate.replay import series_record

# What drives a craft off its station: water that moves and forces, as spectra for the loop and series in time.

_SLOWEST, _FASTEST, _NODES = 1e-3, 1e4, 300  # frequencies over a bandwidth, and how many; chosen
_BINS, _SEED = 80, 0  # frequencies in which the waves of one sea are gathered, and the seed of these; chosen
AXES = 6
"""Velocity of the water north, east (and none of yaw), then forces X, Y, N: what disturbs a craft."""


@dataclass(frozen=True, eq=False)
class DisturbanceSpectrum:
    """Shares of the cross-covariance of what disturbs, (n, 6, 6), at omega [rad/s], (n,)."""

    omega: Array
    shares: Complex


@dataclass(frozen=True)
class SlowPush:
    """Independent Gauss-Markov processes of some of the six axes: rms (6,), bandwidth [rad/s]."""

    description: str
    rms: tuple[float, ...]
    bandwidth: float

    def spectrum(self) -> DisturbanceSpectrum:
        """Return its one-sided density 2 rms^2 b / pi / (w^2 + b^2) (Gelb 1974, section 3.8) on nodes."""
        b = self.bandwidth
        w = np.geomspace(_SLOWEST * b, _FASTEST * b, _NODES)
        energy = 2.0 * b / math.pi / (w**2 + b**2) * np.gradient(w)
        return DisturbanceSpectrum(w, energy[:, None, None] * np.diag(np.square(self.rms)).astype(np.complex128))

    def series(self, dt: float, count: int, rng: np.random.Generator) -> Array:
        """Return one realisation: how far the water has gone north and east [m], and forces X, Y, N, (5, count)."""
        noise = np.array([rms * gauss_markov(self.bandwidth, dt, count, rng) if rms else np.zeros(count)
                         for rms in self.rms])  # fmt: skip
        return np.concatenate([dt * np.cumsum(noise[:2], axis=1), noise[3:]])


@dataclass(frozen=True)
class WaterSpeed:
    """Horizontal speed of the water of waves along their direction, averaged over a hull [m/s for each m of wave].

    omega times the mean of exp(-k z) over half the draught and of the wave over length and breadth, as `HullFactor`.
    """

    hull: HullFactor

    name = "water that the waves move"

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Wave frequencies [rad/s] that reach the hull."""
        return self.hull.frequency_range

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:  # noqa: ARG002
        """Return the amplitude per metre of wave, in phase with that of `YawAcceleration`."""
        return np.asarray(-1j * omega * self.hull.slope_factor(omega, beta), dtype=np.complex128)


@dataclass(frozen=True, eq=False)
class WavePush:
    """A sea around a craft on station; inertia: M_r by which its yaw acceleration is a moment."""

    sea: Seaway
    hull: HullFactor
    inertia: float

    @property
    def description(self) -> str:
        """In words."""
        return self._still.description

    def spectrum(self) -> DisturbanceSpectrum:
        """Return its waves gathered in bins of frequency."""
        omega, amplitude = self._waves(np.random.default_rng(_SEED))
        edges = np.linspace(omega.min(), omega.max() * (1.0 + 1e-12), _BINS + 1)  # of rounding errors
        place = np.searchsorted(edges, omega, side="right") - 1
        shares = np.zeros((_BINS, AXES, AXES), dtype=np.complex128)
        np.add.at(shares, place, 0.5 * amplitude[:, :, None] * amplitude[:, None, :].conj())
        return DisturbanceSpectrum(0.5 * (edges[1:] + edges[:-1]), shares)

    def series(self, dt: float, count: int, rng: np.random.Generator) -> Array:
        """Return one realisation, (5, count), as `SlowPush` does."""
        omega, amplitude = self._waves(rng)
        drift = [sum_harmonics(omega, amplitude[:, i] / (1j * omega), dt, count) for i in range(2)]
        moment = sum_harmonics(omega, amplitude[:, AXES - 1], dt, count)
        return np.array([*drift, np.zeros(count), np.zeros(count), moment])

    @property
    def _still(self) -> Seaway:
        return replace(self.sea, U=0.0, effect=WaterSpeed(self.hull), path=None, at_points=())

    def _waves(self, rng: np.random.Generator) -> tuple[Array, Complex]:
        """Return frequencies (n,) [rad/s] and complex amplitudes (n, 6) of the waves of one realisation."""
        still = self._still
        lines = wave_components(still, rng, frequency_band(still, np.ones_like))
        unit = np.zeros((len(lines.omega), AXES), dtype=np.complex128)
        turning = YawAcceleration(self.hull.L, self.hull.T)
        for beta in np.unique(lines.direction):
            these = lines.direction == beta
            speed = still.effect.amplitude(lines.omega[these], 0.0, float(beta))
            unit[these, 0], unit[these, 1] = speed * math.cos(beta), speed * math.sin(beta)
            unit[these, AXES - 1] = self.inertia * turning.amplitude(lines.omega[these], 0.0, float(beta))
        return lines.omega, unit * lines.amplitude[:, None]


StationDisturbance = SlowPush | WavePush


def joined(spectra: Sequence[DisturbanceSpectrum]) -> DisturbanceSpectrum:
    """Return independent spectra as one."""
    return DisturbanceSpectrum(
        np.concatenate([part.omega for part in spectra]), np.concatenate([part.shares for part in spectra])
    )


# A station kept by the nonlinear craft: every direction of the current once, and craft that the fit allows.

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

    def series(self, direction: float, dt: float, count: int, seed: int) -> Array:
        """Return one realisation with the steady current from a direction, (5, count), as `SlowPush` does."""
        rng, gone = np.random.default_rng(seed), -self.current * dt * np.arange(count)
        steady = np.outer([math.cos(direction), math.sin(direction), 0.0, 0.0, 0.0], gone)
        return np.sum([steady, *(disturbance.series(dt, count, rng) for disturbance in self.disturbances)], axis=0)


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
        counted_runs = [run.after(self._first(run)) for run in runs]
        radii = [_radius(run.distance) for run in counted_runs]
        worst = int(np.argmax(radii))
        if not radii[worst] < _LOST_LENGTHS * self.loop.craft.layout.length:
            raise InputError(
                f"station: in a current from {math.degrees(directions[worst]):.0f} deg off the bow the craft leaves "
                "its station, as its thrusters do not reach; give a slower current or less gusts"
            )
        fleet = draw_craft(self.loop.craft, draws, self.seed)
        kept_radii = [
            radius for radius in map_in_threads(self._drawn_radius, list(enumerate(fleet))) if radius < math.inf
        ]
        distance, heading, thrust, given = (
            np.concatenate([getattr(run, name) for run in counted_runs])
            for name in ("distance", "heading", "thrust", "given")
        )
        thrust = thrust / [max(table.most, -table.least) for table in self.loop.craft.tables]
        return StationTrial(
            directions=directions,
            position=_rms(distance),
            radius=_radius(distance),
            heading=_rms(heading),
            thrust=_rms(thrust),
            cut=float(np.mean(given < 1.0)),
            used=np.sqrt(np.mean(thrust**2, axis=0)),
            record=self._record(runs[worst], float(directions[worst])),
            draws=len(fleet),
            stable_draws=len(kept_radii),
            worst_radius=max(kept_radii, default=math.nan),
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
        spectrum = joined([disturbance.spectrum() for disturbance in self.setting.disturbances])
        by_force, by_water = self.loop.point.responses(spectrum.omega)
        pose = self.loop.sensitivity(spectrum.omega) @ np.concatenate([by_water, by_force], axis=2)
        energy = np.einsum("nij,njk,nik->in", pose, spectrum.shares, pose.conj()).real
        return max(correlation_time(spectrum.omega, each) for each in (energy[0] + energy[1], energy[2]) if each.any())

    def _run(self, craft: StationCraft, number: int, counted: float) -> StationRun:
        """Return the run of a craft in the current from the direction of that number, so many seconds counted."""
        directions, dt = self.setting.directions, self.controller.dt
        count = min(math.ceil((_RUN_IN * self._time_constant + counted) / dt), _MOST_STEPS)
        direction = float(directions[number % len(directions)])
        pushes = self.setting.series(direction, dt, count, self.seed + number)
        return keep_station(craft.pushed_model, self.controller, craft.resting_inputs, pushes, self.seed + number)

    def _first(self, run: StationRun) -> int:
        """Return the first sample that is counted."""
        return min(round(_RUN_IN * self._time_constant / run.dt), len(run.north) // 2)

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
            run = self._run(craft, number, self._least_time)
        except DivergedError:
            return math.inf
        radius = _radius(run.distance[self._first(run) :])
        return radius if radius < _LOST_LENGTHS * craft.layout.length else math.inf

    def _record(self, run: StationRun, direction: float) -> Record:
        """Return place and heading on station, minutes of it, the run-in left out."""
        first = self._first(run)
        end = min(len(run.north), first + round(_KEPT_S / run.dt))
        every = max(1, (end - first) // _KEPT_SAMPLES)
        rows = slice(first, end, every)
        series = {"x0": run.north[rows], "y0": run.east[rows], "psi": run.heading[rows]}
        source = f"station kept in a current from {math.degrees(direction):.0f} deg off the bow"
        return series_record("station", run.dt * every, series, source)


def sampled_controller(loop: StationLoop, sampling: Sampling) -> StationController:
    """Return the controller of a loop as it runs on board."""
    longest = max(_STEP_SHARE * float(loop.craft.lags.min()), MIN_LAG)
    return StationController(loop.gains, sampling, thruster_orders(loop.craft, loop.inverse), longest)


def draw_craft(craft: StationCraft, draws: int, seed: int) -> list[StationCraft]:
    """Return craft sampled from the Gaussian of the fit's free parameters; none where it has no covariance."""
    return [craft.with_values(values) for values in drawn_values(craft.model, craft.covariance, draws, seed)]


def thrust_slopes(craft: StationCraft, nominal: StationCraft) -> Array:
    """Return the thrust of each component over that of another craft, both at the command of half its thrust, (m,)."""
    ratios = []
    for table, reference in zip(craft.tables, nominal.tables, strict=True):
        half = 0.5 * reference.most
        share = float(np.interp(half, reference.thrust, reference.share))
        ratios.append(float(np.interp(share, table.share, table.thrust)) / half)
    return np.array(ratios)[list(craft.owner)]


def _radius(distance: Array) -> float:
    return float(np.percentile(distance, _SHARE))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
