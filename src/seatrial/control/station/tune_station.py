"""A station's controller tuned: bandwidths chosen, tried on craft that the fit allows."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.ship import DRAWS, rate_response
from seatrial.control.station.craft import (
    StationCraft,
    capability,
    generalised_inverse,
    refuse_under_actuated,
    weights,
    without_current,
)
from seatrial.control.station.station_loop import (
    DAMPING,
    INTEGRAL_SHARE,
    StationLoop,
    StationPoint,
    place_poles,
    station_point,
)
from seatrial.control.station.trial import (
    DisturbanceSpectrum,
    SlowPush,
    StationDisturbance,
    StationSetting,
    StationSimulator,
    WavePush,
    joined,
    sampled_controller,
)
from seatrial.control.task import Seaway, SlowDisturbance, StationDemand, TuningTask
from seatrial.core.results.station import (
    StationCapability,
    StationFront,
    StationKeeping,
    StationMargins,
    StationPrecision,
)
from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops.discrete import round_sample_time
from seatrial.physics.loops.loop import Sampling

# Bandwidths of position and heading: a grid within the limits, the front of error against thrust, the choice on it.

_POINTS, _ROUNDS = 9, 3  # of a grid to each side, and grids one after the other; chosen
_SLOWEST = 0.005  # least bandwidth over the largest, which is that of thrusters and dead time; chosen
_SAMPLES, _REACH = 200, 1e2  # frequencies of margins, how far they go beyond the bandwidths tried; chosen
_DELAY_SHARE = 1.0  # least delay margin over the dead time that the loop is tuned with, so that twice it is tolerated


def largest_bandwidth(craft: StationCraft, dead_time: float) -> float:
    """Return the largest bandwidth that is tried [rad/s]: that of thrusters and dead time [s]."""
    return 1.0 / (dead_time + float(craft.lags.max()))


def margin_frequencies(craft: StationCraft, dead_time: float) -> Array:
    """Return the frequencies [rad/s] on which margins of all bandwidths tried are taken."""
    top = largest_bandwidth(craft, dead_time)
    return np.geomspace(_SLOWEST * top / _REACH, top * _REACH, _SAMPLES)


JOINT_MS = 3.0  # largest sensitivity of surge, sway and yaw together: tolerates 1.5 in all loops at once; chosen


@dataclass(frozen=True, eq=False)
class StationDesign:
    """What every candidate has: points it has to hold at, inverse (m, 3), dead time [s], limits, what disturbs.

    Ms: largest of each loop with the others closed; `JOINT_MS` of all together, the largest singular value of S.
    frequencies: of margins [rad/s], `margin_frequencies`.
    """

    points: tuple[StationPoint, ...]
    inverse: Array
    dead_time: float
    Ms: float
    spectrum: DisturbanceSpectrum
    frequencies: Array

    @property
    def craft(self) -> StationCraft:
        """The craft, the same at all points."""
        return self.points[0].craft

    @property
    def fastest(self) -> float:
        """The largest bandwidth that is tried [rad/s]."""
        return largest_bandwidth(self.craft, self.dead_time)

    def loops(self, position: float, heading: float) -> tuple[StationLoop, ...]:
        """Return the loop of two bandwidths [rad/s] at each point."""
        craft = self.craft
        gains = place_poles(craft.inertia, craft.damping, np.array([position, position, heading]))
        slope = np.ones(len(craft.owner))
        return tuple(
            StationLoop(point, gains, self.inverse, self.dead_time, slope, self.frequencies) for point in self.points
        )

    def excess(self, loops: Sequence[StationLoop], enough: float = math.inf) -> float:
        """Return by which factor a loop is beyond its worst limit, over all points: Ms, joint Ms, delay margin.

        enough: a factor beyond which the points that follow are not looked at.
        """
        least, worst = (1.0 + _DELAY_SHARE) * self.dead_time, 0.0
        for loop in loops:
            delay = loop.tolerated_dead_time
            slack = least / delay if delay > 0.0 else math.inf
            peaks = loop.peaks()
            worst = max(worst, float(peaks[:3].max()) / self.Ms, float(peaks[3]) / JOINT_MS, slack)
            if worst > enough:
                break
        return worst

    def precision(self, loops: Sequence[StationLoop]) -> StationPrecision:
        """Return rms of position, heading and thrust by linear theory, the mean of squares over the points."""
        squares = np.mean([self._squares(loop) for loop in loops], axis=0)
        position, heading, thrust = np.sqrt(squares).tolist()
        return StationPrecision(position, heading, thrust)

    def _squares(self, loop: StationLoop) -> Array:
        """Return mean squares (3,) at one point: integrals of the spectra through S."""
        w, shares = self.spectrum.omega, self.spectrum.shares
        by_force, by_water = loop.point.responses(w)
        pose = loop.sensitivity(w) @ np.concatenate([by_water, by_force], axis=2)
        thrust = loop.thrusts(w) @ pose / weights(self.craft)[:, None]
        squares, effort = _variances(pose, shares), _variances(thrust, shares)
        return np.array([squares[0] + squares[1], squares[2], effort.sum() / len(self.craft.thrusters)])


@dataclass(frozen=True, eq=False)
class ChosenBandwidth:
    """Bandwidths of position and heading [rad/s], their loop at each point, what it leaves, and the front."""

    position: float
    heading: float
    loops: tuple[StationLoop, ...]
    precision: StationPrecision
    front: StationFront


def choose_bandwidth(design: StationDesign) -> ChosenBandwidth:
    """Return the bandwidths of the least product of error and thrust within the limits, by grids about the best.

    The error is that of the ends of the hull. Along the front one per cent less of it costs less than one per cent of
    thrust up to there, and more beyond.

    Raises:
        InputError: no bandwidth keeps the limits.
    """
    ends = np.full(2, math.log(_SLOWEST * design.fastest)), np.full(2, math.log(design.fastest))
    (low, high), tried = ends, list[_Candidate]()
    best, winner = np.zeros(2), _Candidate(0.0, 0.0, math.inf)
    for _ in range(_ROUNDS):
        positions, headings = (np.exp(np.linspace(a, b, _POINTS)) for a, b in zip(low, high, strict=True))
        for place in np.stack(np.meshgrid(positions, headings), axis=-1).reshape(-1, 2).tolist():
            tried.append(_candidate(design, place[0], place[1], winner.rank[0]))
            winner = min(winner, tried[-1], key=lambda candidate: candidate.rank)
        best = np.log([winner.position, winner.heading])
        reach = (high - low) / (_POINTS - 1)
        low, high = np.maximum(best - reach, ends[0]), np.minimum(best + reach, ends[1])
    kept = [candidate for candidate in tried if candidate.excess <= 1.0]
    if not kept:
        _refuse(design, best)
    position, heading = np.exp(best).tolist()
    loops = design.loops(position, heading)
    rows = np.array([(candidate.position, candidate.heading, candidate.error, candidate.thrust) for candidate in kept])
    front = _front(rows, len(tried))
    return ChosenBandwidth(position, heading, loops, design.precision(loops), front)


def hull_error(craft: StationCraft, precision: StationPrecision) -> float:
    """Return the rms [m] of position and of what heading moves the ends of the hull."""
    return math.hypot(precision.position, craft.lever * precision.heading)


@dataclass(frozen=True)
class _Candidate:
    """Bandwidths [rad/s], by which factor they are beyond the limits, and what they leave where they are not."""

    position: float
    heading: float
    excess: float
    error: float = math.inf
    thrust: float = math.inf

    @property
    def rank(self) -> tuple[float, float]:
        return max(self.excess, 1.0), self.error * self.thrust


def _candidate(design: StationDesign, position: float, heading: float, enough: float) -> _Candidate:
    loops = design.loops(position, heading)
    excess = design.excess(loops, enough)
    if excess > 1.0:
        return _Candidate(position, heading, excess)
    precision = design.precision(loops)
    return _Candidate(position, heading, excess, hull_error(design.craft, precision), precision.thrust)


def _variances(response: Complex, shares: Complex) -> Array:
    """Return the variances (k,) of responses (n, k, 6) to disturbances of cross-covariances (n, 6, 6)."""
    return np.einsum("nij,njk,nik->i", response, shares, response.conj()).real


def _front(rows: Array, evaluations: int) -> StationFront:
    """Return those of the rows (n, 4) that no other beats in error and thrust, by error."""
    ordered = rows[np.lexsort((rows[:, 3], rows[:, 2]))]
    least = np.minimum.accumulate(ordered[:, 3])
    kept = ordered[np.concatenate([[True], ordered[1:, 3] < least[:-1]])]
    position, heading, error, thrust = (np.ascontiguousarray(column) for column in kept.T)
    return StationFront(position, heading, error, thrust, evaluations)


def _refuse(design: StationDesign, best: Array) -> None:
    position, heading = np.exp(best).tolist()
    loops = design.loops(position, heading)
    worst = np.max([loop.peaks() for loop in loops], axis=0)
    delay = min(loop.tolerated_dead_time for loop in loops)
    asked = (1.0 + _DELAY_SHARE) * design.dead_time
    broken = [f"{name} {reached:.3g} for {limit:.3g}"
              for name, reached, limit in (("Ms", worst[:3].max(), design.Ms), ("joint Ms", worst[3], JOINT_MS))
              if reached > limit]  # fmt: skip
    broken += [f"tolerated dead time {delay:.3g} s for {asked:.3g} s"] if delay < asked else []
    raise InputError(
        f"station: no bandwidth keeps the limits in this current ({', '.join(broken)}); give a slower current, more "
        "limits.Ms, or quicker thrusters"
    )


# Station keeping tuned: bandwidths, gains, allocation, what the thrusters hold, how the craft keeps its place.

STATION_DIRECTIONS = 8
"""Directions of the steady current that a station is tried in, every 45 degrees; chosen."""
_MARGIN_SAMPLES = 3000  # frequencies of the margins that are reported; chosen
_STRONGEST = 2.0  # times its rms that a current exceeds its mean: 98 % of a Gaussian are less
_SAMPLES_A_LAG = 2.0  # samples of the controller in the largest lag; chosen
_NO_LAG = 0.2  # s, taken where no thruster has a lag: that of a small electric one (`DEFAULT_LAG`)


def station_craft(demand: StationDemand) -> StationCraft:
    """Return the craft of a demand.

    Raises:
        InputError: its thrusters do not push in all directions.
    """
    craft = StationCraft(without_current(demand.model), demand.covariance, demand.limit)
    refuse_under_actuated(craft)
    return craft


def refuse_impossible_station(demand: StationDemand) -> None:
    """Refuse a station that thrusters do not hold: none pushes in some direction, or the current is too strong.

    Raises:
        InputError: which of them, and what the thrusters hold.
    """
    craft = station_craft(demand)
    _held_directions(capability(craft, generalised_inverse(craft)), demand)


def station_disturbances(
    task: TuningTask, demand: StationDemand, craft: StationCraft
) -> tuple[StationDisturbance, ...]:
    """Return what varies on station: current, gusts, and the loop's own slow disturbances and seas.

    A slow disturbance of a heading loop acts like its actuator; on station it is the moment that does as much slowly.
    """
    M_r = float(craft.inertia[2, 2])
    pushes: list[StationDisturbance] = []
    if demand.current_rms:
        rms = (demand.current_rms, demand.current_rms, 0.0, 0.0, 0.0, 0.0)
        text = f"current that varies by {demand.current_rms:.3g} m/s below {demand.current_bandwidth:.3g} rad/s"
        pushes.append(SlowPush(text, rms, demand.current_bandwidth))
    if demand.gust_rms:
        rms = (0.0, 0.0, 0.0, demand.gust_rms, demand.gust_rms, 0.0)
        text = f"gusts of {demand.gust_rms:.3g} {craft.force_unit} below {demand.gust_bandwidth:.3g} rad/s"
        pushes.append(SlowPush(text, rms, demand.gust_bandwidth))
    for disturbance in task.disturbances:
        if isinstance(disturbance, Seaway):
            assert demand.hull is not None
            pushes.append(WavePush(disturbance, demand.hull, M_r))
        else:
            moment = M_r * _yaw_acceleration(task, disturbance)
            pushes.append(SlowPush(disturbance.description, (0.0, 0.0, 0.0, 0.0, 0.0, moment), disturbance.bandwidth))
    return tuple(pushes)


def tune_station(
    task: TuningTask,
    demand: StationDemand,
    seed: int,
    report_progress: Callable[[str], None],
    draws: int = DRAWS,
) -> StationKeeping:
    """Return gains within the limits of Ms and dead time, the thrusters' capability, and the trial of both.

    draws: craft of the fit that are tried.

    Raises:
        InputError: thrusters that do not push in all directions, no gains within the limits, or a current that the
            thrusters hold from nowhere.
    """
    craft = station_craft(demand)
    inverse = generalised_inverse(craft)
    report_progress("station: what the thrusters hold")
    holds = capability(craft, inverse)
    directions = _held_directions(holds, demand)
    varying = station_disturbances(task, demand, craft)
    sample = task.sample_s or round_sample_time((float(craft.lags.max()) or _NO_LAG) / _SAMPLES_A_LAG)
    dead_time = demand.dead_time + craft.delay + 0.5 * sample
    report_progress("station: bandwidths of position and heading")
    spectrum = joined([disturbance.spectrum() for disturbance in varying])
    frequencies = margin_frequencies(craft, dead_time)
    points = tuple(
        replace(station_point(craft, demand.current, direction, inverse), grids=(frequencies, spectrum.omega))
        for direction in directions.tolist()
    )
    design = StationDesign(points, inverse, dead_time, task.constraints.Ms, spectrum, frequencies)
    chosen = choose_bandwidth(design)
    report_progress("station: kept by the nonlinear craft")
    compass = task.loop.sampling or Sampling(sample)
    sampling = Sampling(sample, demand.dead_time, compass.noise, compass.resolution)
    controller = sampled_controller(chosen.loops[0], sampling)
    setting = StationSetting(demand.current, directions, varying)
    trial = StationSimulator(chosen.loops[0], controller, setting, seed).respond(draws)
    gains = chosen.loops[0].gains
    return StationKeeping(
        position_bandwidth=chosen.position,
        heading_bandwidth=chosen.heading,
        damping=DAMPING,
        integral_share=INTEGRAL_SHARE,
        KP=gains.KP,
        KI=gains.KI,
        KD=gains.KD,
        gain_units=gain_units(craft.force_unit),
        filter_lag=gains.lag,
        sample_s=sample,
        dead_time=dead_time,
        force_unit=craft.force_unit,
        current=demand.current,
        disturbances=tuple(disturbance.description for disturbance in varying),
        margins=_margins(chosen.loops),
        predicted=chosen.precision,
        front=chosen.front,
        thrusters=controller.thrusters,
        capability=holds,
        trial=trial,
    )


def _yaw_acceleration(task: TuningTask, met: SlowDisturbance) -> float:
    """Return the rms of the yaw acceleration [rad/s^2] that does to the heading what a slow disturbance does."""
    assert task.trimmed_ship is not None
    omega = np.array([met.bandwidth])
    by_moment = rate_response(task.trimmed_ship, "r").frequency_response(omega)
    return met.rms * float(np.abs(met.disturbed(task.loop).disturbance.frequency_response(omega) / by_moment)[0])


def gain_units(force: str) -> dict[str, tuple[tuple[str, ...], ...]]:
    """Return the unit of each element of K_p, K_i and K_d, (3, 3); force: its unit, N or N/kg."""
    kilogram = [] if force == "N" else ["kg"]

    def matrix(time: str, second: list[str]) -> tuple[tuple[str, ...], ...]:
        force_on, moment_on = f"N{time}", f"N m{time}"
        across = (_over(force_on, [*kilogram, "m", *second]), _over(force_on, [*kilogram, "rad", *second]))
        about = (_over(force_on, [*kilogram, *second]), _over(moment_on, [*kilogram, "rad", *second]))
        return (across[0], *across), (across[0], *across), (about[0], *about)

    return {"KP": matrix("", []), "KI": matrix("", ["s"]), "KD": matrix(" s", [])}


def _over(above: str, below: list[str]) -> str:
    if not below:
        return above
    return f"{above}/{below[0]}" if len(below) == 1 else f"{above}/({' '.join(below)})"


def _held_directions(holds: StationCapability, demand: StationDemand) -> Array:
    """Return those of the directions tried from which the current is held, its variations included [rad].

    Raises:
        InputError: there is none.
    """
    tried = holds.direction[:: len(holds.direction) // STATION_DIRECTIONS]
    held = holds.current_shared_out[:: len(holds.direction) // STATION_DIRECTIONS]
    strongest = demand.current + _STRONGEST * demand.current_rms
    kept = tried[held >= strongest]
    if not len(kept):
        best = int(np.argmax(holds.current_shared_out))
        raise InputError(
            f"station: a current of {demand.current:.3g} m/s is at times {strongest:.3g} m/s; the thrusters hold "
            f"{holds.current_shared_out[best]:.3g} m/s at most, from {math.degrees(holds.direction[best]):.0f} deg off "
            "the bow; give a slower current"
        )
    return kept


def _margins(loops: Sequence[StationLoop]) -> StationMargins:
    """Return the worst over the directions of the current."""
    finer = np.geomspace(loops[0].frequencies[0], loops[0].frequencies[-1], _MARGIN_SAMPLES)
    surge, sway, yaw, joint = np.max([replace(loop, frequencies=finer).peaks() for loop in loops], axis=0).tolist()
    return StationMargins(surge, sway, yaw, joint, min(loop.tolerated_dead_time - loop.dead_time for loop in loops))
