"""A demand carried out: a change and a zigzag by the nonlinear model within its limits, and by ships the fit allows."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from seatrial.control.ship.parameter_draws import DRAWS, draw_parameters, stable_draws
from seatrial.control.ship.plant_as_model import plant_as_model
from seatrial.control.task import Demand, TrimmedShip, TuningTask
from seatrial.core.results.tuning import ManoeuvreResponse
from seatrial.core.values import (
    NOTATION,
    Array,
    Channel,
    DivergedError,
    InputError,
    Provenance,
    Record,
    RecordKind,
    frozen,
)
from seatrial.physics.loops import TransferLoop
from seatrial.physics.loops.autopilot import START, FeedForward, acceleration_feed_forward, working_frequency
from seatrial.physics.simulate.closed_loop import REFERENCE, ActuatorLimits, ClosedLoop, simulation_step, steps_a_sample

DEMAND = "demand"
_SHOWN_DRAWS, _SAMPLES = 20, 1000  # sampled ships and samples in time that a figure shows; chosen
# steps of a simulation, and its step as a share of the fastest pole's time constant; chosen
_FEWEST_STEPS, _MOST_STEPS, _STEP_SHARE = 1000, 20_000, 0.2
_SETTLING_BAND = 0.05  # share of the change: the usual 5 % settling band
_LEGS = 4  # of the zigzag: two to either side; chosen
_SLOWEST_POLE = 1e-6  # rad/s, taken for a loop without states
_CHANGE_NAMES = {"psi": "course change", "u": "speed change"}


@dataclass(frozen=True, eq=False)
class _Programme:
    """A demand (n,) and what the loop follows (n,), about the trim, every dt; its steps at `step_samples`.

    fed_forward: (n,), what the reference alone orders of the actuator.
    """

    name: str
    dt: float
    demand: Array
    reference: Array
    fed_forward: Array
    step_samples: tuple[int, ...]
    is_to_settle: bool


def simulate_manoeuvres(
    task: TuningTask, loop: TransferLoop, name: str, gains: Array, seed: int, draws: int = DRAWS
) -> tuple[ManoeuvreResponse, ...]:
    """The task's change of the output, and a zigzag about the trim of half of it to either side, with the gains (g,).

    Ships are drawn from the covariance of the fit; one that has no trim counts as not stable. Where one is not, or
    diverges, the worst overshoot is infinite. A task without a model behind its plant is simulated from its transfer
    functions.
    """
    ship = task.trimmed_ship or plant_as_model(loop)
    drawn = draw_parameters(ship, draws, seed)
    stable = sum(drawn.stable_ships(loop, gains)), drawn.draws
    limits = ActuatorLimits(task.constraints.limit, task.constraints.rate)
    return tuple(
        _simulate_manoeuvre(one, ship, loop, name, gains, limits, drawn.ships, stable)
        for one in _programmes(task, loop, gains, task.required_demand)
    )


def shortfall(task: TuningTask, loop: TransferLoop, gains: Array, *, draws: int = DRAWS) -> tuple[float, str]:
    """How far the gains (g,) are from following the task's change, to be compared, and why; 0 and nothing if they do.

    Every ship drawn is to be stable; the identified one settles within 5 % and overshoots no more than allowed.
    """
    asked = task.required_demand
    stable, drawn = stable_draws(task, gains, loop, draws=draws)
    lost = drawn - stable
    try:
        change = simulate_manoeuvres(task, loop, "", gains, 0, draws=0)[0]
    except DivergedError:
        return 100.0 + lost, "the simulation of the identified ship diverges"
    beyond = max(change.overshoot - asked.overshoot, 0.0)
    is_slow = not change.settling <= asked.settling
    why = [f"{lost} of {drawn} ships that the fit allows are not stable"] if lost else []
    why += [_slowness_text(change.settling)] if is_slow else []
    why += [f"it overshoots by {100.0 * change.overshoot:.1f} %"] if beyond else []
    return lost + float(is_slow) + beyond, " and ".join(why)


def _slowness_text(settling: float) -> str:
    if math.isnan(settling):
        return "the change does not settle within 5 %"
    return f"the change takes {settling:.3g} s to settle within 5 %"


def simulate_tracking(
    ship: TrimmedShip,
    loop: TransferLoop,
    gains: Array,
    limits: ActuatorLimits,
    dt: float,
    reference: Array,
    fed_forward: Array | None = None,
) -> tuple[Array, Array]:
    """Return output and actuator (n,), notation's signs, of a ship that follows a reference (n,) about its trim.

    fed_forward: (n,), added to the actuator's order.
    """
    model = ship.model
    place, rudder = model.states.index(ship.output), model.input_names.index(ship.actuator)
    sign = -1.0 if model.inputs[rudder].is_reversed else 1.0
    closed = ClosedLoop(model, loop, gains, dt, ship.actuator, "", ship.output, ship.state, ship.inputs)
    states, moved = closed.run(np.zeros(len(reference)), limits, ship.state[place] + reference, fed_forward)
    return states[:, place], sign * ship.inputs[rudder] + moved


@dataclass(frozen=True, eq=False)
class ReferenceMotion:
    """What a loop follows in place of steps: level, velocity and acceleration, each (n,)."""

    level: Array
    velocity: Array
    acceleration: Array

    def fed_forward(self, law: FeedForward) -> Array:
        """Return what the law orders of the actuator, (n,)."""
        return law.level * self.level + law.velocity * self.velocity + law.acceleration * self.acceleration


def reference_model(demand: Array, dt: float, time_constant: float, rate: float = math.inf) -> ReferenceMotion:
    """Follow steps (n,) by x'' + 2 w x' + w^2 x = w^2 r, w = 1 / time_constant, |x'| <= rate.

    Critically damped, with saturating rate (Fossen 2021, Handbook, section 12.1, reference models).
    """
    w, rows = 1.0 / time_constant, np.empty((3, len(demand)))
    (stay, carry), (pull, damp) = expm(np.array([[0.0, 1.0], [-(w**2), -2.0 * w]]) * dt).tolist()
    x, v = 0.0, 0.0
    for k, r in enumerate(demand.tolist()):
        away, speed = stay * (x - r) + carry * v, pull * (x - r) + damp * v
        acceleration = -(w**2) * (x - r) - 2.0 * w * v
        if abs(speed) > rate:
            speed = math.copysign(rate, speed)
            away = x - r + 0.5 * (v + speed) * dt
            acceleration = (speed - v) / dt
        rows[:, k] = x, v, acceleration
        x, v = r + away, speed
    return ReferenceMotion(*rows)


def relative_overshoot(output: Array, demand: Array, step_samples: tuple[int, ...]) -> float:
    """Largest share of a step of the demand by which the output exceeds it before the next, 0 or more; all (n,)."""
    worst = 0.0
    for first, last in zip(step_samples, (*step_samples[1:], len(demand)), strict=True):
        step = demand[first] - (demand[first - 1] if first else 0.0)
        worst = max(worst, float(np.max((output[first:last] - demand[first]) / step)))
    return worst


def settling_time(output: Array, demand: Array, step_samples: tuple[int, ...], dt: float) -> float:
    """s from a step of the demand until the output stays within 5 % of it, the slowest; NaN if one never does."""
    slowest = 0.0
    for first, last in zip(step_samples, (*step_samples[1:], len(demand)), strict=True):
        step = abs(demand[first] - (demand[first - 1] if first else 0.0))
        outside = np.flatnonzero(np.abs(output[first:last] - demand[first]) > _SETTLING_BAND * step)
        if outside.size and outside[-1] == last - first - 1:
            return math.nan
        slowest = max(slowest, (outside[-1] + 1) * dt if outside.size else 0.0)
    return slowest


def _programmes(task: TuningTask, loop: TransferLoop, gains: Array, demand: Demand) -> tuple[_Programme, ...]:
    dt, every = _clock(loop.with_gains(gains), demand)
    legs = max(1, math.ceil(demand.duration / (every * dt * _LEGS)))
    count, rate = legs * every * _LEGS, reference_rate(task, loop, demand)
    change, zigzag = np.full(count + 1, demand.change), np.empty(count + 1)
    change[:every] = 0.0
    begun = tuple(max(every, count * leg // _LEGS) for leg in range(_LEGS))
    zigzag[:every] = 0.0
    for leg, first in enumerate(begun):
        zigzag[first:] = 0.5 * demand.change * (-1.0) ** leg
    law = feed_forward(loop, demand)

    def programme(name: str, steps: Array, legs: tuple[int, ...], *, is_to_settle: bool) -> _Programme:
        motion = reference_model(steps[::every], every * dt, demand.time_constant, rate)
        level, fed = (np.repeat(one, every)[: count + 1] for one in (motion.level, motion.fed_forward(law)))
        return _Programme(name, dt, steps, level, fed, legs, is_to_settle)

    changed = _CHANGE_NAMES.get(loop.output, f"change of {loop.output}")
    return (
        programme(changed, change, (every,), is_to_settle=True),
        programme("zigzag", zigzag, begun, is_to_settle=False),
    )


def _clock(loop: TransferLoop, demand: Demand) -> tuple[float, int]:
    """Return the step [s] of a simulation, and how many of them stand between two samples of the controller.

    Short for everything that moves; one in continuous time is sampled at every step.
    """
    moving = np.abs(loop.closed_loop_poles) if loop.sampling is None else np.abs(loop.plant.poles)
    fastest = float(moving.max(initial=_SLOWEST_POLE))
    count = int(np.clip(math.ceil(demand.duration * fastest / _STEP_SHARE), _FEWEST_STEPS, _MOST_STEPS))
    dt = simulation_step(loop.sampling, demand.duration / count)
    return dt, 1 if loop.sampling is None else steps_a_sample(loop.sampling, dt)


def feed_forward(loop: TransferLoop, demand: Demand) -> FeedForward:
    """Return what of the reference a demand adds to the actuator's order; nothing where it feeds nothing forward."""
    if not demand.feeds_forward:
        return FeedForward(0.0, 0.0, 0.0)
    return acceleration_feed_forward(loop.plant, 1.0 / demand.time_constant)


def reference_rate(task: TuningTask, loop: TransferLoop, demand: Demand) -> float:
    """Return the rate of the output that half the actuator's limit keeps up, at the reference's frequency.

    At most at the first bandwidth of the gains: faster references are not followed in any case.
    """
    omega = min(1.0 / demand.time_constant, START * working_frequency(loop.plant))
    return 0.5 * task.constraints.limit * omega * float(np.abs(loop.plant.frequency_response(np.array([omega])))[0])


def _simulate_manoeuvre(
    programme: _Programme, ship: TrimmedShip, loop: TransferLoop, controller: str, gains: Array, limits: ActuatorLimits,
    drawn_ships: tuple[TrimmedShip, ...], stable_and_drawn: tuple[int, int],
) -> ManoeuvreResponse:  # fmt: skip
    trim = _trim(ship)
    output, moved = simulate_tracking(
        ship, loop, gains, limits, programme.dt, programme.reference, programme.fed_forward
    )
    answers = [_output_about_trim(one, loop, gains, limits, programme) for one in drawn_ships]
    is_lost = stable_and_drawn[0] < stable_and_drawn[1] or any(a is None for a in answers)
    worst = max(
        (relative_overshoot(a, programme.demand, programme.step_samples) for a in answers if a is not None),
        default=math.nan,
    )
    every = math.ceil(len(output) / _SAMPLES)
    shown = [trim + a[::every] for a in answers if a is not None][:_SHOWN_DRAWS]
    drawn_answers = np.array(shown).reshape(len(shown), len(output[::every]))
    series = {
        loop.output: output,
        loop.actuator: moved,
        REFERENCE: trim + programme.reference,
        DEMAND: trim + programme.demand,
    }
    return ManoeuvreResponse(
        name=programme.name,
        controller=controller,
        record=_record(f"{programme.name}, {controller}", programme.dt * every, series, loop, every),
        output=loop.output,
        overshoot=relative_overshoot(output - trim, programme.demand, programme.step_samples),
        settling=settling_time(output - trim, programme.demand, programme.step_samples, programme.dt),
        stable_draws=stable_and_drawn[0],
        draws=stable_and_drawn[1],
        worst_overshoot=math.inf if is_lost else worst,
        sampled_outputs=frozen(drawn_answers),
        is_to_settle=programme.is_to_settle,
    )


def _trim(ship: TrimmedShip) -> float:
    return float(ship.state[ship.model.states.index(ship.output)])


def _output_about_trim(
    ship: TrimmedShip, loop: TransferLoop, gains: Array, limits: ActuatorLimits, programme: _Programme
) -> Array | None:
    """Return the output about the trim (n,); None where the simulation diverges."""
    try:
        answer = simulate_tracking(ship, loop, gains, limits, programme.dt, programme.reference, programme.fed_forward)
        return answer[0] - _trim(ship)
    except InputError:
        return None


def _record(name: str, dt: float, series: dict[str, Array], loop: TransferLoop, every: int) -> Record:
    channels = {}
    for symbol, values in series.items():
        like = loop.output if symbol in (REFERENCE, DEMAND) else symbol
        some = frozen(np.ascontiguousarray(values[::every]))
        channels[symbol] = Channel.from_notation(like, some) if like in NOTATION else Channel(some, "1", "none", "none")
    count = len(next(iter(channels.values())).values)
    said = Provenance(f"loop '{loop.name}' following a demand")
    return Record(name, frozen(dt * np.arange(count)), channels, RecordKind.SIMULATED, provenance=said)
