"""Station keeping tuned: bandwidths, gains, allocation, what the thrusters hold, how the craft keeps its place."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from seatrial.control.ship.parameter_draws import DRAWS
from seatrial.control.ship.trimmed_ship import rate_response
from seatrial.control.station.allocation import generalised_inverse
from seatrial.control.station.capability import capability
from seatrial.control.station.choose_bandwidth import StationDesign, StationLimits, choose_bandwidth, margin_frequencies
from seatrial.control.station.craft import StationCraft, refuse_under_actuated, without_current
from seatrial.control.station.disturbances import SlowPush, StationDisturbance, WavePush, joined
from seatrial.control.station.station_loop import DAMPING, INTEGRAL_SHARE, StationLoop, station_point
from seatrial.control.station.trial import StationSetting, StationSimulator, sampled_controller
from seatrial.control.task import Seaway, SlowDisturbance, StationDemand, TuningTask
from seatrial.core.results.station import StationCapability, StationKeeping, StationMargins, StationThruster
from seatrial.core.values import Array, InputError
from seatrial.physics.loops.discrete import round_sample_time
from seatrial.physics.loops.loop import Sampling

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
    for met in task.disturbances:
        if isinstance(met, Seaway):
            assert demand.hull is not None
            pushes.append(WavePush(met, demand.hull, M_r))
        else:
            moment = M_r * _yaw_acceleration(task, met)
            pushes.append(SlowPush(met.description, (0.0, 0.0, 0.0, 0.0, 0.0, moment), met.bandwidth))
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
    spectrum = joined([one.spectrum() for one in varying])
    frequencies = margin_frequencies(craft, dead_time)
    points = tuple(
        replace(station_point(craft, demand.current, direction, inverse), grids=(frequencies, spectrum.omega))
        for direction in directions.tolist()
    )
    limits = StationLimits(task.constraints.Ms, demand.joint_Ms)
    chosen = choose_bandwidth(StationDesign(points, inverse, dead_time, limits, spectrum, frequencies))
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
        disturbances=tuple(one.description for one in varying),
        margins=_margins(chosen.loops),
        predicted=chosen.precision,
        front=chosen.front,
        thrusters=_thrusters(craft, inverse),
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
    surge, sway, yaw, joint = np.max([replace(one, frequencies=finer).peaks() for one in loops], axis=0).tolist()
    return StationMargins(surge, sway, yaw, joint, min(one.tolerated_dead_time - one.dead_time for one in loops))


def _thrusters(craft: StationCraft, inverse: Array) -> tuple[StationThruster, ...]:
    owner = np.array(craft.owner)
    return tuple(
        StationThruster(thruster.name, inverse[owner == i], table.share, table.thrust)
        for i, (thruster, table) in enumerate(zip(craft.thrusters, craft.tables, strict=True))
    )
