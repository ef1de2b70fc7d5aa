"""Tables of the paper's point and of its context: energy, regulators, the joint search, the search by records."""

from seatrial.core.results import Bars, Table
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.energy import EFFICIENCY, WATTS_PER_KILOWATT, EnergyComparison
from seatrial_studies.yu2014.evidence import FinGainEvidence
from seatrial_studies.yu2014.published import GAIN_NAMES, INERTIA, TABLE_1
from seatrial_studies.yu2014.published_loop import PREAMPLIFIER_LABELS


def energy_tables(evidence: FinGainEvidence) -> tuple[Table, ...]:
    """Return fin rates and work, then what propulsion loses and how the fins wear."""
    return _work(evidence), _losses(evidence)


def _work(evidence: FinGainEvidence) -> Table:
    rows = [
        (
            e.row,
            e.printed_rate_ratio,
            e.fitted_rate_ratio,
            *(part.work for part in e.printed),
            EnergyComparison.saved(e.printed),
            *(part.work for part in e.fitted),
            EnergyComparison.saved(e.fitted),
        )
        for e in evidence.energy
    ]
    return Table(
        "Energy: fin rate of the GA over the PID's, and W of eq. (3)",
        (
            "kn / °",
            "rate GA/PID: paper",
            "ours",
            "W PID, J: paper",
            "W GA",
            "saved %",
            "W PID, J: ours",
            "W GA",
            "saved %",
        ),
        tuple(rows),
        f"W = I var(fin rate) / η with I = {INERTIA} kg m² and η = {EFFICIENCY:g} assumed: the mean kinetic "
        "energy of both fins' turning, over η, no energy of a voyage. Paper: from its fin rates, taken as rms. Ours: "
        "the loop, sea and "
        "baseline fitted to table 1, the better reading",
    )


def _losses(evidence: FinGainEvidence) -> Table:
    kW = WATTS_PER_KILOWATT
    rows = [
        (
            e.row,
            *(part.fin_power / kW for part in e.fitted),
            *(part.roll_power / kW for part in e.fitted),
            *(part.reversals for part in e.fitted),
        )
        for e in evidence.energy
    ]
    return Table(
        "Estimates: what propulsion loses, and how often the fins turn back",
        ("kn / °", "fin drag, kW: PID", "GA", "roll, kW at most: PID", "GA", "reversals an hour: PID", "GA"),
        tuple(rows),
        "Ours, fitted. Drag of both fins by C_D = 0.0065 + C_L² / (0.9 π a_e) (Whicker & Fehlner 1958, as later "
        "texts quote it). Roll: the "
        "power that "
        "its damping dissipates (Himeno 1981), which waves feed, so that the engine loses this at most. Reversals: "
        "two for "
        "each zero up-crossing of the fin rate (Rice 1945); bearings and seals wear with them",
    )


def regulator_table(evidence: FinGainEvidence, preamplifier: Preamplifier) -> Table:
    """Return Gh and Gl as functions, with what they do."""
    rows = [(s.speed, s.height, s.Gl, s.Gh, *s.reductions, *s.fins, *s.Ms) for s in evidence.regulators[preamplifier]]
    return Table(
        f"Gh and Gl as functions, beam sea, preamplifier {PREAMPLIFIER_LABELS[preamplifier]}",
        (
            "kn",
            "h1/3 m",
            "Gl",
            "Gh",
            "reduction %: with",
            "without",
            "fin ° rms: with",
            "without",
            "Ms: with",
            "without",
        ),
        tuple(rows),
        "The paper sets both to 1. Gl = (18 / U)² keeps the loop gain where lift grows with U². Gh: the factor on "
        "all gains, "
        "at most 1, at which the fin variance meets the paper's target of 150.31 deg²",
    )


def joint_table(evidence: FinGainEvidence) -> Table:
    """Return one set of gains for all six conditions beside the paper's."""
    rows = []
    for joint in evidence.joint_optima.values():
        label = PREAMPLIFIER_LABELS[joint.preamplifier]
        rows += [
            (label, row.name, float(roll), float(fin), float(rate), float(Ms))
            for row, (roll, fin, rate), Ms in zip(TABLE_1, joint.ratios, joint.Ms, strict=True)
        ]
    gains = "; ".join(
        f"{PREAMPLIFIER_LABELS[j.preamplifier]}: "
        + ", ".join(f"{n} {v:.2f}" for n, v in zip(GAIN_NAMES, j.gains, strict=True))
        + "; the published algorithm on the six at once, by seed: worst ratio "
        + ", ".join(f"{v:.3g}" for v in j.genetic_worst_ratios)
        + " at Ms "
        + ", ".join(f"{v:.3g}" for v in j.genetic_Ms)
        for j in evidence.joint_optima.values()
    )
    return Table(
        "One set of gains for all six conditions: variances over the paper's",
        ("preamplifier", "kn / °", "roll", "fin angle", "fin rate", "Ms"),
        tuple(rows),
        f"Long-crested, in the paper's box, Ms at most 2 or the paper's own. {gains}",
    )


def time_domain_table(evidence: FinGainEvidence) -> Table:
    """Return the search by records of 1000 s beside that by the spectrum; a sentence where it was left out."""
    title = "The search by records of 1000 s at 0.1 s, made once"
    header = ("objectives by", *GAIN_NAMES, "reduction %", "fin rate °/s", "Ms", "CPU s")
    made = evidence.time_domain
    if made is None:
        return Table(title, header, (), "Left out of the quick version; it takes some 10 s of CPU time.")
    rows = [
        (label, *(float(g) for g in gains), response.reduction, response.rate, response.Ms, cpu_s)
        for label, gains, response, cpu_s in zip(
            ("records of one sea", "its spectrum"), made.gains, made.responses, made.cpu_s, strict=True
        )
    ]
    return Table(
        title,
        header,
        tuple(rows),
        f"{PREAMPLIFIER_LABELS[made.preamplifier]}, the same random numbers; {made.evaluations:,} records of one "
        "realised sea "
        "by a compiled loop, exact hold. Reduction, rate and Ms of both by the spectrum. Two searches of one seed "
        "part with "
        "the first individual whose order the sampling error of a record changes; the scatter over seeds is as large",
    )


def fin_rate_ratios(evidence: FinGainEvidence) -> Bars:
    """Return the ratio of fin rates as bars, paper and ours."""
    return Bars(
        "Fin rate of the GA over the PID's",
        tuple(e.row for e in evidence.energy),
        {
            "paper": tuple(e.printed_rate_ratio for e in evidence.energy),
            "ours, fitted": tuple(e.fitted_rate_ratio for e in evidence.energy),
        },
        "rms fin rate, GA / PID",
        "Below 1 the GA's fins are slower. W goes with its square.",
    )
