"""Manoeuvres that could come next, and the information each would add about the ship as she is estimated by now."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Actuator
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import Trial
from seatrial.data.trial.follow_table import followed
from seatrial.estimation.design.search import coarse
from seatrial.estimation.design.ships import Ships
from seatrial.estimation.design.standards import standards
from seatrial.estimation.design.task import Task
from seatrial.estimation.design.worth import Bench
from seatrial.estimation.estimate.fit import swings, unit_of_time
from seatrial.numerics.optimise import Normal
from seatrial.physics.simulate.bounds import limits
from seatrial.physics.simulate.channels import AT_REST
from seatrial.physics.simulate.linear import batch_for
from seatrial.physics.simulate.steer import RUDDER, SOLAS_SLEW_RATE

# where the trial has no [design]: trial and hold in the ship's unit of time, and what actuators can do
_UNITS, _HOLD_UNITS = 20.0, 1.0
_SWINGS = 40.0
_RUDDER, _FIN, _FIN_RATE = math.radians(35.0), math.radians(10.0), math.radians(20.0)
_FINS = ("delta_f1", "delta_f2", "alpha_f")
# releases, as multiples of the largest angle seen; none is larger than the last number
_LARGER, _LARGEST = (1.5, 2.0, 3.0), math.radians(35.0)


@dataclass(frozen=True, eq=False)
class Offer:
    """A manoeuvre: its name, in words, where it begins, (nx,), and its inputs at steps of dt [s], (rows, nu)."""

    name: str
    words: str
    start: Array
    inputs: Array
    dt: float
    is_random: bool = False


def offers(trial: Trial, model: Model, records: Sequence[Record], noise: dict[str, float]) -> list[Offer]:
    """Standard manoeuvres for the ship `model`, as fast and with the same held inputs as in the records so far.

    noise: channel -> standard deviation, SI.

    Raises:
        InputError: nothing can be moved, or the ship cannot be simulated.
    """
    if swings(model) and not model.is_affine:
        return _releases(model, records)
    task = _task(trial, model, records, noise)
    bench = Bench(task, Ships(model.parameters.values[None], np.zeros(len(model.parameters.free))), coarse(task))
    made = []
    for one in standards(bench):
        inputs = one.made(bench)
        own = inputs[0] if inputs.ndim == 3 else inputs
        made.append(Offer(one.name, _named(one.name, task), task.start, own, bench.dt, one.is_random))
    return made


def information(model: Model, offer: Offer, noise: dict[str, float], rate: float) -> Array:
    """Fisher information of the free coefficients, (k, k), initial states unknown; zero where she leaves all bounds.

    noise: channel -> standard deviation, SI, white; rate: Hz at which these are recorded.
    """
    names, outputs = model.parameters.free_names, (*noise, *(n for n in model.states if n not in noise))
    offsets = np.array([0, len(offer.inputs)], dtype=np.int64)
    inputs = np.ascontiguousarray(offer.inputs)
    batch = batch_for(model)(model, inputs, offsets, offer.dt, outputs, names)
    batch = replace(batch, starts=batch.influential_states())
    y, slopes, failed = batch.differentiate(
        0, 1, offer.start[None], model.parameters.values[None], np.zeros((1, 0))
    )  # fmt: skip
    k = len(names)
    states = y[:, [outputs.index(n) for n in model.states]]
    if failed[0] >= 0 or not np.all(np.abs(states) <= limits(model)) or not np.all(np.isfinite(slopes)):
        return np.zeros((k, k))
    scaled = (slopes[:, : len(noise)] / np.array(list(noise.values()))[:, None]).reshape(-1, slopes.shape[2])
    hessian = (scaled.T @ scaled) * (rate * offer.dt)
    none = np.zeros(len(hessian) - k)
    return Normal(
        0.0, np.zeros(k), hessian[:k, :k], none[None], hessian[None, k:, k:], hessian[None, :k, k:]
    ).reduced()[1]


def _releases(model: Model, records: Sequence[Record]) -> list[Offer]:
    """Left alone from larger angles, for as long as the longest record."""
    angle = model.states[0]
    seen = [r for r in records if angle in r]
    if not seen:
        raise InputError(f"no record holds '{angle}'")
    longest, largest = max(seen, key=lambda r: r.duration), max(float(np.nanmax(np.abs(r[angle]))) for r in seen)
    rows = round(longest.duration / longest.dt) + 1
    made = []
    for factor in _LARGER:
        if largest * factor <= _LARGEST:
            start = np.zeros(len(model.states))
            start[0] = largest * factor
            words = f"a release from {math.degrees(start[0]):.2g} deg, left alone for {longest.duration:.0f} s,"
            made.append(Offer(f"release:{math.degrees(start[0]):.3g}", words, start,
                              np.zeros((rows, len(model.inputs))), longest.dt))  # fmt: skip
    return made


def _task(trial: Trial, model: Model, records: Sequence[Record], noise: dict[str, float]) -> Task:
    brief, rate = trial.design, trial.estimate.rate or followed(trial).rate
    common = {"question": "", "ship": trial.ship, "model": model, "sensors": noise, "rate": rate, "draws": 0}
    if brief is not None:
        return Task(**common, duration=brief.duration, actuators=brief.actuators, limits=brief.limits, held=brief.held,
                    speed=brief.speed)  # fmt: skip
    unit = unit_of_time(model, records, trial.ship.length)
    duration = _rounded((_SWINGS if model.is_affine else _UNITS) * unit)
    hold = max(_HOLD_UNITS * unit, 4.0 / rate)
    actuators = tuple(a for name in model.input_names if (a := _actuator(trial, model, name, hold)) is not None)
    moved = {a.name for a in actuators}
    held = {n: _middle(records, n) for n in model.input_names if n not in moved and _is_steady(n, records)}
    speed = _middle(records, "u") if "u" in model.states and any("u" in r for r in records) else None
    return Task(**common, duration=duration, actuators=actuators, held=held, speed=speed)


def _actuator(trial: Trial, model: Model, name: str, hold: float) -> Actuator | None:
    """What can be moved without asking: a rudder, and fins that lift."""
    if name == RUDDER:
        fast = math.sqrt(trial.ship.scale)
        return Actuator(name, -_RUDDER, _RUDDER, SOLAS_SLEW_RATE * fast, hold)
    lift = name.replace("delta_f", "lift_")
    if name in _FINS and lift in model.parameters.names and model.parameters[lift].value:
        return Actuator(name, -_FIN, _FIN, _FIN_RATE, hold)
    return None


def _is_steady(name: str, records: Sequence[Record]) -> bool:
    """Whether an input is held at what it was: propellers and jets; waves and wind are at rest."""
    return name not in AT_REST and any(name in r for r in records)


def _middle(records: Sequence[Record], name: str) -> float:
    return float(np.median(np.concatenate([r[name] for r in records if name in r])))


def _rounded(seconds: float) -> float:
    """Two significant digits."""
    step = 10.0 ** (math.floor(math.log10(seconds)) - 1)
    return step * round(seconds / step)


def _named(name: str, task: Task) -> str:
    """A standard manoeuvre's name as people say it."""
    kind, *fields = name.split(":")
    moved, length = " and ".join(a.name for a in task.actuators), f"of {task.duration:g} s"
    if kind == "zigzag":
        return f"a zigzag {fields[0]} {length}"
    if kind == "consecutive-zigzags":
        return f"zigzags 10/10 to 30/30 one after another, {length} together,"
    if kind == "turning-circle":
        return f"a turning circle with {fields[0]} deg of rudder {length}"
    if kind == "prbs":
        hold, share = float(fields[1].removesuffix(" s")), fields[0]
        return f"a random binary sequence of {moved} (held {hold:.2g} s, {share} of its range) {length}"
    return f"a sweep of {moved} {length}" if kind == "sine sweep" else f"steps of {moved} from end to end {length}"
