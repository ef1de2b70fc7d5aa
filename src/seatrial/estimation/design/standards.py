"""The standard manoeuvres a design is measured by: equal duration, the same inputs, ranges, rates and ships."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from seatrial.core.results import Actuator
from seatrial.core.values import Array, InputError
from seatrial.estimation.design.orders import followed, inputs, rows
from seatrial.estimation.design.task import Task
from seatrial.estimation.design.worth import Bench, leaves
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.manoeuvres.schedule import binary_sequence
from seatrial.physics.simulate.channels import inputs_of
from seatrial.physics.simulate.steer import RUDDER, SOLAS_SLEW_RATE, manoeuvre

# switching times as shares of the designed one's hold; amplitudes as shares of the range, the first that keeps within
SWITCHING = (1.0 / 3.0, 2.0 / 3.0, 1.0, 4.0 / 3.0)
AMPLITUDES = (1.0, 0.85, 0.7, 0.55, 0.4, 0.25, 0.1)
SEQUENCES = (0, 1)
_ANGLES = (10.0, 20.0, 30.0)
_WHOLE = 1e-6


@dataclass(frozen=True, eq=False)
class Standard:
    """A standard manoeuvre; `made` gives its inputs for the ships and step of a bench, in the model's signs.

    One course (rows, nu) for all ships, or one each (ships, rows, nu) where a helmsman steers them.
    """

    name: str
    made: Callable[[Bench], Array]
    is_random: bool = False


def standards(bench: Bench) -> list[Standard]:
    """Random binary sequences and, by the model, zigzags and turning circles or steps and a sweep."""
    task = bench.task
    found = [_largest_within(bench, share, seed) for share in SWITCHING for seed in SEQUENCES]
    if not _is_steered(task):
        return [*found, Standard("sine sweep", _sweep), Standard("steps", _steps)]
    steered = [Standard(text, partial(_steered, text)) for text in _programmes(task)]
    return [*found, *(r for r in steered if _can_be_steered(bench, r))]


def binary(hold: float, share: float, seed: int, bench: Bench) -> Array:
    """Every actuator between its ends, or `share` of the way to them, by maximum length sequences of their own."""
    task, orders = bench.task, list[Array]()
    switched = replace(task, actuators=tuple(replace(a, hold=hold) for a in task.actuators))
    for j, actuator in enumerate(task.actuators):
        count = int(np.ceil(task.duration / hold - _WHOLE))
        signs = np.sign(np.resize(binary_sequence(1.0, seed + 10 * j), count))
        orders.append(_middle(actuator) + signs * share * 0.5 * (actuator.upper - actuator.lower))
    return inputs(switched, orders, bench.dt)


def _largest_within(bench: Bench, switching: float, seed: int) -> Standard:
    """The largest amplitude whose drift and distance keep within the limits; else the smallest tried."""
    task = bench.task
    hold = max(switching * task.shortest_hold, 2.0 / task.rate)
    standard = Standard("", _steps)
    for share in AMPLITUDES:
        standard = Standard(
            f"prbs:{100 * share:.0f}%:{hold:.3g} s:{seed}", partial(binary, hold, share, seed), is_random=True
        )
        told = bench.told(standard.made(bench))
        if not leaves(task, told) and np.isfinite(told.relative).all():
            break
    return standard


def _middle(actuator: Actuator) -> float:
    return 0.5 * (actuator.lower + actuator.upper)


def _is_steered(task: Task) -> bool:
    return "psi" in task.model.states and any(a.name == RUDDER for a in task.actuators)


def _programmes(task: Task) -> list[str]:
    """Zigzags that the rudder's range allows, compressed ones as long as fits, the hardest turning circle."""
    (rudder,) = [a for a in task.actuators if a.name == RUDDER]
    most = float(np.degrees(min(rudder.upper, -rudder.lower)))
    angles = [a for a in _ANGLES if a <= most + _WHOLE]
    texts = [f"zigzag:{a:g}/{a:g}" for a in angles]
    if most >= _ANGLES[-1] - _WHOLE:
        texts += ["consecutive-zigzags:1", "consecutive-zigzags:2"]
    return [*texts, f"turning-circle:{most:.4g}"] if most > 0.0 else texts


def _can_be_steered(bench: Bench, standard: Standard) -> bool:
    """Whether no ship is lost under the helmsman."""
    try:
        standard.made(bench)
    except InputError:
        return False
    return True


def _steered(text: str, bench: Bench) -> Array:
    """Each ship under the helmsman; after the last execute the rudder stays."""
    return np.stack([_sailed(bench, row, text) for row in bench.ships.parameters])


def _sailed(bench: Bench, parameters: Array, text: str) -> Array:
    task, model = bench.task, bench.task.model
    ship = model.with_parameters(
        model.parameters.with_values(dict(zip(model.parameters.names, parameters, strict=True)))
    )
    (rudder,) = [a for a in task.actuators if a.name == RUDDER]
    step = 1.0 / task.rate
    others = {a.name: task.neutral[a.name] for a in task.actuators if a.name != RUDDER}
    record = manoeuvre(
        ship,
        programme(text),
        dt=step,
        duration=task.duration,
        speed=float(task.start[model.states.index("u")]) if "u" in model.states else task.speed,
        inputs={**task.held, **others},
        slew_rate=rudder.rate if np.isfinite(rudder.rate) else SOLAS_SLEW_RATE,
    )
    held = inputs_of(model, record)[:: round(bench.dt / step)]
    count = rows(task, bench.dt)
    return np.concatenate([held, np.repeat(held[-1:], max(0, count - len(held)), axis=0)])[:count]


def _sweep(bench: Bench) -> Array:
    """All actuators swing between their ends, from one swing in the trial to one in four holds, evenly faster."""
    task, time = bench.task, bench.dt * np.arange(rows(bench.task, bench.dt))
    first, last = 1.0 / task.duration, 0.25 / task.shortest_hold
    return _all(bench, np.sin(2.0 * np.pi * (first * time + 0.5 * (last - first) * time**2 / task.duration)))


def _steps(bench: Bench) -> Array:
    """From end to end eight times."""
    time = bench.dt * np.arange(rows(bench.task, bench.dt))
    return _all(bench, np.where((8.0 * time / bench.task.duration).astype(int) % 2, 1.0, -1.0))


def _all(bench: Bench, course: Array) -> Array:
    """Every actuator along a course between -1 and 1, at its own rate."""
    task, dt = bench.task, bench.dt
    made = np.tile(task.quiet, (len(course), 1))
    for a in task.actuators:
        j = task.model.input_names.index(a.name)
        free = replace(a, hold=dt)
        wanted = followed(free, _middle(a) + 0.5 * (a.upper - a.lower) * course, task.neutral[a.name], dt, len(course))
        made[:, j] = -wanted if task.model.inputs[j].is_turned else wanted
    return made
