"""Tables and figures: coefficients at five headings, curves, convergence, histories."""

import numpy as np

from seatrial.core.results import Curve, Figure, Table
from seatrial.physics.models.heave_pitch import COEFFICIENTS
from seatrial.physics.simulate.population import trajectories
from seatrial_studies.meng2014.assumed import assumed
from seatrial_studies.meng2014.repetition import HEADINGS, Algorithm, Setting
from seatrial_studies.meng2014.verdicts import Evidence
from seatrial_studies.swarm_search import STEP, heave_pitch_candidates

SHOWN = 135


def tables(seen: Evidence) -> tuple[Table, ...]:
    """One a heading, their means, times, and what is assumed."""
    return (*(_coefficients(seen, h) for h in HEADINGS), _means(seen), _times(seen), assumed(seen.made))


def _coefficients(seen: Evidence, heading: int) -> Table:
    found = seen.made.searches[Setting.OFF_CENTRE, heading, Algorithm.ICPSO]
    narrow = seen.made.searches[Setting.CENTRED, heading, Algorithm.ICPSO]
    own = seen.own[heading]
    columns = [
        np.abs(found.truth), np.abs(found.points.mean(axis=0)), 100.0 * found.mean_error, 100.0 * narrow.mean_error,
        100.0 * np.abs(own.noisy).mean(axis=0), 100.0 * own.bound.mean(axis=0),
    ]  # fmt: skip
    rows = tuple((name, *(float(c[k]) for c in columns)) for k, name in enumerate(COEFFICIENTS))
    header = ("", "truth", "ICPSO, mean", "ICPSO error %", "in \u00b110 % box, %", "ours, %", "bound, %")
    note = "Mean over runs of the errors of single runs; box \u00b150 % off centre unless stated. b53 is negative."
    if heading < 90:
        note += " Coefficients assumed: those of 90\u00b0."
    return Table(f"Coefficients at {heading}\u00b0", header, rows, note)


def _means(seen: Evidence) -> Table:
    rows = tuple(
        (f"{h}\u00b0", *(seen.error(s, a, h) for s in Setting for a in Algorithm), seen.own_error(h)) for h in HEADINGS
    )
    header = ("Heading", *(f"{a}, {box}" for box in ("\u00b150 %", "\u00b110 %") for a in Algorithm), "ours")
    note = (
        f"Over coefficients and runs, after {seen.made.iterations} iterations of 60; box \u00b150 % off centre or "
        "\u00b110 % about the truth, which keeps what noise moves from going further."
    )
    return Table("Mean errors, %", header, rows, note)


def _times(seen: Evidence) -> Table:
    rows = tuple(
        (
            f"{h}\u00b0",
            *(seen.made.searches[Setting.OFF_CENTRE, h, a].seconds for a in Algorithm),
            seen.own[h].seconds,
        )
        for h in HEADINGS
    )
    return Table("Time of a run, s", ("Heading", *(str(a) for a in Algorithm), "ours"), rows, "Times vary by machine.")


def figures(seen: Evidence) -> tuple[Figure, ...]:
    """Figures 2 and 3, convergence, and histories."""
    return (*_curves(seen), _convergence(seen), _history(seen))


def _curves(seen: Evidence) -> list[Figure]:
    data = seen.made.seas[SHOWN][0]
    found = seen.made.searches[Setting.OFF_CENTRE, SHOWN, Algorithm.ICPSO]
    A, B = heave_pitch_candidates(found.points[:1])
    y = trajectories(A, B, data.forcing, np.zeros(4))[0]
    samples = np.arange(len(y), dtype=np.float64)
    made = []
    note = (
        f"{SHOWN}\u00b0, first run of ICPSO, every {STEP} s. That the curves coincide says little of the coefficients."
    )
    for j, factor, title, unit in ((0, 100.0, "Figure 2: heave", "cm"), (1, 57.29578, "Figure 3: pitch", "deg")):
        measured = Curve("measured", samples, -factor * data.measured[:, j])
        identified = Curve("identified", samples, -factor * y[:, j])
        made.append(Figure(title, "sample", unit, (measured, identified), note))
    return made


def _convergence(seen: Evidence) -> Figure:
    curves = []
    for a in Algorithm:
        history = seen.made.searches[Setting.OFF_CENTRE, SHOWN, a].history
        curves.append(Curve(str(a), np.arange(len(history), dtype=np.float64), np.log10(history)))
    return Figure(
        "Convergence", "iteration", "log10 of the fitness (m and deg)", tuple(curves), f"{SHOWN}\u00b0, first run."
    )


def _history(seen: Evidence) -> Figure:
    found = seen.made.searches[Setting.OFF_CENTRE, SHOWN, Algorithm.ICPSO]
    iterations = np.arange(len(found.trace), dtype=np.float64)
    errors = 100.0 * (found.trace / found.truth - 1.0)
    names = ("a33", "a55", "b33", "b55", "b53")
    curves = tuple(Curve(n, iterations, errors[:, COEFFICIENTS.index(n)]) for n in names)
    return Figure("Histories of coefficients", "iteration", "error, %", curves, f"ICPSO, {SHOWN}\u00b0, first run.")
