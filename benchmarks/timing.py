"""Coverage and efficiency of intervals where nobody recorded when an input took effect.

A Nomoto craft (K 0.12, T 9 s), its rudder 10 degrees to either side in turn, simulated exactly and fitted as `identify`
does by default. A cell is a coefficient x time step x timing x noise. Timing: orders held from sample to sample, and
switching anywhere within a sample; a rudder slewing at 2.5 deg/s; the same recorded late by 0.3 of a step, or with its
corners anywhere within a sample; held orders at the starts of segments of 10 s, fitted by multiple shooting, whose free
initial states cost more than the bound knows. The bound is that of Cramer and Rao with the delay free under its prior.
`--craft waterjet`: the example series, its nozzle recorded late by `--late` seconds.
"""

import argparse
import hashlib
import math
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from measure import Line, at_least, at_most

import seatrial as st
from seatrial.data.example_series import demo_series

Array = npt.NDArray[np.float64]
TRUE = {"K": 0.12, "T": 9.0}  # 1/s and s: gain and time constant of a boat of some 8 m; chosen
ANGLE, RATE = math.radians(10.0), math.radians(2.5)  # rad and rad/s of the rudder; chosen
PERIOD, DURATION = 26.0, 494.0  # s between orders and of a run, nineteen of them; chosen
SEGMENT = 10.0  # s of a segment, of which two lie between orders on segment starts; chosen
NOISE = {"psi": math.radians(0.2), "r": math.radians(0.1)}  # rad and rad/s: compass and gyro of a boat; chosen
LATE = 0.3  # of a time step, by which a late recorder lags; chosen
STEPS = (0.1, 0.5, 1.0, 2.0)  # s between samples
TIMINGS = ("held", "anywhere", "ramps", "late", "corners", "segments")
LIMITED = ("held", "ramps", "late")  # timings whose errors have limits; the others are shown
LEVELS = (1.0, 0.1)  # of the noise
FINE = TRUE["T"] / 9.0  # s, time step up to which each cell has a limit
WITHIN = 1.96  # standard deviations of a 95 % interval of known variance


@dataclass(frozen=True)
class Cell:
    """One time step, timing and level of noise."""

    dt: float
    timing: str
    level: float


@dataclass(frozen=True)
class Piece:
    """The rudder from `start` [s] on: value [rad] and rate [rad/s]."""

    start: float
    value: float
    rate: float


def rudder(cell: Cell, rng: np.random.Generator) -> list[Piece]:
    """Return the rudder's pieces over a run."""
    period = 2.0 * SEGMENT if cell.timing == "segments" else PERIOD
    first = period if cell.timing == "segments" else 0.5 * PERIOD
    pieces, before, side = [Piece(-1.0, 0.0, 0.0)], 0.0, 1.0
    for order in np.arange(first, DURATION, period):
        after = side * ANGLE
        if cell.timing in ("held", "anywhere", "segments"):
            start = math.ceil(order / cell.dt - 1e-9) * cell.dt  # at the next sample; a billionth is rounding
            pieces.append(Piece(start + (rng.uniform(0.0, cell.dt) if cell.timing == "anywhere" else 0.0), after, 0.0))
        else:
            start = order + (rng.uniform(0.0, cell.dt) if cell.timing == "corners" else 0.0)
            pieces += [Piece(start, before, side * RATE), Piece(start + abs(after - before) / RATE, after, 0.0)]
        before, side = after, -side
    return pieces


def rudder_at(pieces: Sequence[Piece], time: Array) -> Array:
    """Return the rudder at these times, rad; at a step its new value."""
    starts = np.array([p.start for p in pieces])
    place = np.maximum(np.searchsorted(starts, time + 1e-9, side="right") - 1, 0)  # s of rounding
    value, rate = np.array([(p.value, p.rate) for p in pieces]).T
    return value[place] + rate[place] * (time - starts[place])


def motion(pieces: Sequence[Piece], time: Array, values: Sequence[float]) -> Array:
    """Return heading and yaw rate, (n, 2), exactly: K, T, delay of the rudder [s], heading and rate at the start.

    T dr/dt + r = K delta, psi' = r; solved for a rudder that is straight in pieces.
    """
    gain, lag, delay, psi, r = values
    late = [Piece(p.start + delay, p.value, p.rate) for p in pieces]
    edges = np.unique(np.concatenate([time, [p.start for p in late if time[0] < p.start < time[-1]]]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    place = np.searchsorted(np.array([p.start for p in late]), middle, side="right") - 1
    out = {edges[0]: (psi, r)}
    for (a, b), k in zip(pairwise(edges.tolist()), place.tolist(), strict=True):
        h, piece = b - a, late[max(k, 0)]
        steady = gain * (piece.value + piece.rate * (a - piece.start - lag))
        decay = math.exp(-h / lag)
        psi += steady * h + 0.5 * gain * piece.rate * h**2 + (r - steady) * lag * (1.0 - decay)
        r = steady + gain * piece.rate * h + (r - steady) * decay
        out[b] = (psi, r)
    return np.array([out[t] for t in time.tolist()])


@dataclass(frozen=True)
class Fitted:
    """One coefficient of one fit: error, its interval's half width, standard error and bound, all SI."""

    error: float
    half: float
    standard_error: float
    bound: float
    is_settled: bool

    @property
    def is_inside(self) -> bool:
        """Whether the interval holds the truth."""
        return abs(self.error) <= self.half


def simulated(cell: Cell, seed: int) -> tuple[st.Record, list[Piece]]:
    """Return the record of a cell with noise, and the rudder that steered it."""
    rng = np.random.default_rng([seed, int(1000 * cell.dt), TIMINGS.index(cell.timing)])
    time = np.asarray(np.arange(round(DURATION / cell.dt) + 1) * cell.dt, dtype=np.float64)
    pieces = rudder(cell, rng)
    y = motion(pieces, time, (TRUE["K"], TRUE["T"], 0.0, 0.0, 0.0))
    recorded = rudder_at(pieces, time - LATE * cell.dt if cell.timing == "late" else time)
    noise = cell.level * np.array([NOISE["psi"], NOISE["r"]]) * rng.standard_normal(y.shape)
    values = {"delta": recorded, "psi": y[:, 0] + noise[:, 0], "r": y[:, 1] + noise[:, 1]}
    return st.Record.from_arrays(f"{cell.timing}-{seed}", time, values), pieces


def bounds(cell: Cell, pieces: Sequence[Piece], time: Array) -> dict[str, float]:
    """Return the Cramer-Rao bounds of K and T with delay and initial state free, the delay under its prior."""
    at = np.array([TRUE["K"], TRUE["T"], 0.0, 0.0, 0.0])
    steps = np.array([1e-5, 1e-3, 1e-3 * cell.dt, 1e-5, 1e-5])  # SI, of central differences; chosen
    scale = 1.0 / (cell.level * np.array([NOISE["psi"], NOISE["r"]]))
    columns = [
        ((motion(pieces, time, tuple(at + d)) - motion(pieces, time, tuple(at - d))) / (2.0 * d.sum()) * scale).ravel()
        for d in np.diag(steps)
    ]
    jacobian = np.column_stack(columns)
    information = jacobian.T @ jacobian
    information[2, 2] += 12.0 / cell.dt**2  # of a uniform distribution over a sample
    return dict(zip(("K", "T"), np.sqrt(np.diag(np.linalg.inv(information)))[:2].tolist(), strict=True))


def fitted(cell: Cell, seed: int) -> dict[str, Fitted]:
    """Return K and T of one record as `identify` estimates them."""
    record, pieces = simulated(cell, seed)
    settings = st.EstimateSettings(segment_s=SEGMENT) if cell.timing == "segments" else st.EstimateSettings()
    trial = st.Trial(st.Ship("boat", {"L": 8.0}), (st.Run(record),), st.models.nomoto(), estimate=settings)
    fit = st.identify(trial)
    bound = bounds(cell, pieces, record.time)
    is_settled = all(f.code != "not-converged" for f in fit.findings)
    rows = {}
    for c in fit.coefficients:
        if c.name in TRUE and c.lower is not None and c.upper is not None and c.standard_error is not None:
            error = c.estimate - TRUE[c.name]
            rows[c.name] = Fitted(error, 0.5 * (c.upper - c.lower), c.standard_error, bound[c.name], is_settled)
    return rows


def cells(given: argparse.Namespace) -> Iterator[Cell]:
    """Yield the chosen cells."""
    for dt in given.steps:
        for timing in given.timings:
            for level in LEVELS:
                yield Cell(dt, timing, level)


def report(results: dict[Cell, list[dict[str, Fitted]]]) -> list[str]:
    """Return the table, cell by cell, and the pooled numbers with their limits."""
    lines = ["   dt timing    noise coef  covered  error/se  bias %  se %   rmse/bound  limits missed"]
    inside, efficient, unsettled = [], [], 0
    for cell, fits in results.items():
        for name, true in TRUE.items():
            mine = [f[name] for f in fits if name in f]
            if not mine:
                continue
            error, bound = np.array([m.error for m in mine]), np.array([m.bound for m in mine])
            covered = float(np.mean([m.is_inside for m in mine]))
            score = float(np.mean([m.error / m.standard_error for m in mine]))
            bias, ratio = float(100.0 * np.mean(error) / true), float(np.sqrt(np.mean((error / bound) ** 2)))
            spread = float(100.0 * np.mean([m.standard_error for m in mine]) / true)
            unsettled += sum(not m.is_settled for m in mine) if name == "T" else 0
            inside += [m.is_inside for m in mine]
            missed = []
            if cell.dt <= FINE:
                missed += ["coverage"] if covered < 0.80 else []
                if cell.timing in LIMITED:
                    efficient += ((error / bound) ** 2).tolist()
                    missed += ["error"] if abs(score) > 0.2 + 2.6 / math.sqrt(len(mine)) else []
                    missed += ["bias"] if name == "T" and cell.level < 1.0 and abs(bias) > 0.3 else []
                    missed += ["efficiency"] if not 0.65 <= ratio <= 1.4 else []
            lines.append(
                f"{cell.dt:5.1f} {cell.timing:<9} {cell.level:5.1f} {name:>4} {covered:8.2f} {score:9.2f} {bias:7.3f} "
                f"{spread:6.3f} {ratio:9.2f}  {', '.join(missed)}"
            )
    lines.append(f"pooled coverage {np.mean(inside):.3f} (0.92 to 0.98); not converged {unsettled}")
    if efficient:
        lines.append(f"pooled rmse over bound, dt <= {FINE:g} s: {math.sqrt(np.mean(efficient)):.3f} (0.95 to 1.10)")
    return lines


def waterjet(given: argparse.Namespace) -> list[str]:
    """Return coverage of the waterjet craft's coefficients with its nozzle recorded late."""
    inside, delays = [], []
    for seed in range(given.first, given.first + given.seeds):
        (run, *_), craft = demo_series(seed, executes=given.executes)
        moved = np.interp(run.time - given.late, run.time, run["delta"])
        late = run.with_channel("delta", run.channel("delta").with_values(moved)).resampled(given.rate)
        # as a file has it: nothing says at what rate the nozzle was simulated
        bare = {s: replace(c, sample_s=0.0, between="") for s, c in late.channels.items()}
        record = replace(late, channels=bare)
        trial = st.Trial(st.Ship("waterjet", {"L": 9.8}), (st.Run(record),), craft)
        fit = st.identify(trial)
        for c in fit.coefficients:
            if c.lower is not None and c.upper is not None:
                inside.append(c.lower <= float(craft.parameters[c.name].value or 0.0) <= c.upper)
        delays += [o.estimate for o in fit.offsets if o.name == "delta delay"]
    return [
        f"waterjet, nozzle late by {given.late:g} s, {given.rate:g} Hz: {np.mean(inside):.3f} of {len(inside)} inside; "
        f"delays {', '.join(f'{d:.3f}' for d in delays)} s"
    ]


def run() -> list[Line]:
    """A short sample: samples of 1 s, every timing with a limit at both levels of noise, four records each."""
    fits = [
        one
        for timing in LIMITED
        for level in LEVELS
        for seed in range(4)
        for one in fitted(Cell(1.0, timing, level), seed).values()
    ]
    squares = [(one.error / one.bound) ** 2 for one in fits]
    return [
        at_least("coverage of K and T", float(np.mean([one.is_inside for one in fits])), "", 0.92),  # as the report
        Line("their errors over the Cramer-Rao bound, rms", math.sqrt(np.mean(squares)), ""),
        at_most("fits that did not converge", float(sum(not one.is_settled for one in fits)), "", 0.0),
    ]


def _origin() -> str:
    """Commit, and a hash of the records of one cell."""
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    record, _ = simulated(Cell(0.5, "held", 1.0), 0)
    digest = hashlib.sha256(record.matrix(("delta", "psi", "r")).tobytes()).hexdigest()[:12]
    return f"commit {commit.stdout.strip() or 'unknown'}, records {digest}"


def main(arguments: list[str]) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--craft", choices=("nomoto", "waterjet"), default="nomoto")
    parser.add_argument("--steps", type=float, nargs="+", default=list(STEPS))
    parser.add_argument("--timings", nargs="+", choices=TIMINGS, default=list(TIMINGS))
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--late", type=float, default=0.15)
    parser.add_argument("--rate", type=float, default=2.0)
    parser.add_argument("--executes", type=int, default=5)
    given = parser.parse_args(arguments)
    print(f"seeds {given.first} to {given.first + given.seeds - 1}, {_origin()}", flush=True)
    if given.craft == "waterjet":
        print("\n".join(waterjet(given)))
        return 0
    seeds = range(given.first, given.first + given.seeds)
    results = {cell: [fitted(cell, seed) for seed in seeds] for cell in cells(given)}
    print("\n".join(report(results)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
