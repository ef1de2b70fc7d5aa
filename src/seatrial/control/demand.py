"""A demand carried out: a change and a zigzag by the nonlinear model within its limits, and by ships the fit allows."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from seatrial.control.ship.fleet import DRAWS, fleet, robust
from seatrial.control.ship.stand_in import stand_in
from seatrial.control.task import Demand, Task, Vessel
from seatrial.core.results.tuning import Manoeuvre
from seatrial.core.values import NOTATION, Array, Channel, DivergedError, InputError, Kind, Provenance, Record, frozen
from seatrial.physics.loops import TransferLoop
from seatrial.physics.loops.autopilot import mean_pole
from seatrial.physics.simulate.closed_loop import REFERENCE, ActuatorLimits, ClosedLoop

DEMAND = "demand"
_SHOWN, _SAMPLES = 20, 1000
_FEWEST, _MOST, _FINE = 1000, 20_000, 0.2
_WITHIN = 0.05
_LEGS = 4
_NAMES = {"psi": "course change", "u": "speed change"}


@dataclass(frozen=True, eq=False)
class _Programme:
    """A demand (n,) and what the loop follows (n,), about the trim, every dt; its steps are at the samples `begun`."""

    name: str
    dt: float
    demand: Array
    reference: Array
    begun: tuple[int, ...]


def manoeuvres(
    task: Task, loop: TransferLoop, name: str, gains: Array, seed: int, draws: int = DRAWS
) -> tuple[Manoeuvre, ...]:
    """The task's change of the output, and a zigzag about the trim of half of it to either side, with the gains (g,).

    Ships are drawn from the covariance of the fit; one that has no trim counts as not stable. Where one is not, or
    runs away, the worst overshoot is infinite. A task without a model behind its plant is simulated from its transfer
    functions.

    Raises:
        InputError: the task has no demand.
        DivergedError: the loop runs away on the identified ship itself.
    """
    demand = _demanded(task)
    ship = task.vessel or stand_in(loop)
    drawn = fleet(ship, draws, seed)
    stable = drawn.stable(loop, gains)
    limits = ActuatorLimits(task.restriction.limit, task.restriction.rate)
    return tuple(
        _carried_out(one, ship, loop, name, gains, limits, drawn.ships, (sum(stable), drawn.draws))
        for one in _programmes(task, loop, gains, demand)
    )


def shortfall(task: Task, loop: TransferLoop, gains: Array, *, draws: int = DRAWS) -> tuple[float, str]:
    """How far the gains (g,) are from following the task's change, to be compared, and why; 0 and nothing if they do.

    Every ship drawn is to be stable; the identified one settles within 5 % and overshoots no more than allowed.

    Raises:
        InputError: the task has no demand.
    """
    asked = _demanded(task)
    stable, drawn = robust(task, gains, loop, draws=draws)
    lost = drawn - stable
    try:
        change = manoeuvres(task, loop, "", gains, 0, draws=0)[0]
    except DivergedError:
        return 100.0 + lost, "the identified ship runs away"
    beyond = max(change.overshoot - asked.overshoot, 0.0)
    is_slow = math.isnan(change.settling)
    why = [f"{lost} of {drawn} ships that the fit allows are not stable"] if lost else []
    why += ["the change does not settle within 5 %"] if is_slow else []
    why += [f"it overshoots by {100.0 * change.overshoot:.1f} %"] if beyond else []
    return lost + float(is_slow) + beyond, " and ".join(why)


def follow(
    ship: Vessel, loop: TransferLoop, gains: Array, limits: ActuatorLimits, dt: float, reference: Array
) -> tuple[Array, Array]:
    """Output and actuator (n,), notation's signs, of a ship that follows a reference (n,) about her trim.

    Raises:
        DivergedError: she runs away.
    """
    model = ship.model
    place, of = model.states.index(ship.output), model.input_names.index(ship.actuator)
    sign = -1.0 if model.inputs[of].is_turned else 1.0
    made = ClosedLoop(model, loop, gains, dt, ship.actuator, "", ship.output, ship.state, ship.inputs)
    states, moved = made.run(np.zeros(len(reference)), limits, ship.state[place] + reference)
    return states[:, place], sign * ship.inputs[of] + moved


def reference_model(demand: Array, dt: float, time_constant: float, rate: float = math.inf) -> Array:
    """What a loop follows in place of steps: x'' + 2 w x' + w^2 x = w^2 r, w = 1 / time_constant, |x'| <= rate; (n,).

    Critically damped, with saturating rate (Fossen 2021, Handbook, section 12.1, reference models).
    """
    w, made = 1.0 / time_constant, np.empty(len(demand))
    (stay, carry), (pull, damp) = expm(np.array([[0.0, 1.0], [-(w**2), -2.0 * w]]) * dt).tolist()
    x, v = 0.0, 0.0
    for k, r in enumerate(demand.tolist()):
        made[k] = x
        away, speed = stay * (x - r) + carry * v, pull * (x - r) + damp * v
        if abs(speed) > rate:
            speed = math.copysign(rate, speed)
            away = x - r + 0.5 * (v + speed) * dt
        x, v = r + away, speed
    return made


def overshoot(output: Array, demand: Array, begun: tuple[int, ...]) -> float:
    """Largest share of a step of the demand by which the output exceeds it before the next, 0 or more; all (n,)."""
    worst = 0.0
    for first, last in zip(begun, (*begun[1:], len(demand)), strict=True):
        step = demand[first] - (demand[first - 1] if first else 0.0)
        worst = max(worst, float(np.max((output[first:last] - demand[first]) / step)))
    return worst


def settling(output: Array, demand: Array, begun: tuple[int, ...], dt: float) -> float:
    """s from a step of the demand until the output stays within 5 % of it, the slowest; NaN if one never does."""
    slowest = 0.0
    for first, last in zip(begun, (*begun[1:], len(demand)), strict=True):
        step = abs(demand[first] - (demand[first - 1] if first else 0.0))
        outside = np.flatnonzero(np.abs(output[first:last] - demand[first]) > _WITHIN * step)
        if outside.size and outside[-1] == last - first - 1:
            return math.nan
        slowest = max(slowest, (outside[-1] + 1) * dt if outside.size else 0.0)
    return slowest


def _demanded(task: Task) -> Demand:
    if task.demand is None:
        raise InputError(f"tuning '{task.name}' follows no demand; give a change")
    return task.demand


def _programmes(task: Task, loop: TransferLoop, gains: Array, demand: Demand) -> tuple[_Programme, ...]:
    fastest = float(np.abs(loop.with_gains(gains).closed_poles).max(initial=1e-6))
    count = int(np.clip(math.ceil(demand.duration * fastest / _FINE), _FEWEST, _MOST))
    dt, rate = demand.duration / count, _rate(task, loop, demand)
    change, zigzag = np.full(count + 1, demand.change), np.empty(count + 1)
    change[0] = 0.0
    begun = tuple(max(1, count * leg // _LEGS) for leg in range(_LEGS))
    zigzag[0] = 0.0
    for leg, first in enumerate(begun):
        zigzag[first:] = 0.5 * demand.change * (-1.0) ** leg
    made = ((_NAMES.get(loop.output, f"change of {loop.output}"), change, (1,)), ("zigzag", zigzag, begun))
    return tuple(
        _Programme(name, dt, steps, reference_model(steps, dt, demand.time_constant, rate), legs)
        for name, steps, legs in made
    )


def _rate(task: Task, loop: TransferLoop, demand: Demand) -> float:
    """Rate of the output that half the actuator's limit keeps up, at the mean of the plant's poles or more slowly."""
    omega = 1.0 / demand.time_constant
    if np.any(loop.plant.poles != 0.0):
        omega = min(omega, mean_pole(loop.plant))
    return 0.5 * task.restriction.limit * omega * float(np.abs(loop.plant.at(np.array([omega])))[0])


def _carried_out(
    asked: _Programme, ship: Vessel, loop: TransferLoop, controller: str, gains: Array, limits: ActuatorLimits,
    drawn: tuple[Vessel, ...], stable: tuple[int, int],
) -> Manoeuvre:  # fmt: skip
    trim = _trim(ship)
    output, moved = follow(ship, loop, gains, limits, asked.dt, asked.reference)
    answers = [_answer(one, loop, gains, limits, asked) for one in drawn]
    is_lost = stable[0] < stable[1] or any(a is None for a in answers)
    worst = max((overshoot(a, asked.demand, asked.begun) for a in answers if a is not None), default=math.nan)
    every = math.ceil(len(output) / _SAMPLES)
    shown = [trim + a[::every] for a in answers if a is not None][:_SHOWN]
    drawn_answers = np.array(shown).reshape(len(shown), len(output[::every]))
    series = {loop.output: output, loop.actuator: moved, REFERENCE: trim + asked.reference, DEMAND: trim + asked.demand}
    return Manoeuvre(
        name=asked.name,
        controller=controller,
        record=_record(f"{asked.name}, {controller}", asked.dt * every, series, loop, every),
        output=loop.output,
        overshoot=overshoot(output - trim, asked.demand, asked.begun),
        settling=settling(output - trim, asked.demand, asked.begun, asked.dt),
        stable_draws=stable[0],
        draws=stable[1],
        worst_overshoot=math.inf if is_lost else worst,
        drawn=frozen(drawn_answers),
    )


def _trim(ship: Vessel) -> float:
    return float(ship.state[ship.model.states.index(ship.output)])


def _answer(ship: Vessel, loop: TransferLoop, gains: Array, limits: ActuatorLimits, asked: _Programme) -> Array | None:
    """Output about the trim (n,); None where the ship runs away."""
    try:
        return follow(ship, loop, gains, limits, asked.dt, asked.reference)[0] - _trim(ship)
    except InputError:
        return None


def _record(name: str, dt: float, series: dict[str, Array], loop: TransferLoop, every: int) -> Record:
    channels = {}
    for symbol, values in series.items():
        like = loop.output if symbol in (REFERENCE, DEMAND) else symbol
        some = frozen(np.ascontiguousarray(values[::every]))
        channels[symbol] = Channel.of(like, some) if like in NOTATION else Channel(some, "1", "none", "none")
    count = len(next(iter(channels.values())).values)
    said = Provenance(f"loop '{loop.name}' following a demand")
    return Record(name, frozen(dt * np.arange(count)), channels, Kind.SIMULATED, provenance=said)
