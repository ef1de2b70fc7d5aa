"""Disturbances with a memory, and a controller that was on: are estimates at the bound and their intervals honest?

Every cell has a size a and a memory of the disturbance, open loop (random binary rudder) or closed (a controller on a
square wave of heading), 600 s at 10 Hz. Every run is identified from scratch by the default of `identify`; errors are
compared with the Cramer-Rao bound of the true disturbance on the same record, and with the error that the record itself
has: of one scoring step from the true coefficients with the true disturbance, which no estimator can undo.
`python benchmarks/gusts.py --craft nomoto --generator independent --runs 80`. No campaign: a cell is one map over its
draws, and what it compares with is the likelihood of the true disturbance, which no table of a campaign has.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from measure import Line, machine
from numpy.typing import NDArray
from standard_craft import CRAFT

from seatrial.core.values import InputError, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.identify.nonlinear_intervals import default_profiles
from seatrial.numerics.workers import map_in_processes
from seatrial.problems.disturbed_craft import SECONDS, Disturbance, independent_nomoto, limit_of, records

Array = NDArray[np.float64]
SIZES, MEMORIES, RUNS, SEED = (0.1, 0.3, 1.0), (0.0, 1.0, 5.0, 30.0), 80, 16
CELL_COVERAGE, POOLED_COVERAGE = 0.86, 0.92
CELL_BIAS, POOLED_BIAS, RMSE_LIMIT, WIDTHS = 0.35, 0.15, 1.2, (0.9, 1.15)


@dataclass(frozen=True)
class Cell:
    """One cell of the grid."""

    craft: str
    disturbance: Disturbance
    is_closed: bool
    seconds: float = SECONDS

    @property
    def name(self) -> str:
        """For the table."""
        d = self.disturbance
        more = (f", waves {d.waves:g}" if d.waves else "") + (
            f", offset {np.degrees(d.offset):g} deg" if d.offset else ""
        )
        more += f", {self.seconds:g} s" if self.seconds != SECONDS else ""
        return f"a {d.size:g}, memory {d.memory:g} s, {'closed' if self.is_closed else 'open'}{more}"


@dataclass(frozen=True, eq=False)
class Outcome:
    """Errors, standard errors and bounds of the coefficients, (k,) each; what was chosen.

    is_covered: whether the 95 % interval of a fit, of a short record by profile likelihood, holds the truth.
    efficient: errors of an efficient estimate from the same record.
    failure: the sentence by which the record was refused.
    """

    error: Array
    standard_error: Array
    bound: Array
    efficient: Array
    is_covered: NDArray[np.bool_]
    disturbance: str
    is_white: bool
    seconds: float
    failure: str = ""


@dataclass(frozen=True)
class Item:
    """One record of a cell."""

    cell: Cell
    record: Record


def outcome(item: Item) -> Outcome:
    """Identify one record."""
    craft, disturbance = CRAFT[item.cell.craft], item.cell.disturbance
    model = craft.model
    blank = model.with_values(dict(craft.guess))
    names = model.parameters.free_names
    truth = np.array([model.parameters[n].value for n in names])
    bound, efficient = limit_of(craft, disturbance, item.record)
    began = time.process_time()
    nothing = np.full(len(names), np.nan)
    try:
        fit = estimate_model(
            blank,
            Runs.one_session_each([item.record], craft.length),
            EstimateSettings().with_known_timing(blank.input_names),  # as in the bound
            EstimatorOptions(workers=1),
        )
    except InputError as error:
        spent = time.process_time() - began
        none = np.zeros(len(names), dtype=bool)
        return Outcome(nothing, nothing, bound, efficient, none, "", False, spent, str(error))
    k, profiles = len(names), {p.parameter: (p.lower, p.upper) for p in default_profiles(fit)}
    spent, values, half = time.process_time() - began, fit.estimate.common_parameters, fit.interval.half_width
    limits = [profiles.get(n, (values[i] - half[i], values[i] + half[i])) for i, n in enumerate(names)]
    is_covered = [(low is None or low <= t) and (high is None or t <= high)
                  for (low, high), t in zip(limits, truth, strict=True)]  # fmt: skip
    return Outcome(
        fit.estimate.common_parameters[:k] - truth, fit.interval.standard_error[:k], bound,
        efficient, np.array(is_covered), fit.noise_model.disturbance, fit.whiteness.is_white, spent,
    )  # fmt: skip


def outcomes(cell: Cell, generator: str, runs: int, seed: int, workers: int | None) -> list[Outcome]:
    """Make and identify the runs of a cell."""
    d = cell.disturbance
    entropy = [seed, round(100 * d.size), round(10 * d.memory), int(cell.is_closed), round(100 * d.waves)]
    rng, craft = np.random.default_rng(entropy), CRAFT[cell.craft]
    make = independent_nomoto if generator == "independent" and cell.craft == "nomoto" else records
    step = {} if make is independent_nomoto or generator == "own" else {"step": 0.02}
    items = [Item(cell, r) for r in make(craft, d, runs, rng, is_closed=cell.is_closed, seconds=cell.seconds, **step)]
    return map_in_processes(outcome, items, workers=workers) if workers != 1 else [outcome(i) for i in items]


@dataclass(frozen=True)
class Score:
    """The figures of a cell, or of many pooled; of_records: of efficient estimates from the same records."""

    runs: int
    coverage: float
    bias: float
    ratio: float
    width: float
    failures: int
    chosen: str
    white: float
    seconds: float
    bias_of_records: float
    ratio_of_records: float

    def problems(self, coverage: float, bias: float, *, has_bound: bool = True) -> str:
        """Which limits are missed."""
        missed = [
            text
            for text, holds in (
                (f"coverage < {coverage:.0%}", self.coverage >= coverage),
                (f"bias > {bias:g}", self.bias <= bias),
                (f"RMSE/bound > {RMSE_LIMIT:g}", self.ratio <= RMSE_LIMIT or not has_bound),
                (f"width outside {WIDTHS[0]:g}-{WIDTHS[1]:g}", WIDTHS[0] <= self.width <= WIDTHS[1] or not has_bound),
                ("failures", self.failures == 0),
            )
            if not holds
        ]
        return "; ".join(missed)


def score(results: Sequence[Outcome]) -> Score:
    """The worst coefficient decides coverage, bias and ratio."""
    good = [o for o in results if not o.failure]
    names = ("error", "standard_error", "bound", "efficient")
    error, deviation, limit, efficient = (np.array([getattr(o, n) for o in good]) for n in names)
    kinds = [o.disturbance.partition(" on ")[0] for o in good]
    chosen = max(set(kinds), key=kinds.count) if kinds else "none fitted"
    return Score(
        len(results),
        float(np.min(np.mean([o.is_covered for o in good], axis=0))),
        float(np.max(np.abs(np.mean(error / deviation, axis=0)))),
        float(np.max(np.sqrt(np.mean((error / limit) ** 2, axis=0)))),
        float(np.median(np.median(deviation / limit, axis=0))),
        len(results) - len(good),
        f"{chosen} {kinds.count(chosen)}/{len(kinds)}",
        float(np.mean([o.is_white for o in good])),
        float(np.median([o.seconds for o in good])),
        float(np.max(np.abs(np.mean(efficient / limit, axis=0)))),
        float(np.max(np.sqrt(np.mean((efficient / limit) ** 2, axis=0)))),
    )


def grid(craft: str) -> list[Cell]:
    """Every cell of a craft."""
    sizes, memories = (SIZES, MEMORIES) if craft == "nomoto" else ((0.3,), (1.0, 10.0))
    kinds = [Disturbance(0.0, 0.0), *(Disturbance(a, tau) for a, tau in product(sizes, memories))]
    return [Cell(craft, d, closed) for d in kinds for closed in (False, True)]


def extra_cells() -> list[Cell]:
    """Nomoto with waves, and with an unknown rudder offset of 1.5 deg."""
    offset = float(np.radians(1.5))
    kinds = [
        Disturbance(0.3, 5.0, waves=0.4),
        Disturbance(0.3, 5.0, offset=offset),
        Disturbance(0.0, 0.0, offset=offset),
    ]
    return [Cell("nomoto", d, closed) for d in kinds for closed in (False, True)]


def short_cells() -> list[Cell]:
    """Nomoto in few memories of the disturbance, and in few changes of the reference."""
    d = Disturbance(0.5, 5.0)
    return [Cell("nomoto", d, False, 60.0), Cell("nomoto", d, True, 120.0), Cell("nomoto", d, True, 240.0)]


def run() -> list[Line]:
    """A short sample: one gusty cell, open and closed."""
    table = []
    for closed in (False, True):
        cell = Cell("nomoto", Disturbance(0.5, 5.0), closed)
        s = score(outcomes(cell, "independent", 20, SEED, None))
        holds = s.coverage >= 0.8 and s.failures == 0  # of twenty runs
        table.append(Line(f"{cell.name}: coverage", s.coverage, "", "0.8 of 20 runs", holds))
        table.append(Line(f"{cell.name}: RMSE/bound", s.ratio, ""))
    return table


def main(arguments: list[str]) -> int:
    """Print the table of a craft; 1 if a limit is missed."""
    parser = argparse.ArgumentParser(description="estimates and intervals under gusts and feedback")
    parser.add_argument("--craft", choices=tuple(CRAFT), default="nomoto")
    parser.add_argument("--generator", choices=("own", "independent"), default="independent")
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--cells", nargs="*", type=int, default=None, help="numbers of cells; default: all")
    parser.add_argument("--extra", action="store_true", help="waves and rudder offsets instead of the grid")
    parser.add_argument("--short", action="store_true", help="records of one to four minutes instead of the grid")
    parser.add_argument("--workers", type=int, default=None)
    given = parser.parse_args(arguments)
    print(machine())
    cells = extra_cells() if given.extra else short_cells() if given.short else grid(given.craft)
    cells = [c for i, c in enumerate(cells) if given.cells is None or i in given.cells]
    pooled: list[Outcome] = []
    missed = False
    for cell in cells:
        results = outcomes(cell, given.generator, given.runs, given.seed, given.workers)
        pooled += results
        s = score(results)
        problems = s.problems(
            CELL_COVERAGE, CELL_BIAS, has_bound=not cell.disturbance.waves
        )  # the bound knows no waves
        missed = _print(cell.name, s, problems) or missed
        for text in dict.fromkeys(o.failure for o in results if o.failure):
            print(f"      refused: {text}", flush=True)
    s = score(pooled)
    missed = _print("pooled", s, s.problems(POOLED_COVERAGE, POOLED_BIAS)) or missed
    return int(missed)


def _print(name: str, s: Score, problems: str) -> bool:
    print(
        f"{name:<36} cov {s.coverage:.3f} bias {s.bias:.2f} rmse/bound {s.ratio:.2f} width {s.width:.2f} "
        f"failures {s.failures} {s.chosen} white {s.white:.3f} {s.seconds:.2f} s "
        f"(records: bias {s.bias_of_records:.2f} rmse/bound {s.ratio_of_records:.2f})  {problems or 'holds'}",
        flush=True,
    )
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
