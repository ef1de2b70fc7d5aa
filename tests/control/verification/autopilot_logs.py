"""Course changes of a Nomoto ship with an autopilot in weather, as logs for tests and benchmarks."""

import math
from dataclasses import replace

import numpy as np

from seatrial.control.controller import reference_model, reference_rate
from seatrial.control.ship import plant_and_disturbance, trim_ship
from seatrial.control.task import Demand, SlowDisturbance, TrimmedShip, TuningTask
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import Array, Record
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.loops import Block, LoopSignal, Sampling
from seatrial.physics.loops.autopilot import heading_loop
from seatrial.physics.loops.objective import variance
from seatrial.physics.models import model_named
from seatrial.physics.simulate.closed_loop import ActuatorLimits, ClosedLoop

DEGREE = math.pi / 180.0
DEMAND = Demand(20.0 * DEGREE, 0.1, 8.0, 240.0)
DEVIATIONS = (0.01, 0.5)  # of K [1/s] and T [s], as a fit states them
K, T = 0.2, 8.0  # 1/s, s: of the model
GAINS = {"KP": 1.0, "KD": 4.0}
LIMIT = 35.0 * DEGREE  # rad
DT, LEG_S = 0.5, 120.0  # s
SAMPLING = Sampling(DT)


def ship(gain: float = K, lag: float = T) -> TrimmedShip:
    """Return a Nomoto ship."""
    model = model_named("nomoto").with_values({"K": gain, "T": lag})
    return trim_ship(ModelFile(model, np.diag(np.square(DEVIATIONS))), output="psi", actuator="delta")


def autopilot_task(sampling: Sampling = SAMPLING) -> TuningTask:
    """Return the tuning of the model's autopilot."""
    model = ship()
    objectives = variance("output", "rad^2", LoopSignal.OUTPUT), variance("rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1)
    gear = (Block("steering gear", (1.0,), (0.5, 1.0)),)
    loop = replace(heading_loop(*plant_and_disturbance(model), gear, parts=("KP", "KD")), sampling=sampling)
    return TuningTask(
        "", "autopilot", "a Nomoto ship", loop, (SlowDisturbance(0.03, 0.05, 5.0),), objectives,
        ControllerConstraints(limit=LIMIT, rate=10.0 * DEGREE), 5.0, trimmed_ship=model, demand=DEMAND,
    )  # fmt: skip


def course_log(
    seed: int, gain: float = K, lag: float = T, weather: float = 0.01, turns: int = 4,
    sampling: Sampling = SAMPLING,
) -> Record:  # fmt: skip
    """Return the log of changes to starboard and port by a ship of that gain and lag; weather: rms [rad] of rudder."""
    task, true = autopilot_task(sampling), ship(gain, lag)
    loop = task.loop.with_gains(np.array(list(GAINS.values())))
    rng, count = np.random.default_rng(seed), round(LEG_S / DT)
    headings = np.concatenate([[0.0], np.cumsum([1.0, 1.0, -1.0, -1.0] * turns)[:turns]]) * DEMAND.change
    order = np.repeat(headings, count)
    motion = reference_model(order, DT, DEMAND.time_constant, reference_rate(task, loop, DEMAND))
    closed = ClosedLoop(true.model, loop, loop.gain_values, DT, "delta", "delta", "psi", true.state, true.inputs)
    gusts = _slow_noise(rng, len(order), weather)
    states, moved = closed.run(gusts, ActuatorLimits(LIMIT, 10.0 * DEGREE), motion.level)
    noise = rng.normal(0.0, 1e-3, (2, len(order)))  # rad, rad/s: of compass and gyro
    names = true.model.states
    series = {"psi": states[:, names.index("psi")] + noise[0], "r": states[:, names.index("r")] + 0.3 * noise[1]}
    return Record.from_arrays(f"turns_{seed}", DT * np.arange(len(order)), {**series, "delta": moved, "psi_ref": order})


def _slow_noise(rng: np.random.Generator, count: int, rms: float, bandwidth: float = 0.2) -> Array:
    """Return a first-order Gauss-Markov process of that rms, bandwidth in rad/s."""
    kept = math.exp(-bandwidth * DT)
    values, white = np.zeros(count), rng.standard_normal(count)
    for k in range(1, count):
        values[k] = kept * values[k - 1] + rms * math.sqrt(1.0 - kept**2) * white[k]
    return values
