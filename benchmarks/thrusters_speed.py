"""CPU time of simulating two thrusters with lags against the waterjet model with pose, in one run on one thread.

python benchmarks/thrusters_speed.py
"""

import time
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.models import model_named
from seatrial.physics.models.thruster_layout import CATAMARAN, ThrustCurve
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.batch import SegmentBatch

STEPS, DT, REPEATS = 100_000, 0.1, 9
LIMITS = {ThrustCurve.POWER: 0.3, ThrustCurve.QUADRATIC: 0.4}
"""Speed over that of the waterjet model to be reached."""


def seconds(model: Model, inputs: Array, speed: float) -> float:
    """Return the least CPU time of a simulation of all steps."""
    batch = SegmentBatch(model, inputs, np.array([0, STEPS]), DT, model.states[:6])
    start = np.zeros((1, len(model.states)))
    start[0, 0] = speed
    times = []
    for _ in range(REPEATS):
        began = time.process_time()
        batch.simulate(0, 1, start, model.parameters.values[None], np.empty((1, 0)))
        times.append(time.process_time() - began)
    return min(times)


def main() -> None:
    """Print the ratios."""
    rng = np.random.default_rng(0)
    steering = np.stack([np.repeat(rng.uniform(-0.3, 0.3, STEPS // 100), 100), np.full(STEPS, 10.0)], axis=1)
    commands = np.repeat(rng.uniform(-1.0, 1.0, size=(STEPS // 100, 2)), 100, axis=0)
    waterjet = seconds(model_named("waterjet"), steering, 4.0)
    print(f"waterjet: {waterjet / STEPS * 1e6:.3f} us a step")
    for curve, limit in LIMITS.items():
        layout = replace(CATAMARAN, thrusters=tuple(replace(t, curve=curve) for t in CATAMARAN.thrusters))
        ratio = waterjet / seconds(thrusters(layout), commands, 0.0)
        print(f"thrusters, {curve}: {ratio:.2f} of its speed (at least {limit:g})")


if __name__ == "__main__":
    main()
