"""Logs of course changes by a simulator of this file's own, verified: what changed is named, and nothing else is.

A patrol boat T r' + r = K delta under the controller written from its own gains.toml, in gusts, with a noisy compass
and gyro; a logger that reads every half second. The ship that is verified differs from its model as the model's
covariance says. Seeds are drawn apart from those of any test or threshold: `FIRST_SEED`.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from measure import Line, at_least
from second_simulator import (
    DEGREE,
    QUICK,
    OwnActuator,
    OwnController,
    gauss_markov,
    lag_of,
    nomoto_step,
    print_lines,
    tuning_of,
)

from seatrial.control.task import TuningTask
from seatrial.control.verification.verify import verify
from seatrial.core.results.verification import Verification
from seatrial.core.values import Record, Ship
from seatrial.data.folder.gains_file import gains_toml
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.models import model_named

FIRST_SEED = 470_000
LOGS, FEWER = 100, 20  # of each kind; fewer where CPU is short: an argument, and in a run of all benchmarks
K, T, U, LENGTH = 0.16, 4.0, 9.0, 30.0  # 1/s, s, m/s, m
DEVIATIONS = (0.02, 0.05)  # of K and T, shares: of a fit
GEAR, DEAD, LIMIT, RATE = 0.5, 0.5, 35.0, 4.0  # s, s, deg, deg/s
COMPASS, GYRO = 0.1, 0.05  # deg, deg/s rms of each sample
GUSTS, BANDWIDTH = 1.0, 0.1  # deg of rudder, rad/s
CHANGE, LEG_S, LEGS, LOGGER = 30.0, 90.0, 6, 0.5  # deg, s, number, s
LOOP = f"""
name = "patrol autopilot"
[plant]
model = "model.toml"
[controller]
kind = "pid"
sample_s = 0.1
[actuator]
limit = {{ value = {LIMIT}, unit = "deg" }}
rate = {{ value = {RATE}, unit = "deg/s" }}
dead_time = {DEAD}
servo = [{{ lag = {GEAR} }}]
[[slow_disturbances]]
rms = {{ value = {GUSTS}, unit = "deg" }}
bandwidth = {BANDWIDTH}
[sensors]
noise = {{ value = {COMPASS}, unit = "deg" }}
[demand]
change = {{ value = {CHANGE}, unit = "deg" }}
time_constant = 5
"""


@dataclass(frozen=True)
class Change:
    """What of the ship or its controller is not as the model and gains.toml say; `cause`: what is to be named."""

    name: str
    cause: str
    gain: float = 1.0
    lag: float = 1.0
    stop: float = LIMIT
    KP: float = 1.0
    KD: float = 1.0


CHANGES = (
    Change("unchanged", ""),
    Change("gain x 0.5", "K", gain=0.5),
    Change("gain x 0.8", "K", gain=0.8),
    Change("gain x 1.25", "K", gain=1.25),
    Change("time constant x 2", "T", lag=2.0),
    Change("rudder stopped at 5 deg", "actuator-stopped", stop=5.0),
    Change("other gains", "gains-differ", KP=2.0, KD=0.5),
)


@dataclass(frozen=True, eq=False)
class Trial:
    """The tuning and its gains.toml."""

    task: TuningTask
    gains: dict[str, float]
    text: str


def tuned_trial() -> Trial:
    """Return the boat's tuning."""
    model = model_named("nomoto").with_values({"K": K, "T": T, "U": U})
    covariance = np.diag(np.square([DEVIATIONS[0] * K, DEVIATIONS[1] * T]))
    file = ModelFile(model, covariance, ship=Ship("boat", {"L": LENGTH}))
    task, tuning = tuning_of(LOOP, file, QUICK)
    return Trial(task, dict(tuning.chosen.gains), gains_toml(tuning))


def log_of(trial: Trial, change: Change, seed: int) -> Record:
    """Return the log of one trial."""
    rng = np.random.default_rng([seed, 4711])
    gain, lag = (1.0 + share * float(rng.standard_normal()) for share in DEVIATIONS)
    gain, lag = K * change.gain * gain, T * change.lag * lag
    own = OwnController(trial.text)
    own.gains = {**own.gains, "KP": own.gains["KP"] * change.KP, "KD": own.gains["KD"] * change.KD}
    parts = 5
    dt = own.T / parts
    count, every = round(LEG_S * LEGS / own.T), round(LOGGER / own.T)
    gusts = gauss_markov(GUSTS * DEGREE, BANDWIDTH, dt, count * parts, rng)
    rudder = OwnActuator(dt, DEAD, lag_of(GEAR, dt), change.stop * DEGREE, RATE * DEGREE)
    turned, psi, r = nomoto_step(gain, lag, dt), 0.0, 0.0
    rows = []
    for k in range(count):
        # to starboard twice, back twice
        leg = int(k * own.T // LEG_S) % 4
        ordered = (0.0, 1.0, 2.0, 1.0)[leg] * CHANGE * DEGREE
        seen = psi + COMPASS * DEGREE * float(rng.standard_normal())
        if k % every == 0:
            rows.append((k * own.T, seen, r + GYRO * DEGREE * float(rng.standard_normal()), rudder.angle, ordered))
        wanted, fed = own.follow(ordered)
        order = own.order(wanted - seen, fed)
        for j in range(parts):
            psi, r = turned(psi, r, rudder.move(order) + gusts[k * parts + j])
    time, *series = np.array(rows).T
    names = ("psi", "r", "delta", "psi_ref")
    return Record.from_arrays(f"log_{seed}", time, dict(zip(names, series, strict=True)))


def is_named(change: Change, made: Verification) -> bool:
    """Return whether the cause is named and no coefficient or gain beside it; of an unchanged ship: nothing."""
    warned = {one.code for one in made.findings if one.severity.name == "WARNING"} - {"model-moved"}
    return {change.cause} - {""} == warned | set(made.moved)


def lines_of(changes: Sequence[Change], logs: int, first: int = FIRST_SEED) -> list[Line]:
    """Return the lines of some changes."""
    trial, lines = tuned_trial(), []
    for k, change in enumerate(changes):
        made = [verify(trial.task, trial.gains, [log_of(trial, change, first + 1000 * k + i)]) for i in range(logs)]
        share = 100.0 * np.mean([is_named(change, one) for one in made])
        lines.append(at_least(f"{change.name}: {change.cause or 'nothing'} named, of {logs} logs", share, "%",
                              90.0 if change.cause else 95.0))  # fmt: skip
    return lines


def run() -> list[Line]:
    """Return the lines of fewer logs of each kind."""
    return lines_of(CHANGES, FEWER)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="logs of each change, verified")
    parser.add_argument("--logs", type=int, default=LOGS)
    parser.add_argument("names", nargs="*")
    given = parser.parse_args()
    print_lines(lines_of([one for one in CHANGES if not given.names or one.name in given.names], given.logs))
