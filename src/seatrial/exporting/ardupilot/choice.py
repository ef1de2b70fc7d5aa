"""Gains for ArduPilot: of a grid with enough margin, those whose simulated step is the best."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from seatrial.control.controller import relative_overshoot, settling_time
from seatrial.control.ship import draw_parameters
from seatrial.core.values import Array, InputError
from seatrial.exporting.ardupilot.controller import (
    LOOP_RATE,
    REFERENCE_STEERING,
    ArduPilotGains,
    CascadeGains,
    PidGains,
    SteeredCraft,
    cascade_from_pid,
    filter_share,
    simulate_controlled,
    turning_rates,
)
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import Block, controllable_form
from seatrial.physics.loops.autopilot import FASTEST, SLOWEST, speed_gains_at
from seatrial.physics.loops.loop import held_step

# The sampled loop about the trim: its frequency response, its margins, and whether it is stable.

_FREQUENCIES = 4000  # at which margins are read off, evenly in the logarithm; chosen
_LOWEST = 1e-3  # of the plant's slowest pole, and as near to the Nyquist frequency; chosen
AT_ORIGIN = 1e-9  # of the largest pole, below which one counts as an integrator: rounding


@dataclass(frozen=True, eq=False)
class SampledPlant:
    """x[k+1] = A x[k] + b a[k] behind a hold, a the share of full steering or throttle; rows of angle and rate.

    Attributes:
        A, b: (n, n), (n,); dt: s.
        angle, rate: rows (n,) of what the outer gain and the AC_PID see: heading and yaw rate, or nothing and speed.
        slowest: rad/s, of its poles off the origin.
    """

    A: Array
    b: Array
    angle: Array
    rate: Array
    dt: float
    slowest: float

    @cached_property
    def frequencies(self) -> Array:
        """Frequencies at which margins are read off, up to the Nyquist frequency [rad/s]."""
        fastest = math.pi / self.dt
        return np.geomspace(_LOWEST * min(self.slowest, fastest), fastest * (1.0 - _LOWEST), _FREQUENCIES)

    @cached_property
    def responses(self) -> tuple[Complex, Complex]:
        """Responses of angle and rate at `frequencies`."""
        return self.responses_at(self.frequencies)

    def responses_at(self, omega: Array) -> tuple[Complex, Complex]:
        """Return the responses of angle and rate to the actuator at omega [rad/s], (m,)."""
        z = np.exp(1j * omega * self.dt)
        b = np.tile(self.b[:, None], (len(z), 1, 1))
        motion = np.linalg.solve(z[:, None, None] * np.eye(len(self.b)) - self.A, b)[..., 0]
        angle, rate = (np.asarray(motion @ row, dtype=np.complex128) for row in (self.angle, self.rate))
        return angle, rate


@dataclass(frozen=True)
class SampledMargins:
    """Of a sampled loop broken at the actuator: Ms, gain as a factor, phase [rad], delay [s]; infinite for any."""

    Ms: float
    gain: float
    phase: float
    delay: float


def sampled_heading(plant: Block, dt: float) -> SampledPlant:
    """Return a plant from steering to heading, with its yaw rate, behind a hold of dt [s]."""
    rate = Block("yaw rate", (*plant.num, 0.0), plant.den)
    return _sampled(plant, controllable_form(plant)[2], controllable_form(rate)[2], dt)


def sampled_speed(plant: Block, dt: float) -> SampledPlant:
    """Return a plant from throttle to speed behind a hold of dt [s]."""
    c = controllable_form(plant)[2]
    return _sampled(plant, np.zeros(len(c)), c, dt)


def _sampled(plant: Block, angle: Array, rate: Array, dt: float) -> SampledPlant:
    A, b, _, _ = controllable_form(plant)
    sizes = np.abs(plant.poles)
    slowest = float(sizes[sizes > AT_ORIGIN * sizes.max()].min())
    return SampledPlant(*held_step(A, b, dt), angle, rate, dt, slowest)


def open_loop(plant: SampledPlant, gains: CascadeGains, omega: Array | None = None) -> Complex:
    """Return L at omega [rad/s], (m,), below the Nyquist frequency; the actuator acts a sample late.

    omega: by default the plant's `frequencies`.
    """
    at_default = omega is None
    z = np.exp(1j * (plant.frequencies if at_default else omega) * plant.dt)
    angle, rate = plant.responses if at_default else plant.responses_at(omega)
    pid, dt = gains.rate, plant.dt
    targeted, filtered, smoothed = (
        share / (1.0 - (1.0 - share) / z)
        for share in (filter_share(f, dt) for f in (pid.target_filter, pid.error_filter, pid.derivative_filter))
    )
    backward = 1.0 - 1.0 / z
    terms = pid.P + pid.I * dt / backward + pid.D * smoothed * backward / dt
    wanted = gains.angle_P * targeted * angle
    return np.asarray((terms * filtered * (wanted + rate) + pid.FF * wanted) / z, dtype=np.complex128)


def closed_loop_matrix(plant: SampledPlant, gains: CascadeGains) -> Array:
    """Return the matrix of a sample of the closed loop, (n + 5, n + 5), without the limits of `controller`.

    Its states are those of the plant, the order, and target, error, derivative and integral of the AC_PID.
    """
    n, pid, dt = len(plant.b), gains.rate, plant.dt
    unit = np.eye(n + len(("order", "target", "error", "derivative", "integral")))
    x, order, target, error, derivative, integral = unit[:n], *unit[n:]
    aT, aE, aD = (filter_share(f, dt) for f in (pid.target_filter, pid.error_filter, pid.derivative_filter))
    new_target = target + aT * (-gains.angle_P * plant.angle @ x - target)
    new_error = error + aE * (new_target - plant.rate @ x - error)
    new_derivative = derivative + aD * ((new_error - error) / dt - derivative)
    new_integral = integral + pid.I * dt * new_error
    new_order = pid.P * new_error + new_integral + pid.D * new_derivative + pid.FF * new_target
    moved = plant.A @ x + np.outer(plant.b, order)
    rows = np.vstack([moved, new_order, new_target, new_error, new_derivative, new_integral])
    return np.asarray(rows, dtype=np.float64)


def is_stable(plant: SampledPlant, gains: CascadeGains) -> bool:
    """Return whether every pole lies inside the unit circle; an integral that nothing feeds does not count."""
    rows = closed_loop_matrix(plant, gains)
    rows = rows if gains.rate.I else rows[:-1, :-1]
    return bool(np.abs(np.linalg.eigvals(rows)).max() < 1.0)


def sampled_margins(plant: SampledPlant, gains: CascadeGains) -> SampledMargins:
    """Return the margins at the gains; Ms infinite, the others NaN, where the loop is unstable."""
    if not is_stable(plant, gains):
        return SampledMargins(math.inf, math.nan, math.nan, math.nan)
    omega, L = plant.frequencies, open_loop(plant, gains)
    axis, circle = _crossings(L.imag), _crossings(np.abs(L) - 1.0)
    factors = -1.0 / _between(L.real, axis)
    phase = np.mod(np.interp(circle, np.arange(len(L)), np.unwrap(np.angle(L))) + math.pi, 2.0 * math.pi)
    return SampledMargins(
        float(np.max(1.0 / np.abs(1.0 + L))),
        float(np.min(factors[factors > 1.0], initial=math.inf)),
        float(np.min(np.minimum(phase, 2.0 * math.pi - phase), initial=math.inf)),
        float(np.min(phase / _between(omega, circle), initial=math.inf)),
    )


def _crossings(values: Array) -> Array:
    """Return places between samples at which values change their sign, linearly."""
    before = np.flatnonzero(np.diff(np.sign(values)))
    return before + values[before] / (values[before] - values[before + 1])


def _between(values: Array, places: Array) -> Array:
    return np.interp(places, np.arange(len(values)), values)


# Steps of heading and speed, simulated on the nonlinear craft under ArduPilot's controller.

LARGEST_OVERSHOOT = 0.1  # of the steps of heading and speed; chosen
HEADING_STEP = math.radians(30.0)  # rad; chosen
SPEED_STEP = -0.2  # of the cruising speed; chosen
_HORIZON = 20.0  # of a simulated step, over the plant's time constant; chosen


@dataclass(frozen=True, eq=False)
class StepResponse:
    """A step simulated.

    Attributes:
        time: (n,), s; value: (n,), of heading [rad] or speed [m/s]; step: its wanted change.
        overshoot: share of the step; settling: s until it stays within 5 %, NaN if it does not.
        weighted_error: integral of time times the error's size (ITAE; Graham & Lathrop 1953, Trans. AIEE 72, 273).
        largest_order: steering or throttle, largest size.
    """

    time: Array
    value: Array
    step: float
    overshoot: float
    settling: float
    weighted_error: float
    largest_order: float

    @property
    def faults(self) -> int:
        """Return 2 where it does not settle, 1 where it overshoots by more than 10 %, else 0."""
        return 2 if math.isnan(self.settling) else int(self.overshoot > LARGEST_OVERSHOOT)

    @property
    def cost(self) -> float:
        """What is least of the best of steps with the same faults: the overshoot where it is too much."""
        return self.overshoot if self.faults == 1 else self.weighted_error


def slow_pole(plant: Block, count: int) -> float:
    """Return the geometric mean of so many of the slowest poles off the origin [rad/s].

    Of sway and yaw there are two, of surge one. Lags of thrusters, which are faster, are left out.
    """
    sizes = np.sort(np.abs(plant.poles))
    return float(np.exp(np.mean(np.log(sizes[sizes > AT_ORIGIN * sizes[-1]][:count]))))


def heading_step(craft: SteeredCraft, gains: ArduPilotGains, scale: float) -> StepResponse:
    """Return the craft's change of heading by 30 degrees from a straight course at cruising speed.

    scale: rad/s, slow poles of the plant.
    """
    horizon = _HORIZON / scale + HEADING_STEP / gains.rate_max
    time, states, inputs = simulate_controlled(craft, gains, horizon, heading=HEADING_STEP)
    place = craft.model.input_names.index(craft.ship.actuator)
    orders = (inputs[:, place] - craft.ship.inputs[place]) / craft.full_steering
    psi = craft.model.states.index("psi")
    return _response(time, states[:, psi] - craft.ship.state[psi], orders, HEADING_STEP)


def speed_step(craft: SteeredCraft, gains: ArduPilotGains) -> StepResponse:
    """Return the craft's change of speed by a fifth of the cruising speed, on a straight course."""
    step = SPEED_STEP * craft.speed
    horizon = _HORIZON / slow_pole(craft.speed_plant, 1) + abs(step) / gains.speed_acceleration
    time, states, inputs = simulate_controlled(craft, gains, horizon, speed=craft.speed + step)
    orders = inputs[:, craft.model.input_names.index(craft.throttle)] / craft.full_throttle
    return _response(time, states[:, craft.model.states.index("u")] - craft.speed, orders, step)


def _response(time: Array, value: Array, orders: Array, step: float) -> StepResponse:
    if not np.isfinite(value).all():
        return StepResponse(time, value, step, math.inf, math.nan, math.nan, math.nan)
    demand = np.full(len(time), step)
    demand[0] = 0.0
    error = time * np.abs(demand - value)
    return StepResponse(
        time, value, step, relative_overshoot(value, demand, (1,)), settling_time(value, demand, (1,), time[1]),
        float(np.trapezoid(error, time)), float(np.max(np.abs(orders))),
    )  # fmt: skip


# Gains for ArduPilot: of a grid with enough margin, those whose simulated step on the identified craft is best.

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
