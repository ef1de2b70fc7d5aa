"""Free-running trials of many disturbed ships at once: the truth against which intervals are judged.

Every series has a ship of its own: the tanker KVLCC2 (7 m model) with hull coefficients off the published ones, side
forces the fitted model does not know, a rudder zero for each run, gusts, and sensors whose noise is coloured. The
helmsman steers the disturbed ship. Steps of 0.1 s; the records keep every second one, the fitted model steps at that.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.physics.models.mmg import HULL
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.simulate.batch import SegmentBatch

Array = NDArray[np.float64]
SPEED, REVOLUTIONS, SLEW = 1.18, 10.4, np.radians(15.8)
STEP, KEEP, APPROACH = 0.1, 2, 5.0
COEFFICIENTS = 0.08
ASYMMETRY = {"Y_0": 6e-4, "N_0": 2e-4, "N_T": 2e-3}
RUDDER_ZERO = np.radians(0.4)
# standard deviation of the gusts' accelerations times the root of twice their memory: intensity, SI
GUST = {"u": 5e-4, "v": 1e-3, "r": np.radians(0.02)}
MEMORY = 3.0
SENSOR = {"x0": 0.02, "y0": 0.02, "psi": np.radians(0.1), "u": 3e-3, "v": 3e-3, "r": np.radians(0.02)}
COLOUR = 2.0


@dataclass(frozen=True)
class Order:
    """One run: rudder angle and heading at which it is turned over [deg]; a turn where `heading` is None."""

    name: str
    rudder: float
    heading: float | None
    seconds: float


TRAINING = tuple(
    Order(f"zigzag_{r}_{h}_{side}", r if side == "s" else -r, h, 150.0)
    for r, h, side in ((10, 5, "s"), (10, 10, "s"), (10, 10, "p"), (15, 5, "p"), (20, 5, "s"), (20, 10, "s"),
                       (20, 10, "p"), (25, 5, "p"), (30, 5, "s"))
)  # fmt: skip
HELD_OUT = (
    Order("zigzag_15_10", 15, 10, 150.0),
    Order("turn_35_s", 35, None, 120.0),
    Order("turn_35_p", -35, None, 120.0),
)


def ships(count: int, rng: np.random.Generator) -> tuple[Model, Array]:
    """The published model, and parameter values of `count` true ships, (count, parameters)."""
    model = kvlcc2()
    values = np.tile(model.parameters.values, (count, 1))
    for name in HULL:
        i = model.parameters.index(name)
        values[:, i] += COEFFICIENTS * max(abs(values[0, i]), 0.02) * rng.standard_normal(count)
    for name, spread in ASYMMETRY.items():
        values[:, model.parameters.index(name)] = spread * rng.standard_normal(count)
    return model, values


def _correlated_noise(rows: int, count: int, memory: float, rng: np.random.Generator) -> Array:
    """First-order Gauss-Markov noise of unit variance, (rows, count)."""
    keep = np.exp(-STEP / memory)
    noise = np.empty((rows, count))
    noise[0] = rng.standard_normal(count)
    for k in range(1, rows):
        noise[k] = keep * noise[k - 1] + np.sqrt(1 - keep**2) * rng.standard_normal(count)
    return noise


def simulate_runs(model: Model, values: Array, order: Order, rng: np.random.Generator) -> list[Record]:
    """One run of all ships; rudder and revolutions recorded as ordered, everything else through the sensors."""
    count, rows = len(values), round(order.seconds / STEP) + 1
    batch = SegmentBatch(model, np.zeros((2 * count, len(model.inputs))), 2 * np.arange(count + 1), STEP, model.states)
    place = {s: i for i, s in enumerate(model.states)}
    x = np.zeros((count, len(model.states)))
    x[:, place["u"]] = SPEED
    zero = RUDDER_ZERO * rng.standard_normal(count)
    gusts = {s: _correlated_noise(rows, count, MEMORY, rng) * size / np.sqrt(2 * MEMORY) for s, size in GUST.items()}
    states, angles = np.empty((rows, count, len(model.states))), np.empty((rows, count))
    angle, wanted = np.zeros(count), np.zeros(count)
    side = np.full(count, np.sign(order.rudder))
    for k in range(rows):
        states[k], angles[k] = x, angle
        if k * STEP >= APPROACH:
            if order.heading is not None:
                over = side * x[:, place["psi"]] >= np.radians(order.heading)
                side = np.where(over, -side, side)
            wanted = side * np.radians(abs(order.rudder))
        after = angle + np.clip(wanted - angle, -SLEW * STEP, SLEW * STEP)
        inputs = np.zeros((count, 2, len(model.inputs)))
        inputs[:, 0, 0], inputs[:, 1, 0], inputs[:, :, 1] = angle + zero, after + zero, REVOLUTIONS
        batch.inputs[:] = inputs.reshape(2 * count, -1)
        y, _ = batch.simulate(0, count, x, values, np.empty((count, 0)))
        x, angle = np.ascontiguousarray(y.reshape(count, 2, -1)[:, 1]), after
        for state, gust in gusts.items():
            x[:, place[state]] += STEP * gust[k]
    noise = {s: _correlated_noise(rows, count, COLOUR, rng) * size for s, size in SENSOR.items()}
    return [_record(order.name, model.states, states[:, i], angles[:, i], {s: n[:, i] for s, n in noise.items()})
            for i in range(count)]  # fmt: skip


def _record(name: str, names: Sequence[str], states: Array, angle: Array, noise: Mapping[str, Array]) -> Record:
    columns = {s: states[::KEEP, i] + noise[s][::KEEP] for i, s in enumerate(names)}
    time = STEP * KEEP * np.arange(len(angle[::KEEP]))
    return Record.from_arrays(name, time, {**columns, "delta": angle[::KEEP], "n": np.full(len(time), REVOLUTIONS)})
