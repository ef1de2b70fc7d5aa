"""Is the criterion that `identify` takes the one that predicts best? Each is set by hand on the same records.

Cells: those of Nomoto in the grid of `waves.py`, and records that the fitted first-order model or its sensors do not
describe: a truth of second order, orders in place of the rudder angle, compass filters, backlash, a rudder zero,
spikes, lost rows. Every criterion has the same free rudder zero. A cell's figure is the rms over its records of the
left-out run's heading error, whole and in windows, errors below half the compass's step not counted; the ratio is to
the best criterion in hindsight. Whole runs are compared with what was measured and, besides, with the craft's own
motion: in waves the former hides what criteria differ by.

    python benchmarks/criteria.py --list                              the cells
    python benchmarks/criteria.py --out criteria.json                 everything: 10 records a cell
    python benchmarks/criteria.py --grid 12 --records 4               every fourth of the grid's cells
    python benchmarks/criteria.py --cell 200 201 --records 12         single cells
    python benchmarks/criteria.py --part 1/2 --out half_1.json        every second cell, for two processes
    python benchmarks/criteria.py --show half_1.json half_2.json      tables of files that are there

`--out` keeps each cell as it ends; the same command continues what was interrupted. `--delays` frees a delay of the
rudder for every criterion as well. No campaign: cells differ in how the truth is made, which no trial file says.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from craft_in_seas import nomoto, second_order
from measure import Line, at_most, machine
from seas_fits import ANY_ZERO, Outcome, ResultFile, commit, digest, outcome, trial_of
from simulated_seas import MODERATE, RESOLUTION, Conditions, Craft, Sea, simulated
from waves import SEED, grid

import seatrial as st

RECORDS = 10  # of a cell
AUTO = "auto"
CRITERIA = (AUTO, "output-error", "multiple-shooting", "prediction-error")
FLOOR = 0.5 * math.degrees(RESOLUTION)  # deg, half the compass's step: errors below are not counted
WHOLE, WINDOWS, SHARE, WORST = 1.1, 1.05, 0.95, 1.3  # 1: ratios at most, share of cells, ratio of any cell at most
FIRST = 200  # number of the first cell beside the grid's
DEGREE = math.pi / 180.0  # rad
WAVES, LIGHT = Sea(0.5 * DEGREE, 0.8), MODERATE  # of the cells beside the grid; chosen


@dataclass(frozen=True)
class Case:
    """One cell: its number, a name, the craft that is simulated, and the conditions of its records."""

    number: int
    name: str
    craft: Craft
    conditions: Conditions


def beside() -> list[Case]:
    """Return the cells in which model or sensors are not what the fit takes them for."""
    zigzag, steps = Conditions("zigzag"), Conditions("steps")
    autopilot = Conditions("autopilot", channels=("psi", "r", "u"))
    kinds: list[tuple[str, Craft, Conditions]] = [
        ("second order, zigzag", second_order(), zigzag),
        ("second order, autopilot", second_order(), autopilot),
        ("second order, autopilot, gusts and waves", second_order(), replace(autopilot, gusts=LIGHT, sea=WAVES)),
        ("order for angle, steps", nomoto(), replace(steps, is_order=True)),
        ("order for angle, autopilot", nomoto(), replace(autopilot, is_order=True)),
        ("order for angle, zigzag, gusts", nomoto(), replace(zigzag, is_order=True, gusts=LIGHT)),
        *((f"compass filter {lag:g} s, steps", nomoto(), replace(steps, lag=lag, rate=2.0)) for lag in (0.5, 1.5, 3.0)),
        ("compass filter 1.5 s, autopilot", nomoto(), replace(autopilot, lag=1.5, channels=("psi", "u"))),
        ("backlash 1 deg, zigzag", nomoto(), replace(zigzag, backlash=DEGREE)),
        ("backlash 1 deg, autopilot, waves", nomoto(), replace(autopilot, backlash=DEGREE, sea=WAVES)),
        ("zero 2 deg, zigzag", nomoto(), replace(zigzag, zero=2.0 * DEGREE)),
        ("zero 2 deg, autopilot, gusts", nomoto(), replace(autopilot, zero=2.0 * DEGREE, gusts=LIGHT)),
        ("zero 2 deg, zigzag, waves", nomoto(), replace(zigzag, zero=2.0 * DEGREE, sea=WAVES)),
        ("spikes 0.5 %, steps", nomoto(), replace(steps, spikes=0.005)),
        ("spikes 0.5 %, autopilot, waves", nomoto(), replace(autopilot, spikes=0.005, sea=WAVES)),
        ("lost rows 10 %, zigzag", nomoto(), replace(zigzag, lost=0.1)),
        ("lost rows 10 %, autopilot, gusts and waves", nomoto(), replace(autopilot, lost=0.1, gusts=LIGHT, sea=WAVES)),
    ]
    return [Case(FIRST + i, f"{FIRST + i} {name}", craft, c) for i, (name, craft, c) in enumerate(kinds)]


def cases(grid_cells: int) -> list[Case]:
    """Return so many of the grid's Nomoto cells, evenly taken, and those beside the grid."""
    cells = [c for c in grid() if c.craft == "nomoto"]
    taken = sorted({round(i) for i in np.linspace(0, len(cells) - 1, min(grid_cells, len(cells)))})
    return [Case(cells[i].number, cells[i].name, nomoto(), cells[i].conditions) for i in taken] + beside()


def fit_record(case: Case, draw: int, *, has_delay: bool) -> tuple[list[Outcome], str]:
    """Simulate one record of a cell and fit it by each criterion; return an outcome for each, and the data's hash."""
    train = simulated(case.craft, case.conditions, [SEED, case.number, draw], "train")
    held = simulated(case.craft, case.conditions, [SEED, case.number, draw, 1], "held_out")
    free = st.EstimateSettings(offsets={"delta": ANY_ZERO}, delays={"delta": None} if has_delay else {})
    fits = [outcome(trial_of(case.craft, train, held, free.with_method(name), draw), held, draw) for name in CRITERIA]
    return fits, digest([train, held])


@dataclass(frozen=True)
class Score:
    """Figures of a cell: by criterion the rms [deg] of whole runs, their motion, and windows; infinite: refused.

    refused: records by criterion; used: what the package took, and how often.
    """

    records: int
    whole: dict[str, float]
    motion: dict[str, float]
    windows: dict[str, float]
    refused: dict[str, int]
    used: str

    @property
    def ratios(self) -> tuple[float, float, float]:
        """Whole, motion and windows of the package's choice over the best criterion in hindsight."""
        return tuple(errors[AUTO] / min(errors.values()) for errors in (self.whole, self.motion, self.windows))  # type: ignore[return-value]

    @property
    def holds(self) -> tuple[bool, bool]:
        """Whether whole runs and windows are within their limits; what every criterion refuses is not."""
        return self.ratios[0] <= WHOLE, self.ratios[2] <= WINDOWS


def score(outcomes: Sequence[Outcome], names: Sequence[str]) -> Score:
    """Return the figures of a cell; names: the criterion of each outcome."""
    by = {c: [o for o, n in zip(outcomes, names, strict=True) if n == c] for c in CRITERIA}

    def rms(part: str) -> dict[str, float]:
        errors = {c: [getattr(o, part).get("psi_deg", math.inf) for o in some] for c, some in by.items()}
        return {c: float(np.sqrt(np.mean(np.square(np.maximum(e, FLOOR))))) for c, e in errors.items()}

    kinds = [
        "refused" if o.refusal else o.criterion.partition(" over ")[0].partition(" with ")[0] + ": " + o.disturbance
        for o in by[AUTO]
    ]
    used = max(set(kinds), key=kinds.count)
    refused = {c: sum(bool(o.refusal) for o in some) for c, some in by.items()}
    return Score(len(by[AUTO]), rms("whole"), rms("motion"), rms("windows"), refused, f"{used} {kinds.count(used)}")


def row(name: str, s: Score) -> str:
    """Return a cell's row."""
    ratios = "".join(f"{r:>8.2f}" for r in s.ratios)
    errors = "".join(f"{s.motion[c]:>8.2f}" for c in CRITERIA)
    refused = "/".join(str(s.refused[c]) for c in CRITERIA)
    return f"{name:<72}{s.records:>4}{ratios}{errors}  {refused:<10}{s.used}"


def show(results: ResultFile, some: Sequence[Case]) -> bool:
    """Print a row a cell and the shares of cells within the limits; return whether one is missed."""
    print(
        f"{'cell (ratios to the best in hindsight; rms of motion by criterion, deg)':<72}{'n':>4}{'whole':>8}"
        f"{'motion':>8}{'windows':>8}" + "".join(f"{c[:7]:>8}" for c in CRITERIA) + "  refused   used"
    )
    scores: dict[str, Score] = {}
    for case in some:
        if outcomes := results.outcomes(case.name):
            scores[case.name] = score(outcomes, results.cells[case.name]["criteria"])
            print(row(case.name, scores[case.name]))
    if not scores:
        return False
    both = [all(s.holds) for s in scores.values()]
    for text, ratio, limit in (("whole", 0, WHOLE), ("motion", 1, WHOLE), ("windows", 2, WINDOWS)):
        values = np.array([_or_refused(s.ratios[ratio]) for s in scores.values()])
        print(f"{text} <= {limit}: {np.mean(values <= limit):.0%} of {len(values)} cells, worst {np.max(values):.2f}")
    worst = max(max(_or_refused(s.ratios[0]), _or_refused(s.ratios[2])) for s in scores.values())
    print(f"both: {np.mean(both):.0%} of the cells; limits {SHARE:.0%}, and {WORST} in all")
    return bool(np.mean(both) < SHARE or worst > WORST)


def _or_refused(ratio: float) -> float:
    """Return a ratio, infinite where every criterion refuses."""
    return math.inf if math.isnan(ratio) else ratio


def run_cells(some: Sequence[Case], records: int, results: ResultFile, *, has_delay: bool) -> None:
    """Fit the records of these cells that are not there yet."""
    for case in some:
        missing = [draw for draw in range(records) if draw not in results.draws(case.name)]
        if not missing:
            continue
        fits = [fit_record(case, draw, has_delay=has_delay) for draw in missing]
        names = results.cells.get(case.name, {}).get("criteria", []) + list(CRITERIA) * len(missing)
        described = {"number": case.number, "craft": case.craft.name, **asdict(case.conditions)}
        results.add(case.name, described, [o for one, _ in fits for o in one], fits[0][1], criteria=names)
        print(row(case.name, score(results.outcomes(case.name), names)), flush=True)
        for text in dict.fromkeys(f"{c}: {o.refusal}" for one, _ in fits for c, o in zip(CRITERIA, one, strict=True)
                                  if o.refusal):  # fmt: skip
            print(f"      refused by {text}", flush=True)


def run() -> list[Line]:
    """A short sample: waves on the sensors, second order and a compass filter, two records each."""
    chosen = [c for c in beside() if c.name.endswith(("second order, zigzag", "zero 2 deg, zigzag, waves"))]
    lines = []
    for case in chosen:
        fits = [fit_record(case, draw, has_delay=False)[0] for draw in range(2)]
        s = score([o for one in fits for o in one], list(CRITERIA) * len(fits))
        name = case.name.partition(" ")[2]
        lines += [at_most(f"{name}: whole over the best in hindsight", s.ratios[0], "", WHOLE),
                  at_most(f"{name}: windows over the best in hindsight", s.ratios[2], "", WINDOWS)]  # fmt: skip
    return lines


def main(arguments: list[str]) -> int:
    """Run cells and print their tables; 1 if a limit is missed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--grid", type=int, default=48, help="cells of the grid besides the others")
    parser.add_argument("--cell", nargs="*", type=int, help="numbers of cells; default: all")
    parser.add_argument("--cells", type=int, help="no more than so many")
    parser.add_argument("--part", default="1/1", help="i/n: every n-th cell from the i-th on")
    parser.add_argument("--records", type=int, default=RECORDS, help="of a cell")
    parser.add_argument("--delays", action="store_true", help="free a delay of the rudder for every criterion")
    parser.add_argument("--out", type=Path, metavar="FILE.json")
    parser.add_argument("--show", nargs="*", type=Path, metavar="FILE.json", help="tables of these files only")
    parser.add_argument("--list", action="store_true", help="names of the cells only")
    given = parser.parse_args(arguments)
    some = [c for c in cases(given.grid) if given.cell is None or c.number in given.cell]
    first, parts = (int(x) for x in given.part.split("/"))
    some = some[first - 1 :: parts][: given.cells]
    if given.list:
        print("\n".join(case.name for case in some))
        return 0
    results = ResultFile(given.out)
    for path in given.show or ():
        results.cells |= ResultFile(path).cells
    print(f"{machine()}; commit {commit()}, seed {SEED}")
    if not given.show:
        run_cells(some, given.records, results, has_delay=given.delays)
    print("data: " + " ".join(f"{key[:3]}:{kept['data']}" for key, kept in results.cells.items()))
    return int(show(results, some))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
