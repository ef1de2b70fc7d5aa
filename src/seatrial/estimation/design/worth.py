"""What a manoeuvre tells: Cramer-Rao bounds of the coefficients for many ships at once, and where the ships go."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from seatrial.core.results import Worth
from seatrial.core.values import Array, Index, Record
from seatrial.estimation.design.orders import rows
from seatrial.estimation.design.ships import Ships
from seatrial.estimation.design.task import Task
from seatrial.physics.simulate.batch import Batch
from seatrial.physics.simulate.linear import batch_for
from seatrial.physics.simulate.replay import replay

_TRACK = ("u", "v", "x0", "y0")
_BARELY = 1e-13


@dataclass(frozen=True, eq=False)
class Told:
    """Relative standard errors (ships, k), NaN rows where a simulation diverges; largest drift [rad] and distance [m].

    drift, room: shape (ships,); zero for models without sway or position.
    """

    relative: Array
    drift: Array
    room: Array


@dataclass(frozen=True, eq=False)
class Bench:
    """Ships under test at a step `dt` [s]; information is that of the sensors' own rate."""

    task: Task
    ships: Ships
    dt: float

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """The sensors first, then what drift and distance need besides."""
        model = self.task.model
        return (*self.task.sensors, *(n for n in _TRACK if n in model.states and n not in self.task.sensors))

    @cached_property
    def _offsets(self) -> Index:
        return np.arange(self.ships.count + 1, dtype=np.int64) * rows(self.task, self.dt)

    @cached_property
    def _starts(self) -> Array:
        return np.tile(self.task.start, (self.ships.count, 1))

    @cached_property
    def _magnitudes(self) -> Array:
        """|coefficient| of each ship, its characteristic scale where it is nearly zero, (ships, k)."""
        parameters = self.task.model.parameters
        places = [parameters.index(n) for n in parameters.free_names]
        values = np.abs(self.ships.parameters[:, places])
        scale = np.array([p.characteristic_scale for p in parameters.free])
        return np.where(values > 1e-3 * scale, values, scale)

    @cached_property
    def _blank(self) -> Batch:
        model = self.task.model
        nothing = np.zeros((int(self._offsets[-1]), len(model.inputs)))
        batch = batch_for(model)(
            model, nothing, self._offsets, self.dt, self.outputs, model.parameters.free_names, (), ()
        )
        return replace(batch, starts=batch.influential_states())

    def told(self, made: Array) -> Told:
        """What inputs (rows, nu) tell, the same for all ships, or (ships, rows, nu), one each; the model's signs."""
        count, width = self.ships.count, len(self.task.model.inputs)
        each = np.broadcast_to(made, (count, *made.shape[-2:])).reshape(-1, width)
        batch = replace(self._blank, inputs=np.array(each))
        y, slopes, failed = batch.differentiate(0, count, self._starts, self.ships.parameters, np.zeros((count, 0)))
        y = y.reshape(count, -1, len(self.outputs))
        lost = (failed >= 0) | ~np.isfinite(y).all(axis=(1, 2))
        relative = self._relative(slopes.reshape(count, -1, *slopes.shape[1:]), lost)
        return Told(relative, *self._track(np.where(lost[:, None, None], 0.0, y)))

    def _relative(self, slopes: Array, lost: NDArray[np.bool_]) -> Array:
        seen, k = len(self.task.sensors), len(self.task.model.parameters.free)
        noise = np.array(list(self.task.sensors.values()))
        scaled = (slopes[:, :, :seen] / noise[:, None]).reshape(len(slopes), -1, slopes.shape[3])
        scaled = np.where(lost[:, None, None], 0.0, scaled)
        information = np.matmul(scaled.transpose(0, 2, 1), scaled) * (self.task.rate * self.dt)
        information[:, range(k), range(k)] += self.ships.precision
        errors = np.array([_errors(one, k) for one in information])
        return np.where(lost[:, None], np.nan, errors / self._magnitudes)

    def _track(self, y: Array) -> tuple[Array, Array]:
        at = {name: y[:, :, self.outputs.index(name)] for name in _TRACK if name in self.outputs}
        none = np.zeros(len(y))
        drift = np.abs(np.arctan2(at["v"], at["u"])).max(axis=1) if {"u", "v"} <= set(at) else none
        room = np.hypot(at["x0"], at["y0"]).max(axis=1) if {"x0", "y0"} <= set(at) else none
        return drift, room


def excess(task: Task, told: Told, margin: float = 0.0) -> Array:
    """By how much drift and distance of each ship leave the limits less a margin, in parts of these, (ships,)."""
    allowed = 1.0 - margin
    over = [told.drift / (allowed * task.limits.drift) - 1.0, told.room / (allowed * task.limits.room) - 1.0]
    return np.maximum(over, 0.0).sum(axis=0)


def leaves(task: Task, told: Told) -> bool:
    """Whether a ship that the limits bind leaves them; the first ship is the one assumed."""
    over = excess(task, told)
    return bool(over.max() > 0.0 if task.limits.for_every_ship else over[0] > 0.0)


def worth(name: str, fine: Bench, made: Array, executed: Record) -> Worth:
    """A manoeuvre's worth for all ships of the bench, the model itself first."""
    told = fine.told(made)
    own = float(told.drift[0]), float(told.room[0])
    return Worth(name, told.relative[0], told.relative[1:], *own, told.drift[1:], told.room[1:], executed)


def executed(task: Task, planned: Record, name: str) -> Record:
    """The model driven by a planned record from the task's start."""
    start = dict(zip(task.model.states, task.start.tolist(), strict=True))
    return replay(task.model, planned, start).named(name)


def _errors(information: Array, k: int) -> Array:
    """Standard errors of the first k unknowns; huge for those that nothing tells."""
    scale = np.sqrt(information.diagonal())
    known = scale > 0.0
    unit = information[np.ix_(known, known)] / np.outer(scale[known], scale[known])
    variance = np.full(len(scale), np.inf)
    inverse = np.linalg.inv(unit + _BARELY * np.eye(len(unit)))
    variance[known] = np.abs(inverse.diagonal()) / scale[known] ** 2
    return np.sqrt(np.minimum(variance[:k], 1e30))
