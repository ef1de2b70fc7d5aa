"""Changes of an ordered output verified: overshoot, settling and work of the actuator against ships the fit allows.

What weather makes of a change is taken from the log itself: the motion while the order stood still is laid, from random
moments on, over what the model does. The prediction is the median of such changes on ships drawn from the fit, its
interval holds 95 % of them; what was achieved lies inside or outside.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.control.demand import (
    feed_forward,
    reference_model,
    reference_rate,
    relative_overshoot,
    settling_time,
    simulate_tracking,
)
from seatrial.control.ship.parameter_draws import draw_parameters
from seatrial.control.ship.plant_as_model import plant_as_model
from seatrial.control.task import Demand, TrimmedShip, TuningTask
from seatrial.control.verification.followed_gains import FollowedGains, followed_gains
from seatrial.control.verification.logged_changes import LoggedChange, logged_changes
from seatrial.core.results.verification import VerifiedChange, VerifiedQuantity
from seatrial.core.values import Array, InputError, Record, frozen
from seatrial.core.values.channel_text import channel_unit
from seatrial.physics.loops import TransferLoop
from seatrial.physics.loops.autopilot import FeedForward
from seatrial.physics.simulate.closed_loop import ActuatorLimits

SHIPS, WEATHERS = 40, 10  # ships drawn from the fit, and moments of the log's weather for each; chosen
_STEP_SHARE = 0.2  # step of a simulation as a share of the fastest pole's time constant; chosen
_SMOOTHING = 0.5  # time constants of the reference over which waves are averaged before a motion is judged; chosen
_TAILS = (0.025, 0.5, 0.975)  # quantiles of the prediction: 95 % interval and median
_SETTLED = 1.5  # settling times by the model after which the log shows weather alone; chosen
_LEAST_BACKGROUND = 20  # samples of weather; chosen


@dataclass(frozen=True, eq=False)
class _Answer:
    """Output and actuator about what was held before, (n,)."""

    output: Array
    actuator: Array


@dataclass(frozen=True, eq=False)
class ChangeLog:
    """What the changes of a log show; fields as of `Verification`."""

    changes: tuple[VerifiedChange, ...]
    quantities: tuple[VerifiedQuantity, ...]
    followed: FollowedGains


def verify_changes(task: TuningTask, gains: Array, records: Sequence[Record], seed: int = 0) -> ChangeLog:
    """Return what the records show of a loop with the gains (g,) that follows the task's demand.

    seed: of the ships drawn and of the moments of the weather.

    Raises:
        InputError: no demand in the task, or no change in the log.
    """
    if task.demand is None:
        raise InputError(f"tuning '{task.name}' follows no demand; add [demand]")
    demand = task.demand
    logged = logged_changes(records, task.loop, demand)
    loop, followed = _loop_of_log(task, gains, logged)
    ship = task.trimmed_ship or plant_as_model(loop)
    drawn = draw_parameters(ship, SHIPS, seed).ships
    nominal = [_answer(task, ship, loop, gains, one) for one in logged]
    settling = [_judged(c, a, demand)[1] for c, a in zip(logged, nominal, strict=True)]
    backgrounds = (c.background(_SETTLED * s) for c, s in zip(logged, settling, strict=True))
    weather = [one for one in backgrounds if len(one) >= _LEAST_BACKGROUND]
    if not weather:
        longest = _SETTLED * max(settling)
        raise InputError(
            f"the changes end before they settle, so that nothing shows what weather does; log {longest:.0f} s and "
            "some minutes after each order"
        )
    answers = [[_answer(task, one, loop, gains, change) for change in logged] for one in drawn] or [nominal]
    rng = np.random.default_rng(seed)
    repeats = math.ceil(SHIPS * WEATHERS / len(answers))
    sampled = np.array([
        np.mean([_judged(c, _in_weather(a, weather, rng), demand) for c, a in zip(logged, some, strict=True)], axis=0)
        for some in answers for _ in range(repeats)
    ])  # fmt: skip
    achieved = np.array([_judged(c, _Answer(c.output, c.actuator), demand) for c in logged])
    mover = channel_unit(loop.actuator)
    names = (("overshoot", "1"), ("settling time", "s"), ("actuator rms", mover), ("actuator rate rms", f"{mover}/s"))
    quantities = tuple(
        _quantity(name, unit, sampled[:, k], float(np.mean(achieved[:, k]))) for k, (name, unit) in enumerate(names)
    )
    changes = tuple(
        _verified_change(c, a, _judged(c, a, demand), row, loop)
        for c, a, row in zip(logged, nominal, achieved, strict=True)
    )
    return ChangeLog(changes, quantities, followed)


def _loop_of_log(task: TuningTask, gains: Array, logged: Sequence[LoggedChange]) -> tuple[TransferLoop, FollowedGains]:
    """Return the loop that was on, of those of the task with these gains: what the actuator follows best."""
    alike = [one for one in (task.loop, *task.extended_structures) if one.gains.names == task.loop.gains.names]
    loops = [one.with_gains(gains) for one in alike]
    followed = [followed_gains(task, one, logged) for one in loops]
    best = max(range(len(loops)), key=lambda place: followed[place].coherence)
    return loops[best], followed[best]


def _answer(task: TuningTask, ship: TrimmedShip, loop: TransferLoop, gains: Array, change: LoggedChange) -> _Answer:
    """Return what a ship does with the change as it was ordered, without weather."""
    demand: Demand = task.demand  # type: ignore[assignment]
    loop = loop.continuous
    fastest = float(np.abs(loop.closed_loop_poles).max())
    parts = max(1, math.ceil(change.dt * fastest / _STEP_SHARE))
    count, dt = (len(change.order) - 1) * parts + 1, change.dt / parts
    order = np.repeat(change.order, parts)[parts - 1 :]
    rate = reference_rate(task, loop, demand) if change.is_step else math.inf
    motion = reference_model(order, dt, demand.time_constant, rate)
    level, law = motion.level, FeedForward(0.0, 0.0, 0.0)
    if change.is_step:
        law = feed_forward(loop, demand)
    else:
        level = np.interp(np.arange(count), parts * np.arange(len(change.order)), change.order)
    limits = ActuatorLimits(task.constraints.limit, task.constraints.rate)
    output, moved = simulate_tracking(ship, loop, gains, limits, dt, level, motion.fed_forward(law))
    return _Answer((output - output[0])[::parts], (moved - moved[0])[::parts])


def _in_weather(answer: _Answer, weather: Sequence[Array], rng: np.random.Generator) -> _Answer:
    """Return the answer with one of the log's stretches of weather (m, 2), from a random moment on, to and fro."""
    stretch = weather[int(rng.integers(len(weather)))]
    mirrored = np.concatenate([stretch, stretch[::-1]])
    rows = (int(rng.integers(len(mirrored))) + np.arange(len(answer.output))) % len(mirrored)
    return _Answer(answer.output + mirrored[rows, 0], answer.actuator + mirrored[rows, 1])


def _judged(change: LoggedChange, answer: _Answer, demand: Demand) -> tuple[float, float, float, float]:
    """Return overshoot [share], settling [s], rms of the actuator and of its rate [SI] of one change.

    One that never settles counts with its whole length.
    """
    output = _smoothed(answer.output, round(_SMOOTHING * demand.time_constant / change.dt))
    settled = settling_time(output, change.demand, (1,), change.dt)
    rate = np.diff(answer.actuator) / change.dt
    return (
        relative_overshoot(output, change.demand, (1,)),
        change.dt * len(change.order) if math.isnan(settled) else settled,
        float(np.sqrt(np.mean(answer.actuator**2))), float(np.sqrt(np.mean(rate**2))),
    )  # fmt: skip


def _smoothed(values: Array, width: int) -> Array:
    """Return the moving mean over `width` samples, ends repeated, (n,)."""
    if width < 2:
        return values
    padded = np.pad(values, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")


def _quantity(name: str, unit: str, sampled: Array, achieved: float) -> VerifiedQuantity:
    low, middle, high = np.quantile(sampled, _TAILS).tolist()
    return VerifiedQuantity(name, unit, middle, low, high, achieved, math.nan, math.nan, low <= achieved <= high)


def _verified_change(
    change: LoggedChange, nominal: _Answer, predicted: Sequence[float], achieved: Array, loop: TransferLoop
) -> VerifiedChange:
    return VerifiedChange(
        change.record, change.start, change.change, predicted[0], float(achieved[0]), predicted[1], float(achieved[1]),
        loop.output, loop.actuator, change.dt,
        *(frozen(np.ascontiguousarray(v)) for v in (
            change.order, change.output, nominal.output, change.actuator, nominal.actuator)),
    )  # fmt: skip
