"""Tables of the study: table 1, fitted quantities, the search over seeds, what beats it, misprints, choices."""

from collections.abc import Sequence

from seatrial.core.results import Table
from seatrial.physics.loops.fin import Preamplifier
from seatrial.physics.loops.structures import FREQUENCIES_AND_DAMPINGS
from seatrial_studies.yu2014.better import Compared
from seatrial_studies.yu2014.evidence import Evidence
from seatrial_studies.yu2014.misprints import misprints
from seatrial_studies.yu2014.published import FOUND, GAINS, OPEN, TABLE_1, Column
from seatrial_studies.yu2014.readings import WORDS
from seatrial_studies.yu2014.searches import BITS, Searches

Cells = tuple[float, float, float]
_HEADER = (
    "kn / °", "roll °: paper", "printed", "washout", "rate °/s: paper", "printed", "washout", "reduction %: paper",
    "printed", "washout",
)  # fmt: skip
_FIVE = (*GAINS, "KB", "KL")


def tables(seen: Evidence) -> tuple[Table, ...]:
    """In the order of the page."""
    return (
        _table_1(seen), _fitted_table_1(seen), _fitted_baseline(seen), _quantities(seen), _implied(), _scatter(seen),
        *(_answers(seen, reading) for reading in Preamplifier), _times(seen), _three(seen), _five(seen),
        misprints(seen.audited), Table("Left open by the paper", ("what", "print", "here"), OPEN),
    )  # fmt: skip


def _table_1(seen: Evidence) -> Table:
    made = [[(m.roll, m.rate, m.reduction) for m in seen.table_1[reading]] for reading in Preamplifier]
    K_q = ", ".join(f"{WORDS[r]} {seen.calibrated[r]:.4g}" for r in Preamplifier)
    return Table(
        "Table 1, the GA's gains, beside ours with K_q fitted to one number of it",
        _HEADER,
        _beside([_cells(row.genetic) for row in TABLE_1], made),
        f"K_q fitted so that 18 / 90 reduces by 75.92 %: {K_q}. Long-crested ITTC sea of 3.3 m; our roll without fins "
        f"there is {seen.table_1[Preamplifier.WASHOUT][1].free:.2f}° where the paper's numbers imply 1.6°: absolute "
        "levels do not match. K_alpha grows with the square of the speed; as the paper has it, constant, 22 / 90 "
        "would be 18 / 90 again",
    )


def _cells(column: Column) -> Cells:
    return column.roll, column.rate, column.reduction


def _beside(paper: Sequence[Cells], ours: Sequence[Sequence[Cells]]) -> tuple[tuple[str | float, ...], ...]:
    """Rows of table 1: for each quantity the paper's number and that of each reading."""
    return tuple(
        (row.name, *(cell for quantity in zip(paper[i], *(made[i] for made in ours), strict=True) for cell in quantity))
        for i, row in enumerate(TABLE_1)
    )


def _fitted_table_1(seen: Evidence) -> Table:
    fits = [seen.fit(reading) for reading in Preamplifier]
    made = [[_cells(f.column(f.genetic, i)) for i in range(len(TABLE_1))] for f in fits]
    errors = ", ".join(f"{WORDS[f.reading]} {f.error:.3f}" for f in fits)
    return Table(
        "Table 1, the GA's gains, fitted",
        _HEADER,
        _beside([_cells(row.genetic) for row in TABLE_1], made),
        f"Fitted, not reproduced: K_q and one factor on all rolls and fin rates. Short-crested, cos². rms log error of "
        f"roll, fin rate and what is left of the roll: {errors}",
    )


def _fitted_baseline(seen: Evidence) -> Table:
    fits = [seen.fit(reading) for reading in Preamplifier]
    made = [[_cells(f.column(f.traditional, i)) for i in range(len(TABLE_1))] for f in fits]
    said = "; ".join(
        f"{WORDS[f.reading]}: " + ", ".join(f"{n} {v:.2f}" for n, v in zip(GAINS, f.baseline, strict=True))
        + f" ({f.at_bounds} at a bound), rms log error {f.baseline_error:.3f}"
        for f in fits
    )  # fmt: skip
    return Table(
        "Table 1, the traditional PID, fitted",
        _HEADER,
        _beside([_cells(row.traditional) for row in TABLE_1], made),
        f"The paper prints no gains of its baseline. These are fitted to its column, not reproduced: {said}",
    )


def _quantities(seen: Evidence) -> Table:
    rows = [
        (WORDS[f.reading], "following" if f.following_is_zero else "head", f.K_q, f.level, f.error, f.baseline_error)
        for f in seen.fitted
    ]
    return Table(
        "Fitted quantities",
        ("preamplifier", "0° is", "K_q", "factor on roll and fin rate", "rms log error, GA", "rms log error, PID"),
        tuple(rows),
        "Both fits of a row share K_q and the factor. The table cannot decide between the readings",
    )


def _implied() -> Table:
    rows = [
        (row.name, row.traditional.uncontrolled, row.genetic.uncontrolled,
         "yes" if _apart(row.traditional, row.genetic) else "no")
        for row in TABLE_1
    ]  # fmt: skip
    return Table(
        "The roll without fins that table 1 implies",
        ("kn / °", "by the traditional PID °", "by the GA °", "apart by more than rounding"),
        tuple(rows),
        "roll / (1 - reduction); both columns have the same sea. At 90° the waves are met alike at 18 and 22 kn",
    )


def _apart(one: Column, other: Column) -> bool:
    (low, high), (other_low, other_high) = one.uncontrolled_between, other.uncontrolled_between
    return high < other_low or other_high < low


def _scatter(seen: Evidence) -> Table:
    rows = [
        (WORDS[s.setting.reading], s.setting.fins.value, s.setting.normaliser.value,
         *(f"{low:.3g} to {high:.3g}" for low, high in zip(s.gains.min(axis=0), s.gains.max(axis=0), strict=True)),
         f"{s.peak.min():.2f} to {s.peak.max():.3g}", str(s.fragile),
         f"{s.reduction.min():.1f} to {s.reduction.max():.1f}", str(s.beaten.sum()))
        for s in seen.searched
    ]  # fmt: skip
    count = len(seen.searched[0].peak)
    return Table(
        "The published search over seeds",
        ("preamplifier", "fins", "normaliser", *GAINS, "Ms", "Ms above 2", "reduction %", "beaten in all objectives"),
        tuple(rows),
        f"{count} seeds each, population 50, 200 generations, codes of {BITS} bits, 18 kn, 90°, 3.3 m. The answer is "
        "the fittest of the last generation under equal weights; beaten: another seed evaluated a point with all three "
        f"objectives smaller. Paper: {', '.join(f'{v:.5g}' for v in FOUND)}. With the best of the first generation as "
        "normaliser J2 outweighs all: as a washout every seed ends at the edge of instability, where the fins move "
        "just as much as the target says",
    )


def _answers(seen: Evidence, reading: Preamplifier) -> Table:
    found: Searches = seen.of(reading)
    rows = [
        (str(k + 1), *(float(v) for v in gains), float(peak), *(float(v) for v in shares), float(reduction))
        for k, (gains, peak, shares, reduction) in enumerate(
            zip(found.gains, found.peak, found.shares, found.reduction, strict=True)
        )
    ]
    return Table(
        f"Answers of the published search, preamplifier {WORDS[reading]}",
        ("seed", *GAINS, "Ms", "J1 / paper's", "J2 / paper's", "J3 / paper's", "reduction %"),
        tuple(rows),
        "J2 as printed, normalised by the largest of the first generation",
    )


def _times(seen: Evidence) -> Table:
    compiled, single = seen.in_time
    rows = (
        ("variances in the frequency domain", seen.seconds, 1.0),
        ("records of 1000 s, compiled, 50 at once in vector lanes", compiled, compiled / seen.seconds),
        ("records of 1000 s, scipy's lsim one after another", single, single / seen.seconds),
    )
    return Table(
        "Time of one published search of 10,000 evaluations",
        ("objectives by", "s", "times the first"),
        rows,
        "The first is a whole search with its front, median of all; the others are the records alone, extrapolated "
        "from one population and one record, exact zero-order hold. Times vary by machine",
    )


def _three(seen: Evidence) -> Table:
    rows = [
        (WORDS[reading], f"{b.cap:.3g}", *(round(float(v), 3) for v in b.gains), b.peak, *(float(v) for v in b.shares))
        for reading in Preamplifier
        for b in seen.three[reading]
    ]
    return Table(
        "Three gains against the paper's, in its own box",
        ("preamplifier", "Ms at most", *GAINS, "Ms", "J1 / paper's", "J2 / paper's", "J3 / paper's"),
        tuple(rows),
        "The worst of the three objectives over the paper's, made small; the second Ms of each reading is that of the "
        "paper's gains. Where it stays at 1 the paper's gains lie on the front",
    )


def _five(seen: Evidence) -> Table:
    made = seen.richer
    rows = [
        *(_compared(c, "searched in") for c in made.designed),
        *(_compared(c, "held out") for c in made.held_out),
        *(_compared(c, "three gains, same box") for c in made.three),
    ]
    (band, _), (low, _) = FREQUENCIES_AND_DAMPINGS
    gains = ", ".join(f"{n} {v:.2f}" for n, v in zip(_FIVE, made.gains, strict=True))
    return Table(
        "Five gains, washout: variances over those of the paper's gains",
        ("sea, 18 kn, 90° unless said", "", "roll", "fin angle", "fin rate", "paper's reduction %", "ours %"),
        tuple(rows),
        f"{gains}; Ms {made.peak:.2f}. KB: band-pass at {band:g} rad/s; KL: low-pass at {low:g} rad/s; KP, KI, KD in "
        "the paper's box. Tuned for beam seas: in long waves that overtake slowly another set has to be scheduled",
    )


def _compared(c: Compared, kind: str) -> tuple[str | float, ...]:
    name = c.sea.name or "ITTC 3.3 m, long-crested"
    return name, kind, c.roll, c.fin, c.rate, c.paper_reduction, c.reduction
