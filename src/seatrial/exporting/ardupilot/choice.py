"""Gains for ArduPilot: of a grid with enough margin, those whose simulated step on the identified craft is best."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from seatrial.control.ship.parameter_draws import draw_parameters
from seatrial.core.values import InputError
from seatrial.exporting.ardupilot.controller import LOOP_RATE, ArduPilotGains
from seatrial.exporting.ardupilot.craft import REFERENCE_STEERING, SteeredCraft, turning_rates
from seatrial.exporting.ardupilot.gains import CascadeGains, PidGains, cascade_from_pid
from seatrial.exporting.ardupilot.sampled_loop import (
    SampledMargins,
    is_stable,
    sampled_heading,
    sampled_margins,
    sampled_speed,
)
from seatrial.exporting.ardupilot.steps import (
    LARGEST_OVERSHOOT,
    StepResponse,
    heading_step,
    slow_pole,
    speed_step,
)
from seatrial.physics.loops.autopilot import FASTEST, SLOWEST, speed_gains_at

LARGEST_MS = 1.6  # of either loop; chosen
_MOST_MS = 2.0  # where no gains keep it; the largest that text books allow (Astrom & Hagglund 1995, section 4.6)
_ANGLE_GAINS = np.geomspace(0.1, 3.0, 10)  # over the plant's slow poles; chosen
_RATE_GAINS = np.geomspace(0.3, 20.0, 9)  # over the feed-forward; chosen
_INTEGRAL_RATIO = 0.2  # over the product of both; chosen
_EQUAL_COST = 0.1  # relative, of weighted errors that count as equal; chosen
_BANDWIDTHS = 25  # natural frequencies of the speed loop that are tried; chosen
_FILTER_RATIO = 20.0  # cut-off of the error filter over the plant's slow poles; chosen
_FASTEST_FILTER = 10.0  # Hz, ArduPilot's default of ATC_STR_RAT_FLTE
_ACCELERATIONS = (0.5, 0.25, 0.125, 0.0625)  # of what full throttle gives at cruising speed; chosen
_LARGEST_LATERAL = 0.6 * 9.81  # m/s^2, ArduPilot's default of ATC_TURN_MAX_G


@dataclass(frozen=True, eq=False)
class ArduPilotTuning:
    """Gains chosen, their margins, and the steps with them.

    Attributes:
        stable_draws, draws: of craft drawn from the covariance of the fit, how many the heading loop keeps stable.
    """

    gains: ArduPilotGains
    heading_margins: SampledMargins
    heading_step: StepResponse
    speed_margins: SampledMargins | None
    speed_step: StepResponse | None
    stable_draws: int
    draws: int


def tune_ardupilot(craft: SteeredCraft, pid: Mapping[str, float] | None = None) -> ArduPilotTuning:
    """Return gains that keep Ms <= 1.6 and bring a heading step of 30 degrees home soonest with 10 % overshoot at most.

    pid: gains KP, KI, KD on the heading error, per rad of actuator, to be taken over in place of a choice.

    Raises:
        InputError: no gains keep the limits, or the gains given have no cascade, or do not keep the craft stable.
    """
    scale = slow_pole(craft.heading_plant, 2)
    peak, acceleration = turning_rates(craft, 1.0 / scale)
    error_filter = _error_filter(scale)
    feed_forward = REFERENCE_STEERING / peak
    limits = ArduPilotGains(
        CascadeGains(0.0, PidGains(0.0, 0.0)),
        None,
        min(peak, _LARGEST_LATERAL / max(craft.speed, 1.0)),
        acceleration,
        1.0,
    )
    if pid is None:
        heading = _chosen_heading(craft, limits, scale, feed_forward, error_filter)
    else:
        share = abs(craft.full_steering) * craft.available_steering
        shares = {name: value / share for name, value in pid.items()}
        heading = cascade_from_pid(shares, feed_forward, error_filter)
    gains = replace(limits, heading=heading)
    return _assessed(craft, _with_speed_control(craft, gains) if craft.throttle else gains, scale)


def _error_filter(pole: float) -> float:
    """Return the cut-off frequency [Hz] of the error filter for a plant with that mean pole [rad/s]."""
    return min(_FASTEST_FILTER, _FILTER_RATIO * pole / (2.0 * math.pi))


def _chosen_heading(
    craft: SteeredCraft, limits: ArduPilotGains, scale: float, feed_forward: float, error_filter: float
) -> CascadeGains:
    """Return the gains with the best heading step."""
    sampled, trials = sampled_heading(craft.heading_plant, 1.0 / LOOP_RATE), []
    for A, P in product(_ANGLE_GAINS * scale, _RATE_GAINS * feed_forward):
        rate = PidGains(float(P), float(_INTEGRAL_RATIO * P * A), FF=feed_forward, error_filter=error_filter)
        gains = CascadeGains(float(A), rate)
        trials.append(_Trial(replace(limits, heading=gains), float(P), sampled_margins(sampled, gains).Ms))
    return _best(trials, lambda g: heading_step(craft, g, scale), f"heading of '{craft.model.name}'").heading


def _with_speed_control(craft: SteeredCraft, gains: ArduPilotGains) -> ArduPilotGains:
    """Return the gains with those of the best speed step, the wanted speed changing no faster than it can be followed.

    ArduPilot adds the throttle that the wanted speed needs when it is steady, so that the integral of what the craft
    lags behind makes it overshoot; the acceleration is halved until it does not.
    """
    plant, sampled = craft.speed_plant, sampled_speed(craft.speed_plant, 1.0 / LOOP_RATE)
    pole = slow_pole(plant, 1)
    fastest = min(craft.trim_throttle, 1.0 - craft.trim_throttle) * float(plant.gain) * pole
    trials = []
    for omega in np.geomspace(SLOWEST, FASTEST, _BANDWIDTHS) * pole:
        placed = speed_gains_at(plant, float(omega))
        if min(placed.values()) >= 0.0:
            speed = PidGains(placed["KP"], placed["KI"], error_filter=_error_filter(pole))
            Ms = sampled_margins(sampled, CascadeGains(0.0, speed)).Ms
            trials.append(_Trial(replace(gains, speed=speed), speed.P, Ms))
    subject = f"speed of '{craft.model.name}'"
    best = gains
    for share in _ACCELERATIONS:
        accelerated = [replace(t, gains=replace(t.gains, speed_acceleration=share * fastest)) for t in trials]
        best = _best(accelerated, lambda g: speed_step(craft, g), subject)
        if speed_step(craft, best).overshoot <= LARGEST_OVERSHOOT:
            break
    return best


@dataclass(frozen=True)
class _Trial:
    """Gains, the proportional one of the loop in which they differ, and its Ms."""

    gains: ArduPilotGains
    proportional: float
    Ms: float


def _best(trials: list[_Trial], step: Callable[[ArduPilotGains], StepResponse], subject: str) -> ArduPilotGains:
    """Return the gains with the least weighted error of those that settle and overshoot little, else overshoot least.

    Of gains with Ms <= 1.6; where there are none, of those with the least Ms, if that is 2 at most. Of those that are
    nearly as good the least proportional gain, which passes on the least noise.
    """
    least = min((trial.Ms for trial in trials), default=math.inf)
    ranked = []
    for trial in trials:
        if trial.Ms <= min(max(LARGEST_MS, least), _MOST_MS):
            response = step(trial.gains)
            if math.isfinite(response.weighted_error):
                ranked.append((response.faults, response.cost, trial))
    if not ranked:
        raise InputError(
            f"no gains of ArduPilot's form keep the {subject} stable with Ms <= {_MOST_MS:g} and through a step (least "
            f"Ms {least:.3g}); check the coefficients of the model"
        )
    faults, cost, _ = min(ranked, key=lambda candidate: candidate[:2])
    equal = [trial for number, error, trial in ranked if number == faults and error <= (1.0 + _EQUAL_COST) * cost]
    return min(equal, key=lambda trial: trial.proportional).gains


def _assessed(craft: SteeredCraft, gains: ArduPilotGains, scale: float) -> ArduPilotTuning:
    dt = 1.0 / LOOP_RATE
    heading = sampled_margins(sampled_heading(craft.heading_plant, dt), gains.heading)
    step = heading_step(craft, gains, scale)
    if not (math.isfinite(heading.Ms) and math.isfinite(step.weighted_error)):
        raise InputError(
            f"these gains do not keep model '{craft.model.name}' stable in ArduPilot's form; tune with a smaller Ms"
        )
    draws = draw_parameters(craft.ship)
    plants = [replace(craft, ship=ship).heading_plant for ship in draws.ships]
    stable = sum(is_stable(sampled_heading(plant, dt), gains.heading) for plant in plants)
    speed = None if gains.speed is None else CascadeGains(0.0, gains.speed)
    return ArduPilotTuning(
        gains, heading, step,
        None if speed is None else sampled_margins(sampled_speed(craft.speed_plant, dt), speed),
        None if speed is None else speed_step(craft, gains),
        stable, draws.draws,
    )  # fmt: skip
