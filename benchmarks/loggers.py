"""What ordinary loggers write: does a log that repeats, loses or mixes its rows give the model that it contains?

    python benchmarks/loggers.py [--craft nomoto waterjet thrusters] [--seeds 4] [--kinds held lost ...]

Two runs of each craft are simulated exactly and fitted as a logger of each kind would have written them; a third is
left out and predicted over its whole length from its inputs, without noise. The same readings written cleanly (a cell
is empty where nothing was read) are fitted beside them: the ratio is that of the errors of the left-out run, in heading
and position. Coverage is the share of 95 % intervals of coefficients that hold the truth. No campaign: what is compared
are two writings of one record.
"""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from measure import Line, at_least, at_most, machine
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record
from seatrial.data.trial import Role, Run
from seatrial.data.trial.records import load_parts
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.physics.models import nomoto, waterjet
from seatrial.physics.simulate.replay import replay
from seatrial.problems.thruster_craft import CRAFTS, simulated_runs

Array = NDArray[np.float64]
POOLED, MOST_RATIO = (
    (0.92, 0.98),
    1.15,
)  # coverage of all kinds together, and error over that of the clean log; required
HEADING = 0.1  # deg to which a heading is written
NOISE = {"psi": np.radians(0.05), "r": np.radians(0.05), "x0": 0.05, "y0": 0.05}  # rad, rad/s, m
FIXES = ("x0", "y0")
START_SPREAD = 0.2  # of the true coefficients, by which a search starts off them


@dataclass(frozen=True)
class Craft:
    """A craft, its length [m], seconds at the start of a run for its initial state, and how its runs are made."""

    name: str
    model: Model
    length: float
    start_s: float
    runs: Callable[[np.random.Generator], list[Record]]


def steered(model: Model, channels: Sequence[str], seconds: float, held: dict[str, float], start: dict[str, float],
            rng: np.random.Generator) -> list[Record]:  # fmt: skip
    """Three runs at 10 Hz of steps of the rudder to either side."""
    runs = []
    for k in range(3):
        clock = 0.1 * np.arange(round(seconds / 0.1) + 1)
        edges = np.cumsum(rng.uniform(8.0, 25.0, 80))
        orders = np.radians(rng.uniform(5.0, 20.0, 81)) * np.resize([1.0, -1.0], 81)
        delta = orders[np.searchsorted(edges, clock)]
        inputs = {"delta": delta} | {name: np.full(len(clock), value) for name, value in held.items()}
        planned = Record.from_arrays(f"run_{k + 1}", clock, inputs)
        run = replay(model, planned, dict.fromkeys(model.states, 0.0) | start)
        runs.append(replace(run, channels={s: run.channel(s) for s in (*channels, *inputs)}))
    return runs


def thruster_runs(rng: np.random.Generator) -> list[Record]:
    """Runs of steps of both commands."""
    commands = ("command_1", "command_2")
    return [
        replace(run, channels={s: run.channel(s) for s in ("psi", "r", *FIXES, *commands)})
        for run in simulated_runs(CRAFTS["two-fixed"], rng)
    ]


def crafts() -> dict[str, Craft]:
    """Return one craft of each kind."""
    steering, jet = nomoto().with_values({"K": 0.09, "T": 11.0}), waterjet()
    track = ("psi", "r", *FIXES)
    return {
        "nomoto": Craft("nomoto", steering, 40.0, 10.0, lambda rng: steered(steering, ("psi",), 400.0, {}, {}, rng)),
        "waterjet": Craft("waterjet", jet, 9.8, 12.0,
                          lambda rng: steered(jet, track, 300.0, {"v_j": 1.866}, {"u": 0.8}, rng)),
        "thrusters": Craft("thrusters", CRAFTS["two-fixed"].truth, 1.0, 5.0, thruster_runs),
    }  # fmt: skip


def written(run: Record, rng: np.random.Generator) -> Record:
    """The run as its sensors read it: with noise, the heading in tenths of a degree."""
    channels = dict(run.channels)
    for symbol, spread in NOISE.items():
        if symbol in channels:
            values = run[symbol] + spread * rng.standard_normal(len(run))
            step = np.radians(HEADING) if symbol == "psi" else 1e-3
            channels[symbol] = channels[symbol].with_values(np.round(values / step) * step)
    return replace(run, channels=channels)


Writing = tuple[Record, Record]  # as the logger wrote it, and the same readings written cleanly


def with_rows(run: Record, values: dict[str, Array]) -> Record:
    """The run with other values of some channels."""
    return replace(run, channels=dict(run.channels) | {s: run.channel(s).with_values(v) for s, v in values.items()})


def slower(run: Record) -> tuple[str, ...]:
    """The channels of a slower sensor: the fixes, or the heading of a craft without."""
    return FIXES if "x0" in run else ("psi",)


def held_every(run: Record, every: int, phases: Sequence[int] = (0, 0)) -> Writing:
    """Readings of every so many rows, repeated between them, the second channel with a phase of its own."""
    rows = np.arange(len(run))
    held, clean = {}, {}
    for symbol, phase in zip(slower(run), phases, strict=False):
        latest = np.maximum((rows - phase) // every * every + phase, 0)
        held[symbol] = run[symbol][latest]
        clean[symbol] = np.where((rows - phase) % every == 0, run[symbol], np.nan)
    return with_rows(run, held), with_rows(run, clean)


def lost(run: Record, share: float, rng: np.random.Generator, hole_s: float = 0.0) -> Writing:
    """Rows lost at random, and a hole."""
    is_lost = rng.uniform(size=len(run)) < share
    is_lost[[0, -1]] = False
    middle = len(run) // 2
    is_lost[middle : middle + round(hole_s / run.dt)] = True
    empty = {s: np.where(is_lost, np.nan, c.values) for s, c in run.channels.items()}
    kept = {s: c.with_values(c.values[~is_lost]) for s, c in run.channels.items()}
    return replace(run, time=run.time[~is_lost], channels=kept), with_rows(run, empty)


def held_and_lost(run: Record, rng: np.random.Generator) -> Writing:
    """A tenth of the rows of a table that repeats is lost."""
    held, clean = held_every(run, 10)
    seed = int(rng.integers(2**31))
    return lost(held, 0.1, np.random.default_rng(seed))[0], lost(clean, 0.1, np.random.default_rng(seed))[1]


def empty_cells(run: Record, rng: np.random.Generator) -> Writing:
    """A tenth of the cells of what is measured is empty."""
    empty = {s: np.where(rng.uniform(size=len(run)) < 0.1, np.nan, run[s]) for s in NOISE if s in run}
    return with_rows(run, empty), with_rows(run, empty)


def frozen(run: Record) -> Writing:
    """A sensor that holds its last reading for ten seconds, twice, and catches up."""
    values, clean = {}, {}
    for symbol in slower(run):
        values[symbol], clean[symbol] = np.array(run[symbol]), np.array(run[symbol])
        for share in (0.3, 0.7):
            first = round(share * len(run))
            rows = slice(first, first + round(10.0 / run.dt))
            values[symbol][rows], clean[symbol][rows] = values[symbol][first - 1], np.nan
    return with_rows(run, values), with_rows(run, clean)


def jittered(run: Record, rng: np.random.Generator) -> Writing:
    """Stamps late by up to a quarter of a row, written to the millisecond, and a twentieth of the rows lost."""
    late = np.round(run.time + rng.uniform(0.0, 0.25 * run.dt, len(run)), 3)
    rows, clean = lost(run, 0.05, rng)
    return replace(rows, time=late[np.isin(run.time, rows.time)]), clean


def thinned(run: Record, every: int) -> Writing:
    """Every so many rows alone: all is slow."""
    rows = run.rows(slice(None, None, every))
    return rows, rows


KINDS: dict[str, Callable[[Record, np.random.Generator], Writing]] = {
    "clean 5 Hz": lambda run, rng: thinned(run, 2),  # noqa: ARG005
    "all at 1 Hz": lambda run, rng: thinned(run, 10),  # noqa: ARG005
    "1 Hz held in 10 Hz": lambda run, rng: held_every(run, 10),  # noqa: ARG005
    "1 Hz held in 5 Hz": lambda run, rng: held_every(run.rows(slice(None, None, 2)), 5),  # noqa: ARG005
    "5 Hz held in 10 Hz": lambda run, rng: held_every(run, 2),  # noqa: ARG005
    "in turn, 1 Hz": lambda run, rng: held_every(run, 20, (0, 10)),  # noqa: ARG005
    "3 % of rows lost": lambda run, rng: lost(run.rows(slice(None, None, 2)), 0.03, rng),
    "20 % lost, a hole": lambda run, rng: lost(run.rows(slice(None, None, 2)), 0.2, rng, 0.1 * run.duration),
    "held and lost": held_and_lost,
    "empty cells": lambda run, rng: empty_cells(run.rows(slice(None, None, 2)), rng),
    "frozen": lambda run, rng: frozen(run.rows(slice(None, None, 2))),  # noqa: ARG005
    "late stamps": lambda run, rng: jittered(run.rows(slice(None, None, 2)), rng),
}


@dataclass(frozen=True)
class Outcome:
    """Whether intervals hold the truth, and rms errors of the left-out run; the sentence of a refusal."""

    covered: tuple[bool, ...] = ()
    heading: float = np.nan
    position: float = np.nan
    refusal: str = ""


def fitted(craft: Craft, records: Sequence[Record], left_out: Record, seed: int) -> Outcome:
    """Fit the records as a trial would load them, and predict the run that is left out."""
    names = craft.model.parameters.free_names
    truth = np.array([craft.model.parameters[name].value for name in names])
    off = 1.0 + START_SPREAD * np.random.default_rng(seed).uniform(-1.0, 1.0, len(truth))
    blank = craft.model.with_values(dict(zip(names, (truth * off).tolist(), strict=True)))
    try:
        parts = [part for record in records for part in load_parts(Run(record, Role.TRAIN, record.name), 0.0)]
        runs = Runs(tuple(p.record for p in parts), tuple(p.session for p in parts), craft.length)
        fit = estimate_model(blank, runs, None, EstimatorOptions(workers=1))
        heading, position = left_out_errors(fit, left_out, craft.start_s)
    except InputError as error:
        return Outcome(refusal=str(error))
    values, half = fit.estimate.common_parameters[: len(names)], fit.interval.half_width[: len(names)]
    return Outcome(tuple(bool(one) for one in np.abs(values - truth) <= half), heading, position)


def left_out_errors(fit: Estimation, left_out: Record, seconds: float) -> tuple[float, float]:
    """Return rms errors of heading [deg] and position [m]; NaN without positions."""
    problem = fit.estimate.problem
    offsets = np.zeros(problem.unknowns_per_session)
    run = simulate_open_loop(problem, fit.model, left_out, offsets, seconds).record
    errors = rms_errors(left_out, run)
    return errors["psi_deg"], errors.get("position_m", np.nan)


def compared(craft: Craft, kind: str, seed: int) -> tuple[Outcome, Outcome]:
    """Return the outcomes of a log as it was written and of the same readings written cleanly."""
    rng = np.random.default_rng((seed, len(craft.name)))
    *train, left_out = craft.runs(rng)
    pairs = [KINDS[kind](written(run, rng), rng) for run in train]
    as_written = fitted(craft, [one for one, _ in pairs], left_out, seed)
    if kind in ("clean 5 Hz", "all at 1 Hz", "empty cells"):
        return as_written, as_written
    return as_written, fitted(craft, [clean for _, clean in pairs], left_out, seed)


def ratio(outcomes: Sequence[tuple[Outcome, Outcome]]) -> float:
    """Return the ratio of errors to those of the clean logs, over seeds and both channels (root mean squares)."""
    ratios = []
    for channel in ("heading", "position"):
        pairs = [(getattr(a, channel), getattr(b, channel)) for a, b in outcomes if not (a.refusal or b.refusal)]
        squares = np.array([pair for pair in pairs if np.isfinite(pair).all()]) ** 2
        if len(squares):
            ratios.append(np.sqrt(np.sum(squares[:, 0]) / np.sum(squares[:, 1])))
    return float(np.exp(np.mean(np.log(ratios)))) if ratios else np.nan


def run() -> list[Line]:
    """A short sample: the boat's log written in every way, two records each."""
    return judged(["nomoto"], list(KINDS), 2)


def main() -> int:
    """Print a line for each craft and kind, and the limits."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--craft", nargs="*", default=list(crafts()))
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    parser.add_argument("--seeds", type=int, default=4)
    chosen = parser.parse_args()
    print(machine())
    lines = judged(chosen.craft, chosen.kinds, chosen.seeds)
    for line in lines:
        print(f"{line.quantity}: {line.value:.3g} {line.unit} {line.verdict}")
    return 0 if all(line.holds for line in lines) else 1


def judged(craft: Sequence[str], kinds: Sequence[str], seeds: int) -> list[Line]:
    """Print a line for each craft and kind; return the pooled figures with their limits."""
    print(
        f"{'craft':10} {'kind':20} {'coverage':>9} {'heading':>8} {'position':>9} {'ratio':>6} {'refused':>8} {'s':>6}"
    )
    covered, ratios, refused = list[bool](), list[float](), 0
    for name in craft:
        for kind in kinds:
            began = time.perf_counter()
            outcomes = [compared(crafts()[name], kind, seed) for seed in range(seeds)]
            held = [one for outcome, _ in outcomes for one in outcome.covered]
            heading, position = (
                float(np.sqrt(np.mean([getattr(one, c) ** 2 for one, _ in outcomes]))) for c in ("heading", "position")
            )
            count = sum(bool(one.refusal) for one, _ in outcomes)
            covered, ratios, refused = covered + held, [*ratios, ratio(outcomes)], refused + count
            print(
                f"{name:10} {kind:20} {np.mean(held) if held else np.nan:9.2f} {heading:8.3g} {position:9.3g} "
                f"{ratios[-1]:6.3f} {count:8} {time.perf_counter() - began:6.0f}",
                flush=True,
            )
            for text in dict.fromkeys(one.refusal for one, _ in outcomes if one.refusal):
                print(f"           refused: {text}")
    return [
        at_least("coverage of all intervals", float(np.mean(covered)), "", POOLED[0]),
        at_most("coverage of all intervals", float(np.mean(covered)), "", POOLED[1]),
        at_most("largest ratio to the clean log", float(np.nanmax(ratios)), "", MOST_RATIO),
        at_most("logs refused", float(refused), "", 0.0),
    ]


if __name__ == "__main__":
    sys.exit(main())
