"""The paper's tables with ours beside them."""

import numpy as np

from seatrial.models.heave_pitch import COEFFICIENTS
from seatrial.models.qi2025 import HEADINGS
from seatrial.results import Table
from seatrial.studies.own_fit import Ours
from seatrial.studies.qi2025.published import (
    SECONDS,
    Algorithm,
    estimate,
    misprinted,
    printed_error,
    recomputed_error,
    true_values,
)
from seatrial.studies.qi2025.repetition import Repetition, Setting
from seatrial.values import Array

PAPER = Setting.PAPER.value
_GUESS = "Means over the coefficients. A guess at random in a box of \u00b110 % about the truth has 5 %."


def tables(made: Repetition, own: dict[int, Ours], bias: dict[int, tuple[Array, Array]]) -> tuple[Table, ...]:
    """All of them."""
    values = (table for h in HEADINGS for table in (_values(made, h), _errors(made, own[h], h)))
    return (*values, *_settings(made), _times(made, own), _misprints(), _hold(bias))


def _values(made: Repetition, heading: int) -> Table:
    header, columns = ["", "theory"], [true_values(heading)]
    for a in Algorithm:
        header += [f"{a} printed", f"{a} here"]
        columns += [
            estimate(heading, a),
            np.abs(made.searches[Setting.PAPER, heading, a].points.mean(axis=0)),
        ]
    rows = tuple((name, *(float(c[k]) for c in columns)) for k, name in enumerate(COEFFICIENTS))
    note = f"Table {2 + HEADINGS.index(heading)} of the paper, SI units. Here: mean of {made.runs} runs, {PAPER}."
    return Table(f"Coefficients at {heading}\u00b0", tuple(header), rows, note)


def _errors(made: Repetition, own: Ours, heading: int) -> Table:
    header, columns = [""], []
    for a in Algorithm:
        found = made.searches[Setting.PAPER, heading, a]
        header += [f"{a} printed", "of mean", "single"]
        columns += [printed_error(heading, a), 100.0 * found.error_of_mean, 100.0 * found.mean_error]
    header += ["ours", "ours, noise"]
    columns += [100.0 * np.abs(own.exact).mean(axis=0), 100.0 * np.abs(own.noisy).mean(axis=0)]
    rows = tuple((name, *(float(c[k]) for c in columns)) for k, name in enumerate(COEFFICIENTS))
    mean = ("mean", *(float(np.mean(c)) for c in columns))
    note = (
        "Printed errors are those of the mean of ten runs, as 'of mean' here; 'single': mean error of single runs. "
        "Ours: single fits, without noise and with 1 cm / .02\u00b0."
    )
    return Table(f"Errors at {heading}\u00b0, %", tuple(header), (*rows, mean), note)


def _settings(made: Repetition) -> list[Table]:
    """One table a setting: what box, fitness and unit decide."""
    tables_ = []
    for setting in dict.fromkeys(s for s, _, _ in made.searches):
        rows = []
        for heading in HEADINGS:
            found = [made.searches[setting, heading, a] for a in Algorithm]
            cells = [100.0 * float(np.mean(v)) for f in found for v in (f.error_of_mean, f.mean_error)]
            rows.append((f"{heading}\u00b0", *cells))
        header = ("Heading", *(f"{a}, {what}" for a in Algorithm for what in ("of mean", "single")))
        tables_.append(Table(f"Errors in %: {setting.value}", header, tuple(rows), _GUESS if not tables_ else ""))
    return tables_


def _times(made: Repetition, own: dict[int, Ours]) -> Table:
    rows = []
    for h in HEADINGS:
        here = [made.searches[Setting.PAPER, h, a].seconds for a in Algorithm]
        rows.append((f"{h}\u00b0", *SECONDS[h].values(), *here, own[h].seconds))
    header = ("Heading", *(f"{a} printed, s" for a in Algorithm), *(f"{a} here, s" for a in Algorithm), "ours, s")
    note = (
        "Table 5: 200 iterations of 40. Here all three judge their candidates by one simulator; times vary by machine."
    )
    return Table("Time of a run", header, tuple(rows), note)


def _misprints() -> Table:
    rows = tuple((f"{h}\u00b0", str(a), name, said, is_so) for h, a, name, said, is_so in misprinted())
    return Table("Printed errors that do not follow from the printed values",
                 ("Heading", "Algorithm", "Coefficient", "printed %", "recomputed %"), rows)  # fmt: skip


def _hold(bias: dict[int, tuple[Array, Array]]) -> Table:
    rows = tuple(
        (f"{h}\u00b0", 100.0 * float(np.mean(np.abs(held))), 100.0 * float(np.max(np.abs(held))),
         100.0 * float(np.max(np.abs(exact)))) for h, (held, exact) in bias.items()
    )  # fmt: skip
    header = ("Heading", "held: mean error %", "held: largest %", "continuous: largest %")
    note = "Data from continuous waves without noise, motions every .5 s; wave force held as in eq. (8), or continuous."
    return Table("What holding the wave force costs", header, rows, note)


def mean_recomputed(heading: int, algorithm: Algorithm) -> float:
    """Mean absolute error of the printed estimates, per cent."""
    return float(np.mean(np.abs(recomputed_error(heading, algorithm))))
