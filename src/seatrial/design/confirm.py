"""A design tried on simulated trials: noisy records of ships the prior allows, fitted as `identify` fits them."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from seatrial.design.ships import Ships
from seatrial.design.task import Task
from seatrial.design.worth import Bench
from seatrial.equations import Model
from seatrial.estimate.fit import identified
from seatrial.estimate.settings import Settings
from seatrial.results import Confirmation
from seatrial.simulate.replay import replay
from seatrial.values import Array, InputError, Record
from seatrial.workers import mapped


def confirmed(
    task: Task, made: Array, planned: Record, ships: Ships, seed: int, progress: Callable[[str], None]
) -> Confirmation:
    """One noisy record and one fit for every ship; `made` are the plan's inputs at the sensors' rate."""
    foretold = Bench(task, ships, 1.0 / task.rate).told(made).relative
    streams = np.random.SeedSequence(seed).spawn(ships.count)
    length = task.ship.particulars.get("L", 1.0)

    def fitted(number: int) -> tuple[Array, bool] | None:
        ship = _with(task.model, ships.parameters[number])
        record = _noisy(task, ship, planned, np.random.default_rng(streams[number]))
        if record is None:
            return None
        try:
            found = identified(task.model, [record], [record.name], length, Settings(workers=1))
        except InputError:
            return None
        return found.made.shared[: len(task.model.parameters.free)], found.made.optimum.solution.status.is_success

    progress(f"confirming: {ships.count} simulated trials")
    results = mapped(fitted, list(range(ships.count)))
    places = [task.model.parameters.index(n) for n in task.model.parameters.free_names]
    scale = np.array([p.characteristic_scale for p in task.model.parameters.free])
    errors, bounds = [], []
    for number, result in enumerate(results):
        if result is not None and result[1]:
            true = ships.parameters[number, places]
            errors.append((result[0] - true) / np.where(np.abs(true) > 1e-3 * scale, np.abs(true), scale))
            bounds.append(foretold[number])
    none = np.full((1, len(places)), np.nan)
    return Confirmation(ships.count, len(errors), _rms(errors or none), _rms(bounds or none))


def _with(model: Model, values: Array) -> Model:
    return model.with_values(dict(zip(model.parameters.names, values.tolist(), strict=True)))


def _noisy(task: Task, ship: Model, planned: Record, generator: np.random.Generator) -> Record | None:
    """Sensors and inputs of a ship that follows the plan; None where she is lost."""
    start = dict(zip(ship.states, task.start.tolist(), strict=True))
    try:
        sailed = replay(ship, planned, start)
    except InputError:
        return None
    channels = {name: sailed.channel(name) for name in ship.input_names}
    for name, deviation in task.sensors.items():
        channel = sailed.channel(name)
        channels[name] = channel.with_values(channel.values + deviation * generator.standard_normal(len(sailed)))
    return replace(sailed, channels=channels)


def _rms(values: "list[Array] | Array") -> Array:
    return np.sqrt(np.mean(np.square(values), axis=0))
