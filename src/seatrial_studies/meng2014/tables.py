"""Tables and figures: coefficients at five headings, curves, convergence, histories."""

import numpy as np

from seatrial.core.results import Curve, Figure, Table
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.simulate import trajectories
from seatrial_studies.meng2014.assumptions import assumption_table
from seatrial_studies.meng2014.reproduction import HEADINGS, BoxPlacement, SwarmAlgorithm
from seatrial_studies.meng2014.verdicts import CloudSwarmEvidence
from seatrial_studies.swarm_search import STEP, candidate_matrices

# deg, heading of the figures
FIGURE_HEADING = 135


def tables(evidence: CloudSwarmEvidence) -> tuple[Table, ...]:
    """One a heading, their means, times, and what is assumed."""
    return (
        *(_coefficients(evidence, h) for h in HEADINGS),
        _means(evidence),
        _times(evidence),
        assumption_table(evidence.reproduction),
    )


def _coefficients(evidence: CloudSwarmEvidence, heading: int) -> Table:
    found = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, heading, SwarmAlgorithm.ICPSO]
    narrow = evidence.reproduction.searches[BoxPlacement.CENTRED, heading, SwarmAlgorithm.ICPSO]
    own = evidence.output_error[heading]
    columns = [
        np.abs(found.truth), np.abs(found.points.mean(axis=0)), 100.0 * found.mean_error, 100.0 * narrow.mean_error,
        100.0 * np.abs(own.noisy_errors).mean(axis=0), 100.0 * own.cramer_rao_bound.mean(axis=0),
    ]  # fmt: skip
    rows = tuple((name, *(float(c[k]) for c in columns)) for k, name in enumerate(COEFFICIENTS))
    header = ("", "truth", "ICPSO, mean", "ICPSO error %", "in \u00b110 % box, %", "ours, %", "bound, %")
    note = "Mean over runs of the errors of single runs; box \u00b150 % off centre unless stated. b53 is negative."
    if heading < 90:
        note += " Coefficients assumed: those of 90\u00b0."
    return Table(f"Coefficients at {heading}\u00b0", header, rows, note)


def _means(evidence: CloudSwarmEvidence) -> Table:
    rows = tuple(
        (
            f"{h}\u00b0",
            *(evidence.mean_error(s, a, h) for s in BoxPlacement for a in SwarmAlgorithm),
            evidence.output_error_percent(h),
        )
        for h in HEADINGS
    )
    header = ("Heading", *(f"{a}, {box}" for box in ("\u00b150 %", "\u00b110 %") for a in SwarmAlgorithm), "ours")
    note = (
        f"Over coefficients and runs, after {evidence.reproduction.iterations} iterations of 60; box "
        "\u00b150 % off centre or "
        "\u00b110 % about the truth, which keeps what noise moves from going further."
    )
    return Table("Mean errors, %", header, rows, note)


def _times(evidence: CloudSwarmEvidence) -> Table:
    rows = tuple(
        (
            f"{h}\u00b0",
            *(evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, h, a].seconds for a in SwarmAlgorithm),
            evidence.output_error[h].seconds,
        )
        for h in HEADINGS
    )
    return Table(
        "Time of a run, s", ("Heading", *(str(a) for a in SwarmAlgorithm), "ours"), rows, "Times vary by machine."
    )


def figures(evidence: CloudSwarmEvidence) -> tuple[Figure, ...]:
    """Figures 2 and 3, convergence, and histories."""
    return (*_curves(evidence), _convergence(evidence), _history(evidence))


def _curves(evidence: CloudSwarmEvidence) -> list[Figure]:
    data = evidence.reproduction.seas[FIGURE_HEADING][0]
    found = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, FIGURE_HEADING, SwarmAlgorithm.ICPSO]
    A, B = candidate_matrices(found.points[:1])
    y = trajectories(A, B, data.forcing, np.zeros(4))[0]
    samples = np.arange(len(y), dtype=np.float64)
    made = []
    note = (
        f"{FIGURE_HEADING}\u00b0, first run of ICPSO, every {STEP} s. That the curves coincide says "
        "little of the coefficients."
    )
    for j, factor, title, unit in ((0, 100.0, "Figure 2: heave", "cm"), (1, 57.29578, "Figure 3: pitch", "deg")):
        measured = Curve("measured", samples, -factor * data.measured[:, j])
        identified = Curve("identified", samples, -factor * y[:, j])
        made.append(Figure(title, "sample", unit, (measured, identified), note))
    return made


def _convergence(evidence: CloudSwarmEvidence) -> Figure:
    curves = []
    for a in SwarmAlgorithm:
        history = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, FIGURE_HEADING, a].best_fitness
        curves.append(Curve(str(a), np.arange(len(history), dtype=np.float64), np.log10(history)))
    return Figure(
        "Convergence",
        "iteration",
        "log10 of the fitness (m and deg)",
        tuple(curves),
        f"{FIGURE_HEADING}\u00b0, first run.",
    )


def _history(evidence: CloudSwarmEvidence) -> Figure:
    found = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, FIGURE_HEADING, SwarmAlgorithm.ICPSO]
    iterations = np.arange(len(found.trace), dtype=np.float64)
    errors = 100.0 * (found.trace / found.truth - 1.0)
    names = ("a33", "a55", "b33", "b55", "b53")
    curves = tuple(Curve(n, iterations, errors[:, COEFFICIENTS.index(n)]) for n in names)
    return Figure(
        "Histories of coefficients", "iteration", "error, %", curves, f"ICPSO, {FIGURE_HEADING}\u00b0, first run."
    )
