"""Logs of a stabiliser's trial from ships that differ from the model, verified: how often intervals hold the truth.

Four legs of 20 minutes, control off, on, off, on, by the nonlinear loop with its limits; a sea for each leg, as much
like the one before as legs within an hour are. The truth of the reduction is that of the same waves without control.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from measure import Line, at_least, at_most

from seatrial import api
from seatrial.control.simulation import RUN_IN_SECONDS, closed_loop, disturbance_series
from seatrial.control.task import Seaway, SimulationSettings, TuningTask
from seatrial.control.verification.stabiliser import SEA_CHANGE, prior_deviations
from seatrial.core.results.verification import Verification
from seatrial.core.values import Array, Channel, Provenance, Record, RecordKind, frozen
from seatrial.estimation.sea import altered_loop
from seatrial.physics.loops import TransferLoop
from seatrial.physics.loops.structures import PUBLISHED_GAINS
from seatrial.physics.sea import Spectrum, jonswap
from seatrial.physics.simulate.closed_loop import ActuatorLimits

EXAMPLE = Path(__file__).parents[1] / "examples" / "fin_stabiliser.toml"
LOGS = 100  # simulated logs
LEG_S, DT, EVERY = 1200.0, 0.02, 10  # s, s, steps between two samples of the log: a leg at sea, a logger of 5 Hz
HEIGHT, PERIOD, GAMMA = 1.8, 8.0, 2.0  # m, s, 1: of the first leg's sea, moderate
NOISE = 1e-3  # rad, of a roll sensor
WRONG_GAIN = math.log(0.6)  # of the ships whose fins do six tenths of what the model says
LEGS = (False, True, False, True)  # whether control is on


@dataclass(frozen=True, eq=False)
class SimulatedLog:
    """Records of the legs, and the reduction of those with control in their own waves."""

    records: tuple[Record, ...]
    reduction: float


def simulated_log(task: TuningTask, factors: Array, seed: int, leg_s: float = LEG_S) -> SimulatedLog:
    """Return the log of a ship with these factors (3,) on the task's, with the published gains on in some legs."""
    rng = np.random.default_rng([seed, 22])
    loop = altered_loop(task.loop, factors)
    gains = np.array([PUBLISHED_GAINS[name] for name in loop.gains.names])
    height, period = math.log(HEIGHT), math.log(PERIOD)
    records, powers = [], []
    for k, is_on in enumerate(LEGS):
        sea = jonswap(math.exp(height), math.exp(period), GAMMA)
        leg_seed = int(rng.integers(2**31))
        still = _leg(task, loop, 0.0 * gains, sea_of(task, sea), leg_seed, leg_s)
        moving = _leg(task, loop, gains, sea_of(task, sea), leg_seed, leg_s) if is_on else still
        powers += [(np.mean(moving[0] ** 2), np.mean(still[0] ** 2))] if is_on else []
        phi = moving[0] + rng.normal(0.0, NOISE, len(moving[0]))
        records.append(_record(f"leg_{k + 1}", phi, moving[1]))
        height, period = height + rng.normal(0.0, SEA_CHANGE[0]), period + rng.normal(0.0, SEA_CHANGE[1])
    controlled, free = np.sum(powers, axis=0)
    return SimulatedLog(tuple(records), 1.0 - math.sqrt(controlled / free))


def sea_of(task: TuningTask, spectrum: Spectrum) -> Seaway:
    """Return the task's first sea with another spectrum."""
    first = next(met for met in task.disturbances if isinstance(met, Seaway))
    return replace(first, spectrum=spectrum)


def _leg(
    task: TuningTask, loop: TransferLoop, gains: Array, sea: Seaway, seed: int, leg_s: float
) -> tuple[Array, Array]:
    """Return roll and fin angle (n,) of a leg, after its run-in."""
    (disturbance,) = disturbance_series(sea, SimulationSettings(1, leg_s, DT), seed)[0]
    closed = closed_loop(replace(task, loop=loop), loop, gains, task.U, DT)
    r = task.constraints
    states, moved = closed.run(disturbance, ActuatorLimits(r.limit, r.rate))
    logged = slice(round(RUN_IN_SECONDS / DT), None, EVERY)
    return states[logged, closed.model.states.index(loop.output)], moved[logged]


def _record(name: str, phi: Array, alpha_f: Array) -> Record:
    channels = {
        symbol: Channel.from_notation(symbol, frozen(np.ascontiguousarray(values)))
        for symbol, values in (("phi", phi), ("alpha_f", alpha_f))
    }
    time = frozen(DT * EVERY * np.arange(len(phi)))
    return Record(name, time, channels, RecordKind.SIMULATED, provenance=Provenance("simulated legs"))


def verified(task: TuningTask, log: SimulatedLog) -> Verification:
    """Return the verification of a log by the task's model."""
    return api.verify(task, PUBLISHED_GAINS, log.records)


def run(logs: int = LOGS) -> list[Line]:
    """Return coverage on ships as uncertain as the loop file says, and what is named where the fins do less."""
    task = api.load_loop(EXAMPLE)
    rng, deviations = np.random.default_rng(22), prior_deviations(task)
    drawn = [rng.normal(0.0, deviations) for _ in range(logs)]
    covered, widths, errors, ships = [], [], [], []
    for seed, factors in enumerate(drawn):
        log = simulated_log(task, factors, seed)
        result = verified(task, log)
        reduction = result.reductions[0]
        covered.append(reduction.lower <= log.reduction <= reduction.upper)
        widths.append(0.5 * (reduction.upper - reduction.lower))
        errors.append([one.value - log.reduction for one in result.reductions])
        ships.append(_ship_inside(result, factors))
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    named, alarms = _wrong_gain(task, max(2, logs // 4)), _wrong_gain(task, max(2, logs // 4), 0.0)

    def per_cent(share: float) -> float:
        return 100.0 * float(share)

    return [
        at_least(f"{logs} logs: reduction inside its 95 % interval", per_cent(np.mean(covered)), "%", 90.0),
        Line("half width of the interval, mean", per_cent(np.mean(widths)), "points"),
        Line("error of the reduction, rms: by the corrected model", per_cent(rms[0]), "points"),
        Line("error of the reduction, rms: legs on against off as they are", per_cent(rms[1]), "points"),
        at_least("K_alpha, frequency, damping inside their intervals", per_cent(np.mean(ships)), "%", 90.0),
        at_least("fins that do 0.6 of what the model says: K_alpha named", per_cent(named), "%", 90.0),
        at_most("ship as modelled: K_alpha named", per_cent(alarms), "%", 5.0),
    ]


def _ship_inside(result: Verification, factors: Sequence[float]) -> list[bool]:
    return [
        c.lower <= c.model * math.exp(factor) <= c.upper for c, factor in zip(result.corrections, factors, strict=True)
    ]


def _wrong_gain(task: TuningTask, logs: int, factor: float = WRONG_GAIN) -> float:
    """Return the share of logs in which the effectiveness of the fins is named as moved."""
    seeds = range(10_000, 10_000 + logs)
    found = [verified(task, simulated_log(task, np.array([factor, 0.0, 0.0]), seed)) for seed in seeds]
    return float(np.mean([result.corrections[0].is_moved for result in found]))


if __name__ == "__main__":
    for line in run(*map(int, sys.argv[1:])):
        print(f"{line.quantity:<66} {line.value:>10.4g} {line.unit:<10} {line.verdict}")
