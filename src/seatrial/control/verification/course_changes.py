"""Changes of an ordered output verified: overshoot, settling and work of the actuator against ships the fit allows.

What weather makes of a change is taken from the log itself: the motion while the order stood still is laid, from random
moments on, over what the model does. The prediction is the median of such changes on ships drawn from the fit, its
interval holds 95 % of them; what was achieved lies inside or outside.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

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
from seatrial.control.verification.followed_gains import FollowedGains, GainTest, followed_gains
from seatrial.control.verification.logged_changes import LoggedChange, logged_changes
from seatrial.core.results.verification import VerifiedChange, VerifiedQuantity
from seatrial.core.values import Array, InputError, Record, frozen
from seatrial.core.values.notation import channel_unit
from seatrial.physics.loops import TransferLoop
from seatrial.physics.simulate.closed_loop import ActuatorLimits, simulation_step, steps_a_sample

SHIPS, WEATHERS = 40, 10  # ships drawn from the fit, and moments of the log's weather for each; chosen
_STEP_SHARE = 0.2  # step of a simulation as a share of the fastest pole's time constant; chosen
_ROUNDING = 1e-9  # of a sample
# logarithm of the factor by which less of the motion is left where stops explain it; a half; chosen
_EXPLAINED = math.log(2.0)
_SHORT_OF_LIMIT = 0.9  # of the declared limit, beyond which an actuator that stops has met it; chosen
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
    gains: GainTest


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
    worn = (_worn(logged, some, weather, rng) for some in answers)
    simulated = np.array([followed_gains(task, loop, one).statistics for one in worn])
    changes = tuple(
        _verified_change(c, a, _judged(c, a, demand), row, loop)
        for c, a, row in zip(logged, nominal, achieved, strict=True)
    )
    return ChangeLog(changes, quantities, _gain_test(task, loop, logged, GainTest(followed, simulated)))


def _worn(
    logged: Sequence[LoggedChange], answers: Sequence[_Answer], weather: Sequence[Array], rng: np.random.Generator
) -> list[LoggedChange]:
    """Return the changes of a log as a simulated ship would have made them in the log's weather."""
    met = (_in_weather(one, weather, rng) for one in answers)
    return [replace(c, output=a.output, actuator=a.actuator) for c, a in zip(logged, met, strict=True)]


def _gain_test(task: TuningTask, loop: TransferLoop, logged: Sequence[LoggedChange], declared: GainTest) -> GainTest:
    """Return the test with an actuator that stops short of its limit, where that explains half of what is left."""
    moved = np.concatenate([change.actuator + change.trim for change in logged])
    stops = float(moved.min()), float(moved.max())
    if max(map(abs, stops)) > _SHORT_OF_LIMIT * task.constraints.limit:
        return declared
    # what gains order is known but for what their integral held before: stops count from zero, or from the mean
    for held in (0.0, logged[0].trim):
        followed = followed_gains(task, loop, logged, (stops[0] - held, stops[1] - held))
        stopped = replace(declared, followed=followed, stops=stops)
        explained = float(declared.followed.statistics[1] - followed.statistics[1])
        if stopped.is_alike and explained > _EXPLAINED:
            return stopped
    return declared


def _loop_of_log(task: TuningTask, gains: Array, logged: Sequence[LoggedChange]) -> tuple[TransferLoop, FollowedGains]:
    """Return the loop that was on, of those of the task with these gains: what the actuator follows best."""
    alike = [one for one in (task.loop, *task.extended_structures) if one.gains.names == task.loop.gains.names]
    loops = [one.with_gains(gains) for one in alike]
    followed = [followed_gains(task, one, logged) for one in loops]
    best = max(range(len(loops)), key=lambda place: followed[place].coherence)
    return loops[best], followed[best]


def _answer(task: TuningTask, ship: TrimmedShip, loop: TransferLoop, gains: Array, change: LoggedChange) -> _Answer:
    """Return what a ship does with the change as it was ordered, without weather, by the loop as it samples."""
    demand: Demand = task.demand  # type: ignore[assignment]
    loop = _without_noise(loop)
    moving = loop.closed_loop_poles if loop.sampling is None else loop.plant.poles
    dt = simulation_step(loop.sampling, min(change.dt, _STEP_SHARE / float(np.abs(moving).max())))
    every = 1 if loop.sampling is None else steps_a_sample(loop.sampling, dt)
    at = change.dt * np.arange(len(change.order))
    time = dt * np.arange(math.ceil(at[-1] / dt) + 1)
    seen = time[::every]
    if change.is_step:
        order = change.order[np.minimum(np.ceil(seen / change.dt - _ROUNDING).astype(int), len(at) - 1)]
        motion = reference_model(order, every * dt, demand.time_constant, reference_rate(task, loop, demand))
        sampled, fed = motion.level, motion.fed_forward(feed_forward(loop, demand))
    else:
        sampled, fed = np.interp(seen, at, change.order), np.zeros(len(seen))
    level, fed = (np.repeat(one, every)[: len(time)] for one in (sampled, fed))
    limits = ActuatorLimits(task.constraints.limit, task.constraints.rate)
    output, moved = simulate_tracking(ship, loop, gains, limits, dt, level, fed)
    return _Answer(np.interp(at, time, output - output[0]), np.interp(at, time, moved - moved[0]))


def _without_noise(loop: TransferLoop) -> TransferLoop:
    """Return the loop with a sensor without errors: what those of the log do is part of its weather."""
    if loop.sampling is None:
        return loop
    return replace(loop, sampling=replace(loop.sampling, noise=0.0, resolution=0.0))


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
