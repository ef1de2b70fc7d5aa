"""An ordinary log made at sea: are coefficients right, intervals honest, and is nothing refused, whatever the waves?

A grid of craft x manoeuvre x waves x gusts x sampling x channels, thinned by a seeded design in which each level of a
factor comes equally often, 120 cells at most (48 of them Nomoto's). Truth is simulated exactly (`simulated_seas.py`), a
second run under the same conditions is left out, and `seatrial.identify` is called as a user would. Reported of a
cell: coverage of the 95 % intervals, RMSE over the Cramer-Rao bound of the true disturbance (`seas_bound.py`; a dash
where it is not computed), refusals, CPU seconds and their ratio to the same record without waves, and errors of the
left-out run against the craft's own motion.

    python benchmarks/waves.py --list                                     the cells
    python benchmarks/waves.py --out waves.json                           everything: 40 seeds of Nomoto, 10 of others
    python benchmarks/waves.py --craft nomoto --seeds 4 --out waves.json  a part of it
    python benchmarks/waves.py --cell 3 17 --seeds 2                      single cells
    python benchmarks/waves.py --part 1/2 --out half_1.json               every second cell, for two processes
    python benchmarks/waves.py --show half_1.json half_2.json             tables of files that are there
    python benchmarks/waves.py --show new.json --against old.json         and CPU over that of another version

`--out` keeps each cell as it ends; the same command continues what was interrupted. No campaign: cells differ in how
the truth is made, which no trial file says.
"""

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from craft_in_seas import CRAFT
from measure import Line, at_least, machine
from numpy.typing import NDArray
from seas_bound import standard_errors
from seas_fits import Outcome, ResultFile, commit, digest, outcome, trial_of
from simulated_seas import MODERATE, Conditions, Manoeuvre, Sea, simulated

import seatrial as st

SEED = 45  # of design, records and priors
CELLS = {"nomoto": 48, "waterjet": 24, "thrusters": 24, "mmg": 24}  # cells of each craft; 120 in all
SEEDS = {"nomoto": 40}  # records of a cell
OTHERS = 10  # records of a cell of another craft
MANOEUVRES: dict[str, tuple[Manoeuvre, ...]] = {"thrusters": ("zigzag", "steps", "autopilot", "station")}
STEERED: tuple[Manoeuvre, ...] = ("zigzag", "steps", "autopilot")
# deg: rms of yaw by waves, a cell without waves for four with; rad/s: frequencies of encounter; Hz: rates of records
RMS, FREQUENCIES, RATES = (0.0, 0.2, 0.2, 1.0, 1.0), (0.4, 0.8, 1.3), (1.0, 2.0, 10.0)
POSITIONS, SPEEDS = ("x0", "y0"), ("u", "v")
CHANNELS = {"nomoto": (("psi", "u"), ("psi", "r", "u"), ("psi", "r", *SPEEDS, *POSITIONS))}
# models of three degrees of freedom start from velocities or positions: without these they are refused, rightly
PLANAR = (("psi", *POSITIONS), ("psi", "r", *POSITIONS), ("psi", "r", *SPEEDS, *POSITIONS))
SHORT = 2.0 / 3.0  # 1, length of a record at 10 Hz over those at less, for the time that fits take; chosen
UNCOUNTED = 0.002  # 1, half width over value below which an interval is not counted
POOLED, LEAST, RATIO = (0.92, 0.98), 0.80, (0.90, 1.20)  # 1: coverage, of a cell, and RMSE over the bound
SLOWER = 4.0  # 1, CPU over that of the same record without waves, at most


@dataclass(frozen=True)
class Cell:
    """One cell: its number in the grid, the craft, and the conditions of its records."""

    number: int
    craft: str
    conditions: Conditions

    @property
    def name(self) -> str:
        """For tables, and the key in files."""
        c, sea = self.conditions, self.conditions.sea
        waves = f"{math.degrees(sea.rms):.1f} deg {sea.frequency:g} rad/s" if sea.rms else "no waves"
        kind = f" x{sea.peaks} {'force' if sea.is_force else 'sensor'}" if sea.rms else ""
        gusts = "gusts" if c.gusts else "calm"
        all_of = "all" if "v" in c.channels else "psi+r" if "r" in c.channels else "psi"
        channels = all_of + ("+positions" if "x0" in c.channels and all_of != "all" else "")
        return f"{self.number:03d} {self.craft} {c.manoeuvre} {waves}{kind} {gusts} {c.rate:g} Hz {channels}"


def grid() -> list[Cell]:
    """Return the thinned grid: of each factor a shuffled column in which every level comes equally often."""
    cells: list[Cell] = []
    for craft, count in CELLS.items():
        rng = np.random.default_rng([SEED, count, len(cells)])
        levels = (
            MANOEUVRES.get(craft, STEERED),
            RMS,
            FREQUENCIES,
            (1, 2),
            (False, True),
            (0.0, MODERATE),
            RATES,
            CHANNELS.get(craft, PLANAR),
        )
        columns = [rng.permutation(np.arange(count) % len(factor)) for factor in levels]
        for row in zip(*columns, strict=True):
            manoeuvre, rms, frequency, peaks, force, gusts, rate, channels = (
                factor[i] for factor, i in zip(levels, row, strict=True)
            )
            sea = Sea(math.radians(rms), frequency, peaks, force) if rms else Sea()
            seconds = CRAFT[craft]().seconds * (SHORT if rate > 2.0 else 1.0)  # type: ignore[operator]
            cells.append(Cell(len(cells), craft, Conditions(manoeuvre, sea, gusts, rate, channels, seconds)))  # type: ignore[arg-type]
    return cells


_WARM: set[tuple[str, tuple[str, ...]]] = set()
"""Craft and channels whose code is compiled in this process."""
BRIEF = 120.0  # s, of the record that is fitted first so that its code is compiled; chosen


def fit_record(cell: Cell, draw: int) -> tuple[Outcome, str]:
    """Simulate and identify one record of a cell, and the same without waves; return outcome and hash of the data."""
    craft, conditions = CRAFT[cell.craft](), cell.conditions
    entropy = (SEED, cell.number, draw)

    def fitted(these: Conditions) -> tuple[Outcome, str]:
        train, held = simulated(craft, these, entropy, "train"), simulated(craft, these, (*entropy, 1), "held_out")
        found = outcome(trial_of(craft, train, held, st.EstimateSettings(), draw), held, draw)
        return replace(found, bound=standard_errors(craft, these, train)), digest([train, held])

    if (kind := (cell.craft, conditions.channels)) not in _WARM:
        _WARM.add(kind)
        fitted(replace(conditions, seconds=BRIEF, rate=1.0))
    found, data = fitted(conditions)
    calm = fitted(replace(conditions, sea=replace(conditions.sea, rms=0.0)))[0] if conditions.sea.rms else found
    return replace(found, extra={"calm_seconds": calm.seconds}), data


@dataclass(frozen=True)
class Score:
    """Figures of a cell, or of several together; NaN where there is nothing to tell.

    inside, of: intervals that hold the truth, of those that count; ratios: errors over bounds.
    """

    records: int
    refused: int
    unconverged: int
    inside: int
    of: int
    ratios: tuple[float, ...]
    error: float
    seconds: float
    slower: float
    used: str
    heading: float
    position: float

    @property
    def coverage(self) -> float:
        """Share of the intervals that hold the truth."""
        return self.inside / self.of if self.of else math.nan

    @property
    def ratio(self) -> float:
        """RMSE over the bound, all coefficients together."""
        return float(np.sqrt(np.mean(np.square(self.ratios)))) if self.ratios else math.nan


def score(outcomes: Sequence[Outcome], truth: dict[str, float]) -> Score:
    """Return the figures of one craft's outcomes."""
    good = [o for o in outcomes if not o.refusal]
    counted = [_is_inside(o, n, t) for o in good for n, t in truth.items() if _is_counted(o, n)]
    ratios = [(o.estimate[n] - truth[n]) / o.bound[n] for o in good for n in o.bound]
    relative = [[o.estimate[n] / t - 1.0 for o in good] for n, t in truth.items()]
    kinds = [f"{o.criterion.partition(' over ')[0].partition(' with ')[0]}: {o.disturbance}" for o in good]
    used = max(set(kinds), key=kinds.count) if kinds else "-"
    return Score(
        len(outcomes), len(outcomes) - len(good), sum(not o.is_converged for o in good), sum(counted), len(counted),
        tuple(ratios), max((float(np.sqrt(np.mean(np.square(r)))) for r in relative if r), default=math.nan),
        _median([o.seconds for o in outcomes]),
        _median([o.seconds for o in outcomes]) / _median([o.extra["calm_seconds"] for o in outcomes]),
        f"{used} {kinds.count(used)}/{len(kinds)}", _median([o.motion["psi_deg"] for o in good]),
        _median([o.motion["position_m"] for o in good if "position_m" in o.motion]),
    )  # fmt: skip


def _median(values: Sequence[float] | NDArray[np.float64]) -> float:
    return float(np.median(values)) if len(values) else math.nan


def _is_counted(one: Outcome, name: str) -> bool:
    low, high = one.lower[name], one.upper[name]
    return low is None or high is None or 0.5 * (high - low) >= UNCOUNTED * abs(one.estimate[name])


def _is_inside(one: Outcome, name: str, truth: float) -> bool:
    low, high = one.lower[name], one.upper[name]
    return (low is None or low <= truth) and (high is None or truth <= high)


def show(results: ResultFile, cells: Sequence[Cell], base: ResultFile) -> bool:
    """Print a row a cell, what is pooled, the worst, and CPU over that of `base`; return whether a limit is missed."""
    print(
        f"{'cell':<72}{'n':>4}{'ref':>4}{'not':>4}{'cover':>7}{'/bound':>8}{'error':>8}{'CPU s':>7}{'x calm':>7}"
        f"{'psi deg':>9}{'pos m':>8}  used (ref: refused, not: not converged, error: rms of the worst coefficient, %)"
    )
    scores: dict[str, Score] = {}
    for cell in cells:
        if outcomes := results.outcomes(cell.name):
            scores[cell.name] = one = score(outcomes, CRAFT[cell.craft]().truth)
            print(row(cell.name, one), flush=True)
    if not scores:
        return False
    _show_factors(scores, cells)
    missed = _show_pooled(scores)
    return _show_slower(results, cells, base) or missed


def _show_factors(scores: dict[str, Score], cells: Sequence[Cell]) -> None:
    """Print what is pooled over the cells with each level of a factor."""
    factors: dict[str, Callable[[Cell], object]] = {
        "craft": lambda c: c.craft,
        "manoeuvre": lambda c: c.conditions.manoeuvre,
        "waves, deg": lambda c: round(math.degrees(c.conditions.sea.rms), 3),
        "waves, rad/s": lambda c: c.conditions.sea.frequency if c.conditions.sea.rms else "none",
        "peaks": lambda c: c.conditions.sea.peaks if c.conditions.sea.rms else "none",
        "waves as": lambda c: ("force" if c.conditions.sea.is_force else "motion") if c.conditions.sea.rms else "none",
        "gusts": lambda c: c.conditions.gusts,
        "rate, Hz": lambda c: c.conditions.rate,
        "channels": lambda c: c.name.split()[-1],
    }
    print("pooled by factor: records, refused, not converged, coverage, RMSE/bound, median |error|/bound")
    for factor, level_of in factors.items():
        levels: dict[object, list[Score]] = {}
        for cell in cells:
            if cell.name in scores:
                levels.setdefault(level_of(cell), []).append(scores[cell.name])
        for level, some in sorted(levels.items(), key=lambda pair: str(pair[0])):
            counts = [sum(getattr(s, part) for s in some) for part in ("records", "refused", "unconverged")]
            inside, of = sum(s.inside for s in some), sum(s.of for s in some)
            ratios = np.abs([r for s in some for r in s.ratios])
            rms = float(np.sqrt(np.mean(ratios**2))) if len(ratios) else math.nan
            share = inside / of if of else math.nan
            print(f"  {factor:<14}{level!s:<16}" + "".join(f"{n:>6}" for n in counts)
                  + f"{share:>8.3f}{_dash(rms):>9}{_dash(_median(ratios)):>8}")  # fmt: skip


def _show_slower(results: ResultFile, cells: Sequence[Cell], base: ResultFile) -> bool:
    """Print by how much cells take longer than they did; return whether any does."""
    slower = {}
    for cell in cells:
        before = {o.draw: o.seconds for o in base.outcomes(cell.name)}
        if both := [(o.seconds, before[o.draw]) for o in results.outcomes(cell.name) if o.draw in before]:
            slower[cell.name] = sum(now for now, _ in both) / sum(then for _, then in both)
    if slower:
        print(f"CPU over that of the other file, median of {len(slower)} cells: {_median(list(slower.values())):.2f}")
        for name in sorted(slower, key=lambda n: -slower[n])[:10]:  # the worst ten, chosen
            print(f"  {name}: {slower[name]:.2f}")
    return any(ratio > 1.0 for ratio in slower.values())


def row(name: str, s: Score) -> str:
    """Return a cell's row."""
    return (
        f"{name:<72}{s.records:>4}{s.refused:>4}{s.unconverged:>4}{s.coverage:>7.2f}{_dash(s.ratio):>8}"
        f"{100 * s.error:>8.3g}{s.seconds:>7.1f}{s.slower:>7.1f}{s.heading:>9.2f}{_dash(s.position):>8}  {s.used}"
    )


def _dash(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f}"


def _show_pooled(scores: dict[str, Score]) -> bool:
    missed = False
    for craft in ("", *CELLS):
        some = {n: s for n, s in scores.items() if not craft or n.split()[1] == craft}
        if not some:
            continue
        inside, of = (sum(getattr(s, part) for s in some.values()) for part in ("inside", "of"))
        ratios = np.array([r for s in some.values() for r in s.ratios])
        ratio = float(np.sqrt(np.mean(ratios**2))) if len(ratios) else math.nan
        records, refused, unconverged = (
            sum(getattr(s, part) for s in some.values()) for part in ("records", "refused", "unconverged")
        )
        print(
            f"{craft or 'all craft'}: coverage {inside / of if of else math.nan:.3f}, RMSE/bound {_dash(ratio)}, "
            f"{refused} of {records} refused, {unconverged} not converged, CPU over that without waves: "
            f"median of cells {_median([s.slower for s in some.values()]):.1f}, "
            f"most {max(s.slower for s in some.values()):.1f}"
        )
        good = POOLED[0] <= (inside / of if of else math.nan) <= POOLED[1] and refused == 0
        missed = missed or not good or not (math.isnan(ratio) or RATIO[0] <= ratio <= RATIO[1])
    low = [n for n, s in scores.items() if s.coverage < LEAST or s.slower > SLOWER]
    print(f"cells with coverage below {LEAST} or CPU above {SLOWER} times: {len(low)}")
    for name in sorted(scores, key=lambda n: scores[n].coverage)[:10]:  # the worst ten, chosen
        print(f"  {name}: coverage {scores[name].coverage:.2f}")
    return missed or bool(low)


def run_cells(cells: Sequence[Cell], seeds: int | None, results: ResultFile) -> None:
    """Fit the records of these cells that are not there yet."""
    for cell in cells:
        count = seeds or SEEDS.get(cell.craft, OTHERS)
        missing = [draw for draw in range(count) if draw not in results.draws(cell.name)]
        if not missing:
            continue
        fits = [fit_record(cell, draw) for draw in missing]
        described = {"number": cell.number, "craft": cell.craft, **asdict(cell.conditions)}
        results.add(cell.name, described, [o for o, _ in fits], fits[0][1])
        print(row(cell.name, score(results.outcomes(cell.name), CRAFT[cell.craft]().truth)), flush=True)
        for text in dict.fromkeys(o.refusal for o, _ in fits if o.refusal):
            print(f"      refused: {text}", flush=True)


def sample() -> list[Cell]:
    """Return four small cells of Nomoto: calm, waves on the sensors, as a force, and with gusts."""
    base = Conditions("zigzag", Sea(), 0.0, 1.0, CHANNELS["nomoto"][1])
    seas = (Sea(), Sea(math.radians(0.5)), Sea(math.radians(0.5), is_force=True))
    kinds = [*(replace(base, sea=sea) for sea in seas), replace(base, sea=seas[1], gusts=MODERATE)]
    return [Cell(900 + i, "nomoto", kind) for i, kind in enumerate(kinds)]


def run() -> list[Line]:
    """A short sample: four cells of Nomoto, three records each."""
    lines = []
    for cell in sample():
        s = score([fit_record(cell, draw)[0] for draw in range(3)], CRAFT[cell.craft]().truth)
        if s.of:  # of a calm record every interval may be too narrow to be counted
            lines.append(at_least(f"{cell.name[4:]}: coverage", s.coverage, "", LEAST))
        lines.append(Line(f"{cell.name[4:]}: RMSE/bound", s.ratio, ""))
        lines.append(Line(f"{cell.name[4:]}: refused", s.refused, "", "0", s.refused == 0))
    return lines


def chosen_cells(given: argparse.Namespace) -> list[Cell]:
    """Return the cells that the command line asks for."""
    cells = [c for c in grid() if given.craft is None or c.craft in given.craft]
    cells = [c for c in cells if given.cell is None or c.number in given.cell]
    first, parts = (int(x) for x in given.part.split("/"))
    cells = cells[first - 1 :: parts]
    return cells[: given.cells] if given.cells else cells


def main(arguments: list[str]) -> int:
    """Run cells and print their tables; 1 if a limit is missed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])  # type: ignore[union-attr]
    parser.add_argument("--craft", nargs="*", choices=tuple(CELLS), help="default: all")
    parser.add_argument("--cells", type=int, help="no more than so many")
    parser.add_argument("--cell", nargs="*", type=int, help="numbers of cells; default: all")
    parser.add_argument("--part", default="1/1", help="i/n: every n-th cell from the i-th on")
    parser.add_argument(
        "--seeds", type=int, help=f"records of a cell; default: {SEEDS['nomoto']} of Nomoto, else {OTHERS}"
    )
    parser.add_argument("--out", type=Path, metavar="FILE.json")
    parser.add_argument("--show", nargs="*", type=Path, metavar="FILE.json", help="tables of these files only")
    parser.add_argument("--against", type=Path, metavar="FILE.json", help="results of another version, for CPU")
    parser.add_argument("--list", action="store_true", help="names of the cells only")
    given = parser.parse_args(arguments)
    cells = chosen_cells(given)
    if given.list:
        print("\n".join(cell.name for cell in cells))
        return 0
    results = ResultFile(given.out)
    for path in given.show or ():
        results.cells |= ResultFile(path).cells
    print(f"{machine()}; commit {commit()}, seed {SEED}")
    if not given.show:
        run_cells(cells, given.seeds, results)
    print("data: " + " ".join(f"{key[:3]}:{kept['data']}" for key, kept in results.cells.items()))
    return int(show(results, cells, ResultFile(given.against)))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
