"""Changes of an ordered output verified: in a log, by the gains or not, against ships of the fit."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from seatrial.control.controller import (
    feed_forward,
    reference_model,
    reference_rate,
    relative_overshoot,
    settling_time,
    simulate_tracking,
)
from seatrial.control.ship import draw_parameters, plant_as_model
from seatrial.control.task import Demand, TrimmedShip, TuningTask
from seatrial.core.results.verification import VerifiedChange, VerifiedQuantity
from seatrial.core.values import Array, InputError, Record, frozen
from seatrial.core.values.notation import channel_unit
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.simulate.closed_loop import fastest_motion, simulation_step, steps_a_sample

# Changes of an ordered output in a log, and what weather did to the ship while the order stood still.

_SMALLEST = 0.1  # of the demand's change, below which an order is no change but a correction; chosen
_SHORTEST = 6.0  # time constants that a change must last; chosen
_STILL = 1e-6  # of the demand's change from one sample to the next: rounding of a logger


@dataclass(frozen=True, eq=False)
class LoggedChange:
    """One change, from the last sample before it to the last before the next one.

    Order and output are counted from the order before, the actuator from its mean over the second halves of a record.

    Attributes:
        start: s on the record's clock; order, output, actuator: (n,), SI.
        trim: of the actuator, taken off.
        is_step: whether the order jumped; else the log holds what a filter made of it.
    """

    record: str
    start: float
    dt: float
    order: Array
    output: Array
    actuator: Array
    trim: float
    is_step: bool

    @property
    def time(self) -> Array:
        """Return seconds from the order on, (n,)."""
        return np.asarray(self.dt * np.arange(len(self.order)), dtype=np.float64)

    @property
    def change(self) -> float:
        """Return by how much the order changed, SI."""
        return float(self.order[-1])

    @property
    def demand(self) -> Array:
        """Return the change as a step at the second sample, (n,)."""
        return np.concatenate([[0.0], np.full(len(self.order) - 1, self.change)])

    def background(self, settled_s: float) -> Array:
        """Return the output about its order and the actuator from so many seconds after the order on, (m, 2)."""
        return np.stack([self.output - self.change, self.actuator], axis=1)[round(settled_s / self.dt) :]


def logged_changes(records: Sequence[Record], loop: TransferLoop, demand: Demand) -> tuple[LoggedChange, ...]:
    """Return the changes of the ordered output that are large and long enough.

    Raises:
        InputError: a channel is missing or has gaps, or there is no such change.
    """
    ordered = f"{loop.output}_ref"
    channels = (loop.output, loop.actuator, ordered)
    changes = []
    for record in records:
        if missing := [name for name in channels if name not in record]:
            raise InputError(
                f"record '{record.name}' has no channel '{missing[0]}'; changes of '{loop.output}' are verified by "
                f"{', '.join(channels)}: name their columns in [records.channels]"
            )
        if not np.all(np.isfinite(record.matrix(channels))):
            raise InputError(f"record '{record.name}' has gaps in {', '.join(channels)}; repair them, or cut it there")
        changes += _changes_of_record(record, channels, demand)
    if not changes:
        raise InputError(
            f"the log holds no change of '{ordered}' by {_SMALLEST:g} of that of [demand] or more that lasts "
            f"{_SHORTEST * demand.time_constant:.0f} s, {_SHORTEST:g} time constants; log course changes one by one"
        )
    return tuple(changes)


def _changes_of_record(record: Record, channels: tuple[str, str, str], demand: Demand) -> list[LoggedChange]:
    output, actuator, order = (record[name] for name in channels)
    if channel_unit(channels[0]) == "rad":
        output, order = np.unwrap(output), np.unwrap(order)
    moves = np.flatnonzero(np.abs(np.diff(order)) > _STILL * abs(demand.change))
    if not moves.size:
        return []
    apart = np.flatnonzero(np.diff(moves) * record.dt > demand.time_constant)
    firsts = moves[np.concatenate([[0], apart + 1])].tolist()
    lasts = moves[np.concatenate([apart, [len(moves) - 1]])].tolist()
    spans = [
        (first, stop, moved == first)
        for first, moved, stop in zip(firsts, lasts, [*firsts[1:], len(order) - 1], strict=True)
        if abs(order[stop] - order[first]) >= _SMALLEST * abs(demand.change)
        and (stop - first) * record.dt >= _SHORTEST * demand.time_constant
    ]
    if not spans:
        return []
    trim = float(np.mean(np.concatenate([actuator[(first + stop) // 2 : stop + 1] for first, stop, _ in spans])))
    return [
        LoggedChange(
            record.name, float(record.time[first]), record.dt, order[first : stop + 1] - order[first],
            output[first : stop + 1] - order[first], actuator[first : stop + 1] - trim, trim, is_step,
        )
        for first, stop, is_step in spans
    ]  # fmt: skip


def smoothed(values: Array, width: int) -> Array:
    """Return the moving mean over `width` samples, ends repeated, (n,)."""
    if width < 2:
        return values
    padded = np.pad(values, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")


# Whether an actuator did in a log what the gains order: the loop run on what was measured.

# time constants of the demand over which means run: one that is compared, as a logger's noise is not the controller's,
# and one that is taken off, trim and integral; chosen
_FAST, _SLOW = 0.5, 3.0


_CHANCE = 0.005  # of each of two statistics: together one log in a hundred is blamed by chance; chosen


@dataclass(frozen=True)
class FollowedGains:
    """What the actuator did over what the gains order: factor of its motion, and the coherence of both, 0 to 1."""

    ratio: float
    coherence: float

    @property
    def statistics(self) -> Array:
        """Return ratio and logarithm of the share of the motion that does not follow, (2,): nearly normal both."""
        return np.array([self.ratio, math.log(max(1.0 - self.coherence**2, np.finfo(float).tiny))])


@dataclass(frozen=True)
class GainTest:
    """How the actuator followed in a log, and in simulated logs of ships with these very gains: statistics (m, 2).

    stops: between which the actuator stayed, where they explain the log; None elsewhere.
    """

    followed: FollowedGains
    simulated: Array
    stops: tuple[float, float] | None = None

    @property
    def _off(self) -> Array:
        """Return by how much of what chance explains the statistics differ from the simulated ones, (2,).

        A further one of a sample lies as far from its mean as Student's distribution says (Hahn & Meeker 1991,
        Statistical Intervals, section 4.7).
        """
        m = len(self.simulated)
        sure = float(stdtrit(m - 1, 1.0 - 0.5 * _CHANCE)) * math.sqrt(1.0 + 1.0 / m)
        return (self.followed.statistics - self.simulated.mean(axis=0)) / (sure * self.simulated.std(axis=0, ddof=1))

    @property
    def is_alike(self) -> bool:
        """Whether the actuator's motion has the shape that the gains order, but for what chance explains."""
        return bool(self._off[1] <= 1.0)

    @property
    def is_followed(self) -> bool:
        """Whether it has its size, too."""
        return self.is_alike and bool(abs(self._off[0]) <= 1.0)


def followed_gains(
    task: TuningTask,
    loop: TransferLoop,
    changes: Sequence[LoggedChange],
    stops: tuple[float, float] = (-math.inf, math.inf),
) -> FollowedGains:
    """Return how the actuator of a log follows a loop at its own gains, over all its changes.

    The loop runs on the logged output and reference; both are compared smoothed, slow means taken off.
    """
    pairs = [_order_and_motion(task, loop, change, stops) for change in changes]
    ordered, moved = (np.concatenate(rows) for rows in zip(*pairs, strict=True))
    both, power, theirs = (float(np.sum(a * b)) for a, b in ((ordered, moved), (ordered, ordered), (moved, moved)))
    if not power * theirs:
        return FollowedGains(0.0, 0.0)
    return FollowedGains(both / power, abs(both) / float(np.sqrt(power * theirs)))


def _order_and_motion(
    task: TuningTask, loop: TransferLoop, change: LoggedChange, stops: tuple[float, float]
) -> tuple[Array, Array]:
    """Return where the loop moves the actuator on what was measured, and where it was, smoothed, slow means taken off.

    What was measured disturbs the output of a plant that stands still.
    """
    fast, slow = (max(1, round(share * task.required_demand.time_constant / change.dt)) for share in (_FAST, _SLOW))
    still = plant_as_model(replace(loop, plant=_AT_REST, disturbance=_AT_REST))
    run = _OrderedRun.of_change(task, loop, change)
    error = run.level - np.interp(run.time, change.time, smoothed(change.output, fast))
    moved = run.simulated(task, still, error)[1]
    achieved, motion = (
        smoothed(angle, fast) for angle in (np.clip(np.interp(change.time, run.time, moved), *stops), change.actuator)
    )
    return achieved - smoothed(achieved, slow), motion - smoothed(motion, slow)


_AT_REST = Block("plant that stands still", (0.0,), (1.0, 1.0))


@dataclass(frozen=True, eq=False)
class _OrderedRun:
    """A change in steps of a simulation: the loop without errors of its sensor, what it follows and is fed forward.

    Attributes:
        time: s from the order on; level, fed: (n,), SI.
    """

    loop: TransferLoop
    time: Array
    level: Array
    fed: Array

    @classmethod
    def of_change(cls, task: TuningTask, loop: TransferLoop, change: LoggedChange) -> "_OrderedRun":
        """Return the change as it was ordered, through the reference filter where the order jumped."""
        loop, demand = _without_noise(loop), task.required_demand
        dt = simulation_step(loop.required_sampling, min(change.dt, _STEP_SHARE / fastest_motion(loop)))
        every = steps_a_sample(loop.required_sampling, dt)
        time = dt * np.arange(math.ceil(change.time[-1] / dt) + 1)
        sample_time = time[::every]
        if change.is_step:
            places = np.ceil(sample_time / change.dt - _ROUNDING).astype(int)
            order = change.order[np.minimum(places, len(change.order) - 1)]
            motion = reference_model(order, every * dt, demand.time_constant, reference_rate(task, loop, demand))
            sampled, fed = motion.level, motion.fed_forward(feed_forward(loop, demand))
        else:
            sampled, fed = np.interp(sample_time, change.time, change.order), np.zeros(len(sample_time))
        return cls(loop, time, *(np.repeat(signal, every)[: len(time)] for signal in (sampled, fed)))

    def simulated(self, task: TuningTask, ship: TrimmedShip, level: Array) -> tuple[Array, Array]:
        """Return output and actuator (n,) of a ship that the loop, at its own gains, lets follow a level (n,)."""
        limits, gains, dt = task.actuator_limits.without_stall, self.loop.gain_values, float(self.time[1])
        return simulate_tracking(ship, self.loop, gains, limits, dt, level, self.fed)

    def logged(self, values: Array, change: LoggedChange) -> Array:
        """Return values (n,) at the samples of the log, from their first."""
        return np.interp(change.time, self.time, values - values[0])


# Changes of an ordered output verified: overshoot, settling and work of the actuator against ships the fit allows.

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
    ships = draw_parameters(ship, SHIPS, seed).ships
    nominal = [_answers(task, (ship,), loop, change)[0] for change in logged]
    settling = [_judged(c, a, demand)[1] for c, a in zip(logged, nominal, strict=True)]
    backgrounds = (c.background(_SETTLED * s) for c, s in zip(logged, settling, strict=True))
    weather = [background for background in backgrounds if len(background) >= _LEAST_BACKGROUND]
    if not weather:
        longest = _SETTLED * max(settling)
        raise InputError(
            f"the changes end before they settle, so that nothing shows what weather does; log {longest:.0f} s and "
            "some minutes after each order"
        )
    answers = list(zip(*(_answers(task, ships, loop, c) for c in logged), strict=True)) or [nominal]
    rng = np.random.default_rng(seed)
    repeats = math.ceil(SHIPS * WEATHERS / len(answers))
    sampled = np.array([
        np.mean([_judged(c, _in_weather(a, weather, rng), demand) for c, a in zip(logged, runs, strict=True)], axis=0)
        for runs in answers for _ in range(repeats)
    ])  # fmt: skip
    achieved = np.array([_judged(c, _Answer(c.output, c.actuator), demand) for c in logged])
    mover = channel_unit(loop.actuator)
    names = (("overshoot", "1"), ("settling time", "s"), ("actuator rms", mover), ("actuator rate rms", f"{mover}/s"))
    quantities = tuple(
        _quantity(name, unit, sampled[:, k], float(np.mean(achieved[:, k]))) for k, (name, unit) in enumerate(names)
    )
    worn = (_worn(logged, runs, weather, rng) for runs in answers)
    simulated = np.array([followed_gains(task, loop, log).statistics for log in worn])
    changes = tuple(
        _verified_change(c, a, _judged(c, a, demand), row, loop)
        for c, a, row in zip(logged, nominal, achieved, strict=True)
    )
    return ChangeLog(changes, quantities, _gain_test(task, loop, logged, GainTest(followed, simulated)))


def _worn(
    logged: Sequence[LoggedChange], answers: Sequence[_Answer], weather: Sequence[Array], rng: np.random.Generator
) -> list[LoggedChange]:
    """Return the changes of a log as a simulated ship would have made them in the log's weather."""
    disturbed = (_in_weather(answer, weather, rng) for answer in answers)
    return [replace(c, output=a.output, actuator=a.actuator) for c, a in zip(logged, disturbed, strict=True)]


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
    alike = [loop for loop in (task.loop, *task.extended_structures) if loop.gains.names == task.loop.gains.names]
    loops = [loop.with_gains(gains) for loop in alike]
    followed = [followed_gains(task, loop, logged) for loop in loops]
    best = max(range(len(loops)), key=lambda place: followed[place].coherence)
    return loops[best], followed[best]


def _answers(task: TuningTask, ships: Sequence[TrimmedShip], loop: TransferLoop, change: LoggedChange) -> list[_Answer]:
    """Return what each ship does with the change as it was ordered, without weather, by the loop as it samples."""
    run = _OrderedRun.of_change(task, loop, change)
    return [_Answer(*(run.logged(signal, change) for signal in run.simulated(task, ship, run.level))) for ship in ships]


def _without_noise(loop: TransferLoop) -> TransferLoop:
    """Return the loop with a sensor without errors: what those of the log do is part of its weather."""
    return replace(loop, sampling=replace(loop.required_sampling, noise=0.0, resolution=0.0))


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
    output = smoothed(answer.output, round(_SMOOTHING * demand.time_constant / change.dt))
    settled = settling_time(output, change.demand, (1,), change.dt)
    rate = np.diff(answer.actuator) / change.dt
    return (
        relative_overshoot(output, change.demand, (1,)),
        change.dt * len(change.order) if math.isnan(settled) else settled,
        float(np.sqrt(np.mean(answer.actuator**2))), float(np.sqrt(np.mean(rate**2))),
    )  # fmt: skip


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
