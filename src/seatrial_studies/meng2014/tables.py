"""Tables: coefficients at five headings, what the cloud does, times, declarations, controllers."""

import numpy as np

from seatrial.core.results import Table
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.meng2014.declarations import declaration_tables
from seatrial_studies.meng2014.evidence import CloudSwarmEvidence
from seatrial_studies.meng2014.reproduction import HEADINGS, BoxPlacement, CloudVariant, SwarmAlgorithm
from seatrial_studies.pitch_control import pitch_controller_cost_table
from seatrial_studies.swarm_search import RepeatedSearches


def tables(evidence: CloudSwarmEvidence) -> tuple[Table, ...]:
    """Return all tables in the order of the page."""
    return (
        *(_coefficients(evidence, h) for h in HEADINGS),
        _means(evidence),
        _convergence(evidence),
        _cloud_weight(evidence),
        _times(evidence),
        *declaration_tables(evidence.reproduction),
        pitch_controller_cost_table(evidence.controllers),
    )


def _convergence(evidence: CloudSwarmEvidence) -> Table:
    made = evidence.reproduction
    columns: dict[str, dict[int, RepeatedSearches]] = {
        **{str(a): evidence.off_centre(a) for a in SwarmAlgorithm},
        **{str(v): {h: made.variants[v, h] for h in HEADINGS} for v in CloudVariant},
        "PSO by eq. (4) as printed": made.unweighted_searches,
    }
    rows, runs = [], len(HEADINGS) * len(next(iter(made.seas.values())))
    for name, searches in columns.items():
        needed = evidence.iterations_needed(searches)
        medians = [float(np.median(row)) for row in needed]
        error = 100.0 * float(np.mean([f.mean_error for f in searches.values()]))
        cells = [int(median) if np.isfinite(median) else None for median in medians]
        rows.append((name, *cells, int(np.sum(~np.isfinite(needed))), error))
    header = ("", *(f"{h}\u00b0" for h in HEADINGS), f"runs of {runs} that never do", "mean error %")
    note = (
        "Iterations until the fitness comes within what the noise explains of the less of the two with which ICPSO and "
        "PSO end in the same sea and box, median over the runs, a dash where it is never; box \u00b150 % off centre."
    )
    return Table("How fast the swarms converge", header, tuple(rows), note)


def _cloud_weight(evidence: CloudSwarmEvidence) -> Table:
    weight = evidence.cloud_weight
    rows = (
        ("weight at r = A, En' = En", weight.at_ends[0]),
        ("weight at r = B, En' = En", weight.at_ends[1]),
        ("2.5 % of draws in the band are below", weight.central[0]),
        ("2.5 % of draws in the band are above", weight.central[1]),
        ("mean of the draws", weight.mean),
        ("standard deviation of the draws", weight.deviation),
        ("share of particles below A, weight w1 = 0.9", weight.band_shares[0]),
        ("share of particles in the band", weight.band_shares[1]),
        ("share of particles above B, weight w2 = 0.4", weight.band_shares[2]),
    )
    note = "Draws: r uniform between A and B, En' normal with En and He. Shares: first runs at all headings."
    return Table("What the cloud does to the weight", ("Inertia weight of eq. (6)", "here"), rows, note)


def _coefficients(evidence: CloudSwarmEvidence, heading: int) -> Table:
    found = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, heading, SwarmAlgorithm.ICPSO]
    narrow = evidence.reproduction.searches[BoxPlacement.CENTRED, heading, SwarmAlgorithm.ICPSO]
    own = evidence.output_error[heading]
    columns = [
        np.abs(found.truth), np.abs(found.points.mean(axis=0)), 100.0 * found.mean_error, 100.0 * narrow.mean_error,
        100.0 * np.abs(own.noisy_errors).mean(axis=0), 100.0 * own.cramer_rao_bound.mean(axis=0),
    ]  # fmt: skip
    rows = tuple((name, *(float(c[k]) for c in columns)) for k, name in enumerate(COEFFICIENTS))
    header = (
        "",
        "truth",
        "ICPSO, mean",
        "ICPSO error %",
        "in \u00b110 % box, %",
        "ours, %",
        "Cramér-Rao standard deviation, %",
    )
    note = (
        "Mean over runs of the errors of single runs; box \u00b150 % off centre unless stated. b53 is negative; its "
        "magnitude is shown, as Qi et al. 2025 print it."
    )
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
        "\u00b110 % about the truth, whose walls limit the errors that noise causes. Where the swarms agree, both end "
        "in the same minimum, which the noise decides."
    )
    return Table("Mean errors, %", header, rows, note)


def _times(evidence: CloudSwarmEvidence) -> Table:
    rows = []
    for h in HEADINGS:
        swarms = [evidence.off_centre(a)[h] for a in SwarmAlgorithm]
        fit = evidence.output_error[h]
        judged = (*(int(f.evaluations[0]) for f in swarms), fit.evaluations)
        rows.append((f"{h}\u00b0", *(f.seconds for f in swarms), fit.seconds, *judged))
    columns = (*map(str, SwarmAlgorithm), "ours")
    header = ("Heading", *(f"{name}, s" for name in columns), *(f"{name}, judged" for name in columns))
    note = (
        "Times vary by machine and decide nothing. Judged: candidates, each by the whole record; ours: evaluations "
        "of the whole record with its slopes."
    )
    return Table("Time of a run", header, tuple(rows), note)
