"""What the page declares of the paper, its tables and its figures."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.results import Bars, Curve, Figure, Table
from seatrial.physics.loops import FREQUENCIES_AND_DAMPINGS, Preamplifier
from seatrial_studies.declarations import Assumption, Declarations, Deviation, FigureCounterpart, Symbol
from seatrial_studies.yu2014.audit import misprint_table
from seatrial_studies.yu2014.published import (
    ASPECT,
    CHORD,
    DENSITY,
    GAIN_NAMES,
    INERTIA,
    PREAMPLIFIER_LABELS,
    PUBLISHED_VALUES,
    SPAN,
    TABLE_1,
    THICKNESS,
    ControllerResult,
    FinObjective,
)
from seatrial_studies.yu2014.reproduction import (
    BLOCK_COEFFICIENT,
    EFFICIENCY,
    GYRADIUS_SHARE,
    WATTS_PER_KILOWATT,
    EnergyComparison,
)
from seatrial_studies.yu2014.searches import BITS, BOX, TIMES_TITLE, FinGainSearches, FiveGainComparison
from seatrial_studies.yu2014.verdicts import FinGainEvidence

# What the page declares of the paper: its symbols, what is assumed, what deviates from the print, its figures.

_SYMBOLS = (
    Symbol("Gr(s)", "rate gyro", "deg s/deg", "400 s / (s² + 80 s + 4000)"),
    Symbol("Gq(s), Kq", "preamplifier and its gain", "1", "Kq / ((30 s + 1)(0.056 s + 1)); Kq adjustable"),
    Symbol("G_PID(s); KP, KI, KD", "controller, eq. (1), and its gains", "1", "GA: 11.053, 0.428, 32.736"),
    Symbol("Gh(s), Gl(s)", "regulators for sea state and speed", "1", "1; as functions in a table here"),
    Symbol("Gs(s)", "servo", "1", "550 / (s² + 15 s + 225)"),
    Symbol("Kαw", "wave slope to which a fin angle is equivalent", "1", "0.256 at a largest fin angle of 22°"),
    Symbol("Gφ(s)", "roll by wave slope", "1", "1 / (1.43242 s² + 0.3796 s + 1)"),
    Symbol("φ, αw", "roll angle; equivalent wave slope", "deg", "input and output of the loop"),
    Symbol("Φ, Φα, Φsα", "wave slope to roll, fin angle, fin rate", "1, 1, 1/s", "closed loop; section 2"),
    Symbol("Sφ, Sα, Ssα, Sαw", "spectra of roll, fin angle, fin rate, wave slope", "deg² s, deg²/s", "section 2"),
    Symbol("σφ², σα²", "variances of roll and fin angle", "deg²", "target of the fins 150.31"),
    Symbol("p, αmax", "share of fin amplitudes beyond the largest, Rayleigh", "1, deg", "at most 0.2; 22"),
    Symbol("W', W", "work of one fin, of two over the efficiency, eq. (3)", "J", "I ∫ Ssα dω / η"),
    Symbol("η", "efficiency of the fin drive", "1", "not printed"),
    Symbol("I, m0, mq, R", "inertia about the stock, masses with and without water, lever", "kg m², kg, kg, m",
           "791.1611, 4086.576, 3064.932, 0.44"),
    Symbol("J1, J2, J3, J", "objectives, eqs. (2) to (5), their weighted sum, eq. (7)", "deg², deg⁴, J, 1",
           "minimised"),
    Symbol("λ1, λ2, λ3; r", "random weights, eq. (6); random positive integers", "1", "drawn anew each generation"),
    Symbol("σφmax², σαmax², Wmax", "normalisers of eq. (7), from the first generation", "as above", "see Assumed"),
    Symbol("f, pi, fmin", "fitness 1/J, selection probability, worst fitness", "1", "eq. (8) and below"),
    Symbol("Pc, Pm", "probabilities of crossover and mutation", "1", "0.8, 0.01"),
    Symbol("ω, ωe", "frequency of the waves, and as the ship meets them", "rad/s", "no conversion printed"),
    Symbol("ρ, V", "density and volume of the fin", "kg/m³, m³", f"{DENSITY:g}; span times chord times thickness here"),
    Symbol("b, span, aspect, thickness", "of the fin: chord, span, span over chord, thickness", "m, m, 1, m",
           f"{CHORD:g}, {SPAN:g}, {ASPECT:g}, {THICKNESS:g}"),
    Symbol("γ", "heading to the waves", "deg", "45, 90, 135"),
)  # fmt: skip
_ASSUMPTIONS = (
    Assumption("Kq of the preamplifier", "“adjustable”",
               "fitted: the GA's gains reduce the roll by 75.92 % at 18 / 90"),
    Assumption("wave spectrum", "not printed", "one-parameter ITTC; short-crested cos² where the table is fitted"),
    Assumption("length, breadth, draught", "not printed", "a box of 100 x 10.5 x 3.4 m for the effective wave slope"),
    Assumption("Kαw and speed", "0.256, taken as constant", "grows with the square of the speed from 18 kn"),
    Assumption("sense of the heading", "not printed", "0° following, and both senses where the table is fitted"),
    Assumption("sea of the search", "not printed", "18 kn, 90°, 3.3 m; all six conditions in the joint search"),
    Assumption("gains of the traditional PID", "not printed", "fitted to its column"),
    Assumption("bits of the codes", "not printed", "17, the fewest that hold the printed gains"),
    Assumption("when the weights are drawn", "before choosing the individuals to cross", "once for each generation"),
    Assumption("the random integers r", "positive", "1 to 100"),
    Assumption("the one answer of the last generation", "not said", "the fittest under equal weights"),
    Assumption("roll and fin rate of table 1", "rms or significant not said", "rms"),
    Assumption("η of the fin drive", "not printed", f"{EFFICIENCY:g}; shares saved do not depend on it"),
    Assumption("mass and metacentric height", "not printed",
               f"block coefficient {BLOCK_COEFFICIENT:g}; GM from the roll "
               f"period with a gyradius of {GYRADIUS_SHARE:g} B; for the estimate of roll's loss alone"),
    Assumption("loss of the main engine", "named in the introduction, no formula",
               "fin drag by Whicker & Fehlner 1958; roll by the energy of its damping, an upper bound (Himeno 1981)"),
)  # fmt: skip
_DEVIATIONS = (
    Deviation("section 1, lag of 30 s", "a low-pass", "as printed, and as a washout 30 s / (30 s + 1)",
              "printed, P acts on the roll angle and Ms is 5.45; rate-gyro loops have a washout"),
    Deviation("section 2.2, fin rate", "fin angle times 1/s", "times s", "1/s sums an angle up; its unit is no rate"),
    Deviation("section 2.1, Φ", "open-loop transfer function", "the closed loop", "else no gain would matter"),
    Deviation("section 2.3, W without 1 / 2π", "as J1 has it", "neither has it", "eq. (7) divides it out"),
    Deviation("section 3, selection probability", "sum over 3", "sum over the population",
              "else they do not add up to 1"),
    Deviation("eq. (7), normaliser", "symbol: max; words: the fittest", "max; the fittest beside",
              "the print has both"),
    Deviation("section 3, records of 1000 s at 0.1 s", "each individual simulated",
              "variances from the spectrum; the search by records made once beside it",
              "no sampling error, and a classical Runge-Kutta step of 0.1 s diverges at the gyro's poles"),
)  # fmt: skip
_FIGURES = (
    FigureCounterpart("Figure 1", "block diagram of the loop",
                      reason="not drawn: a schematic; its blocks are in Symbols"),
    FigureCounterpart("Figure 2", "principle of the search: sea, loop, objectives, GA",
                      reason="not drawn: a schematic; what it finds is in The published search over seeds"),
    FigureCounterpart("Figure 3", "roll without fins over time", ("Figure 3: roll without fins",)),
    FigureCounterpart("Figure 4", "roll under the PID", ("Figure 4: roll under the traditional PID (fitted)",)),
    FigureCounterpart("Figure 5", "roll under the GA's gains", ("Figure 5: roll under the GA's gains",)),
    FigureCounterpart("Figure 6", "fin rate, PID", ("Figure 6: fin rate under the traditional PID (fitted)",)),
    FigureCounterpart("Figure 7", "fin rate, GA", ("Figure 7: fin rate under the GA's gains",)),
)  # fmt: skip
DECLARATIONS = Declarations(_SYMBOLS, _ASSUMPTIONS, _DEVIATIONS, _FIGURES)


def declaration_tables() -> tuple[Table, ...]:
    """Return the tables of symbols, assumptions, deviations and figures."""
    return DECLARATIONS.tables("Absolute levels of the motions do not match with any of these; nothing hangs on them.")


# Tables of the paper's point and of its context: energy, regulators, the joint search, the search by records.


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


# Tables of the study: table 1, fitted quantities, the search over seeds, what beats it, misprints, choices.

ResultCells = tuple[float, float, float]
_HEADER = (
    "kn / °", "roll °: paper", "printed", "washout", "rate °/s: paper", "printed", "washout", "reduction %: paper",
    "printed", "washout",
)  # fmt: skip
_FIVE_GAIN_NAMES = (*GAIN_NAMES, "KB", "KL")


def tables(evidence: FinGainEvidence) -> tuple[Table, ...]:
    """Return all tables in the order of the page."""
    return (
        *energy_tables(evidence),
        _table_1(evidence),
        _fitted_table_1(evidence),
        _fitted_baseline(evidence),
        _fitted_quantities(evidence),
        _implied_uncontrolled_roll(),
        _search_scatter(evidence),
        *(_search_results(evidence, reading) for reading in Preamplifier),
        joint_table(evidence),
        time_domain_table(evidence),
        _times(evidence),
        _three_gains(evidence),
        _five_gains(evidence),
        *(regulator_table(evidence, reading) for reading in Preamplifier),
        misprint_table(evidence.audit),
        *declaration_tables(),
    )


def _table_1(evidence: FinGainEvidence) -> Table:
    made = [[(m.roll, m.rate, m.reduction) for m in evidence.table_1_responses[reading]] for reading in Preamplifier]
    K_q = ", ".join(f"{PREAMPLIFIER_LABELS[r]} {evidence.calibrated_K_q[r]:.4g}" for r in Preamplifier)
    return Table(
        "Table 1, the GA's gains, beside ours with K_q fitted to one number of it",
        _HEADER,
        _comparison_rows([_cells(row.genetic) for row in TABLE_1], made),
        f"K_q fitted so that 18 / 90 reduces by 75.92 %: {K_q}. Long-crested ITTC sea of 3.3 m; our roll without fins "
        f"there is {evidence.table_1_responses[Preamplifier.WASHOUT][1].uncontrolled:.2f}° where the "
        "paper's numbers imply 1.6°: absolute "
        "levels do not match. K_alpha grows with the square of the speed; as the paper has it, constant, 22 / 90 "
        "would be 18 / 90 again",
    )


def _cells(column: ControllerResult) -> ResultCells:
    return column.roll, column.rate, column.reduction


def _comparison_rows(
    paper: Sequence[ResultCells], ours: Sequence[Sequence[ResultCells]]
) -> tuple[tuple[str | float, ...], ...]:
    """Rows of table 1: for each quantity the paper's number and that of each reading."""
    return tuple(
        (row.name, *(cell for quantity in zip(paper[i], *(made[i] for made in ours), strict=True) for cell in quantity))
        for i, row in enumerate(TABLE_1)
    )


def _fitted_table_1(evidence: FinGainEvidence) -> Table:
    fits = [evidence.fit(reading) for reading in Preamplifier]
    made = [[_cells(f.row_result(f.genetic, i)) for i in range(len(TABLE_1))] for f in fits]
    errors = ", ".join(f"{PREAMPLIFIER_LABELS[f.preamplifier]} {f.log_error:.3f}" for f in fits)
    return Table(
        "Table 1, the GA's gains, fitted",
        _HEADER,
        _comparison_rows([_cells(row.genetic) for row in TABLE_1], made),
        f"Fitted, not reproduced: K_q and one factor on all rolls and fin rates. Short-crested, cos². rms log error of "
        f"roll, fin rate and what is left of the roll: {errors}",
    )


def _fitted_baseline(evidence: FinGainEvidence) -> Table:
    fits = [evidence.fit(reading) for reading in Preamplifier]
    made = [[_cells(f.row_result(f.traditional, i)) for i in range(len(TABLE_1))] for f in fits]
    said = "; ".join(
        f"{PREAMPLIFIER_LABELS[f.preamplifier]}: "
        + ", ".join(f"{n} {v:.2f}" for n, v in zip(GAIN_NAMES, f.baseline, strict=True))
        + f" ({f.gains_at_bounds} at a bound), rms log error {f.baseline_log_error:.3f}"
        for f in fits
    )
    return Table(
        "Table 1, the traditional PID, fitted",
        _HEADER,
        _comparison_rows([_cells(row.traditional) for row in TABLE_1], made),
        f"The paper prints no gains of its baseline. These are fitted to its column, not reproduced: {said}",
    )


def _fitted_quantities(evidence: FinGainEvidence) -> Table:
    rows = [
        (
            PREAMPLIFIER_LABELS[f.preamplifier],
            "following" if f.following_is_zero else "head",
            f.K_q,
            f.level,
            f.log_error,
            f.baseline_log_error,
        )
        for f in evidence.table_1_fits
    ]
    return Table(
        "Fitted quantities",
        ("preamplifier", "0° is", "K_q", "factor on roll and fin rate", "rms log error, GA", "rms log error, PID"),
        tuple(rows),
        "Both fits of a row share K_q and the factor. The table cannot decide between the readings",
    )


def _implied_uncontrolled_roll() -> Table:
    rows = [
        (row.name, row.traditional.uncontrolled, row.genetic.uncontrolled,
         "yes" if _contradict(row.traditional, row.genetic) else "no")
        for row in TABLE_1
    ]  # fmt: skip
    return Table(
        "The roll without fins that table 1 implies",
        ("kn / °", "by the traditional PID °", "by the GA °", "apart by more than rounding"),
        tuple(rows),
        "roll / (1 - reduction); both columns have the same sea. At 90° the waves are met alike at 18 and 22 kn",
    )


def _contradict(one: ControllerResult, other: ControllerResult) -> bool:
    (low, high), (other_low, other_high) = one.uncontrolled_bounds, other.uncontrolled_bounds
    return high < other_low or other_high < low


def _search_scatter(evidence: FinGainEvidence) -> Table:
    rows = [
        (
            PREAMPLIFIER_LABELS[s.setting.preamplifier],
            s.setting.fin_objective.value,
            s.setting.normaliser.value,
            *(f"{low:.3g} to {high:.3g}" for low, high in zip(s.gains.min(axis=0), s.gains.max(axis=0), strict=True)),
            f"{s.Ms.min():.2f} to {s.Ms.max():.3g}",
            str(s.fragile_count),
            f"{s.reduction.min():.1f} to {s.reduction.max():.1f}",
            str(s.is_dominated.sum()),
        )
        for s in evidence.searches
    ]
    count = len(evidence.searches[0].Ms)
    box = ", ".join(f"{n} {low:g} to {high:g}" for n, low, high in zip(GAIN_NAMES, BOX.lower, BOX.upper, strict=True))
    return Table(
        "The published search over seeds",
        (
            "preamplifier",
            "fins",
            "normaliser",
            *GAIN_NAMES,
            "Ms",
            "Ms above 2",
            "reduction %",
            "beaten in all objectives",
        ),
        tuple(rows),
        f"{count} seeds each, population 50, 200 generations, codes of {BITS} bits, 18 kn, 90°, 3.3 m, in the box "
        f"{box}. Plain binary codes, parents by roulette, one-point crossover; the best in each of the "
        "three objectives survive. The answer is "
        "the fittest of the last generation under equal weights; beaten: another seed evaluated a point with all three "
        f"objectives smaller. Paper: {', '.join(f'{v:.5g}' for v in PUBLISHED_VALUES)}. With the best of "
        "the first generation as "
        "normaliser J2 outweighs all: as a washout every seed ends at the edge of instability, where the fins move "
        "just as much as the target says",
    )


def _search_results(evidence: FinGainEvidence, preamplifier: Preamplifier) -> Table:
    found: FinGainSearches = evidence.searches_with(preamplifier)
    rows = [
        (str(k + 1), *(float(v) for v in gains), float(peak), *(float(v) for v in shares), float(reduction))
        for k, (gains, peak, shares, reduction) in enumerate(
            zip(found.gains, found.Ms, found.objective_ratios, found.reduction, strict=True)
        )
    ]
    return Table(
        f"Answers of the published search, preamplifier {PREAMPLIFIER_LABELS[preamplifier]}",
        ("seed", *GAIN_NAMES, "Ms", "J1 / paper's", "J2 / paper's", "J3 / paper's", "reduction %"),
        tuple(rows),
        "J2 as printed, normalised by the largest of the first generation",
    )


def _times(evidence: FinGainEvidence) -> Table:
    compiled, single = evidence.time_domain_seconds
    rows = (
        ("variances in the frequency domain", evidence.search_seconds, 1.0),
        ("records of 1000 s, compiled scalar loop", compiled, compiled / evidence.search_seconds),
        ("records of 1000 s, scipy's lsim one after another", single, single / evidence.search_seconds),
    )
    return Table(
        TIMES_TITLE,
        ("objectives by", "s", "times the first"),
        rows,
        "The first is a whole search with its front, median of all; the others are the records alone, extrapolated "
        "from one record, exact zero-order hold. CPU time of this machine; no verdict hangs on it",
    )


def _three_gains(evidence: FinGainEvidence) -> Table:
    rows = [
        (
            PREAMPLIFIER_LABELS[reading],
            f"{b.ms_limit:.3g}",
            *(round(float(v), 3) for v in b.gains),
            b.Ms,
            *(float(v) for v in b.objective_ratios),
        )
        for reading in Preamplifier
        for b in evidence.three_gain_optima[reading]
    ]
    return Table(
        "Three gains against the paper's, in its own box",
        ("preamplifier", "Ms at most", *GAIN_NAMES, "Ms", "J1 / paper's", "J2 / paper's", "J3 / paper's"),
        tuple(rows),
        "The worst of the three objectives over the paper's, made small; the second Ms of each reading is that of the "
        "paper's gains. Where it stays at 1 the paper's gains lie on the front",
    )


def _five_gains(evidence: FinGainEvidence) -> Table:
    made = evidence.five_gain_design
    rows = [
        *(_comparison_row(c, "searched in") for c in made.design_seas),
        *(_comparison_row(c, "held out") for c in made.held_out_seas),
        *(_comparison_row(c, "three gains, same box") for c in made.three_gains),
    ]
    (band, _), (low, _) = FREQUENCIES_AND_DAMPINGS
    gains = ", ".join(f"{n} {v:.2f}" for n, v in zip(_FIVE_GAIN_NAMES, made.gains, strict=True))
    return Table(
        "Five gains, washout: variances over those of the paper's gains",
        ("sea, 18 kn, 90° unless said", "", "roll", "fin angle", "fin rate", "paper's reduction %", "ours %"),
        tuple(rows),
        f"{gains}; Ms {made.Ms:.2f}. KB: band-pass at {band:g} rad/s; KL: low-pass at {low:g} rad/s; KP, KI, KD in "
        "the paper's box. Tuned for beam seas: in long waves that overtake slowly another set has to be scheduled",
    )


def _comparison_row(comparison: FiveGainComparison, kind: str) -> tuple[str | float, ...]:
    name = comparison.sea.name or "ITTC 3.3 m, long-crested"
    return (
        name,
        kind,
        comparison.roll_ratio,
        comparison.fin_ratio,
        comparison.rate_ratio,
        comparison.paper_reduction,
        comparison.reduction,
    )


# Figures of the study: table 1, figures 3 to 7, answers over seeds, roll against fin rate.


def figures(evidence: FinGainEvidence) -> tuple[Figure | Bars, ...]:
    """Return all figures in the order of the page."""
    return (
        fin_rate_ratios(evidence),
        _reductions(evidence),
        *_histories(evidence),
        *(_search_bars(evidence, r) for r in Preamplifier),
        _sensitivity_peaks(evidence),
        _roll_against_rate(evidence),
    )


def _reductions(evidence: FinGainEvidence) -> Bars:
    series = {"paper, GA": tuple(row.genetic.reduction for row in TABLE_1)}
    for reading in Preamplifier:
        series[f"{PREAMPLIFIER_LABELS[reading]}, K_q fitted"] = tuple(
            m.reduction for m in evidence.table_1_responses[reading]
        )
    return Bars(
        "Table 1: roll reduction with the GA's gains",
        tuple(row.name for row in TABLE_1),
        series,
        "reduction [%]",
        "Long-crested sea, K_q fitted to 18 / 90 alone; K_alpha grows with the square of the speed.",
    )


def _histories(evidence: FinGainEvidence) -> list[Figure]:
    h, fit = evidence.histories, evidence.best_fit
    note = (
        f"One realisation, 18 kn, 90°; {PREAMPLIFIER_LABELS[fit.preamplifier]}, short-crested, K_q and the "
        "level fitted to table 1, "
        "the traditional PID's gains fitted to its column."
    )
    drawn = (
        ("Figure 3: roll without fins", "roll [°]", h.uncontrolled),
        ("Figure 4: roll under the traditional PID (fitted)", "roll [°]", h.pid[0]),
        ("Figure 5: roll under the GA's gains", "roll [°]", h.genetic[0]),
        ("Figure 6: fin rate under the traditional PID (fitted)", "fin rate [°/s]", h.pid[1]),
        ("Figure 7: fin rate under the GA's gains", "fin rate [°/s]", h.genetic[1]),
    )
    return [
        Figure(title, "time [s]", label, (Curve(f"rms {np.std(y):.2f}", h.time, y),), note) for title, label, y in drawn
    ]


def _search_bars(evidence: FinGainEvidence, preamplifier: Preamplifier) -> Bars:
    found = evidence.searches_with(preamplifier)
    shares = 100.0 * (found.gains - BOX.lower) / BOX.width
    return Bars(
        f"Answers of the published search by seed, preamplifier {PREAMPLIFIER_LABELS[preamplifier]}",
        tuple(str(k + 1) for k in range(len(shares))),
        {name: tuple(float(v) for v in shares[:, i]) for i, name in enumerate(GAIN_NAMES)},
        "share of the searched range [%]",
        "The paper's answer: 11.1, 0.9 and 32.7 %.",
    )


def _sensitivity_peaks(evidence: FinGainEvidence) -> Bars:
    series = {}
    for reading in Preamplifier:
        for fins in FinObjective:
            series[f"{PREAMPLIFIER_LABELS[reading]}, {fins.value}"] = tuple(
                float(v) for v in evidence.searches_with(reading, fins).Ms
            )
    count = len(evidence.searches[0].Ms)
    return Bars(
        "Sensitivity peak of these answers",
        tuple(str(k + 1) for k in range(count)),
        series,
        "Ms",
        "A stabiliser should not exceed 2.",
        is_logarithmic=True,
    )


def _roll_against_rate(evidence: FinGainEvidence) -> Figure:
    made = evidence.five_gain_design
    names = {3: "three gains", 5: "five gains"}
    curves = [Curve(names[count], made.rate_ratios, roll) for count, roll in made.roll_ratios.items()]
    paper = (np.array([0.97, 1.03, 1.0, 1.0, 1.0]), np.array([1.0, 1.0, 1.0, 0.97, 1.03]))
    return Figure(
        "Roll against fin rate, washout, Ms at most 2",
        "fin-rate variance allowed / paper's",
        "roll variance / paper's",
        (*curves, Curve("paper's gains", *paper)),
        "The worse of long- and short-crested ITTC seas of 3.3 m. KP, KI, KD in the box of the paper.",
    )
