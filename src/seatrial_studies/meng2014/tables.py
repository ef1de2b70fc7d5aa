"""What the page declares of the paper, its tables and its figures."""

import numpy as np

from seatrial.core.results import Curve, Figure, Table
from seatrial.core.values import Array
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.simulate import trajectories
from seatrial_studies.controller_cost import pitch_controller_cost_table
from seatrial_studies.declarations import Assumption, Declarations, Deviation, FigureCounterpart, Symbol
from seatrial_studies.heave_pitch_search import STEP, RepeatedSearches, candidate_matrices
from seatrial_studies.meng2014.reproduction import (
    HEADINGS,
    ITERATIONS,
    RUNS,
    BoxPlacement,
    CloudSwarmEvidence,
    CloudSwarmReproduction,
    CloudVariant,
    SwarmAlgorithm,
)

# What the page declares of the paper: its symbols, what is assumed, what deviates from the print, its figures.

_SYMBOLS = (
    Symbol("z, θ", "heave and pitch", "m, rad", "figures 2 and 3 in cm and degrees; drawn z up, θ bow down"),
    Symbol("m, I5", "mass and pitch moment of inertia, eqs. (1) and (3)", "kg, kg m²", "lost with the equations"),
    Symbol("F_R, X_R", "lift of the horizontal fin and its lever", "N, m", "not in our copy"),
    Symbol("F3, M5", "force and moment of the waves", "N, N m", "not in our copy"),
    Symbol("a33, a35, a53, a55", "added masses", "kg, kg m, kg m, kg m²", "searched"),
    Symbol("b33, b35, b53, b55", "damping", "kg/s, kg m/s, kg m/s, kg m²/s", "searched"),
    Symbol(
        "c33, c35, c53, c55",
        "restoring coefficients",
        "N/m, N/rad, N, N m/rad",
        "listed as unknown, then taken from theory",
    ),
    Symbol("x1 … x4", "states: heave, its rate, pitch, its rate", "m, m/s, rad, rad/s", "eq. (2); x2, x4 lost"),
    Symbol("E, A*, B*, C*", "matrices before the inversion of E", "SI", "eq. (3)"),
    Symbol("A, B, C; u, W", "E⁻¹ A*, E⁻¹ B*, E⁻¹ C*; fin and wave inputs", "SI", "eq. (3); u = F_R, W = (F3 M5)"),
    Symbol("para", "the unknowns", "SI", "twelve listed, eight searched"),
    Symbol("N, D", "particles, unknowns", "1", "60, 8"),
    Symbol("i, t", "number of a particle, iteration", "1", "1 to 60, 1 to 1000"),
    Symbol(
        "v, x, pbest, gbest",
        "velocity, place, own best and best of all, eqs. (4), (5)",
        "as the unknowns",
        "eqs. (4), (5)",
    ),
    Symbol("c1, c2", "learning factors", "1", "2.05, 2.05"),
    Symbol("r1, r2", "random numbers in (0, 1)", "1", "drawn for every component"),
    Symbol("w, w1, w2", "inertia weight and its ends, eq. (6)", "1", "w1 = 0.9, w2 = 0.4"),
    Symbol("Ex, En, He", "expectation, entropy, hyper-entropy of the cloud", "1", "5 w1 − w2, 5, 0.5"),
    Symbol("A, B; r", "thresholds; r = f_best / f, ratio of the least fitness to a particle's", "1", "0.15, 0.93"),
    Symbol(
        "x_i, u_i, n, En′",
        "cloud drop, its certainty, their number, drawn entropy",
        "1",
        "INPUT and OUTPUT of the cloud",
    ),
    Symbol("RANDN(a, b)", "normal random number of mean a and deviation b", "as a", "for En′ and x_i"),
    Symbol("rand, p_m", "random number in (0, 1), probability of mutation", "1", "p_m = 0.2"),
    Symbol(
        "Y_i, dataNum", "observed motions, i = 1 to dataNum their number, eq. (7)", "m, deg", "dataNum not in our copy"
    ),
)
_ASSUMPTIONS = (
    Assumption("table 1: coefficients and errors", "lost", "nothing; errors of our own searches"),
    Assumption("ship and coefficients", "not in our copy", "Qi et al. 2025; at 0 and 45° those of 90°; b53 negative"),
    Assumption(
        "eqs. (1) to (3)",
        "lost in our copy but for their symbols",
        "heave and pitch as Qi et al. 2025 have them, eqs. (1) to (5), the fin's force and moment added",
    ),
    Assumption("heading of figures 2, 3", "not in our copy", "135°"),
    Assumption(
        "box of the searches", "not in our copy", "±50 % with the truth off centre; compared with ±10 % about it"
    ),
    Assumption("sea state 3", "no height given", "0.88 m, ITTC spectrum, 30 equal intervals, random phases"),
    Assumption(
        "forces of the waves", "not in our copy", "box-shaped hull in closed form, Jensen, Mansour & Olsen 2004"
    ),
    Assumption("fin", "±10, no unit, pseudo-random", "±10° held for 1 s; 6 m², lift slope 3/rad, 25 m aft"),
    Assumption("measurement noise", "white, Gaussian, mean 0, no deviation", "the same; 1 cm and 0.02°"),
    Assumption("record", "number of samples not in our copy", "200 s, a sample every 0.5 s, from rest, force held"),
    Assumption("fitness, eq. (7)", "lost", "root mean square of heave in m and pitch in degrees"),
    Assumption(
        "law of the weight, eq. (6)",
        "lost in our copy but for its constants",
        "our form, a normal cloud of the kind ascribed to Wei et al. 2009; unverified",
    ),
    Assumption("mutation", "probability 0.2; law lost", "particles with ratio below B become drops round the best"),
    Assumption("its spread", "lost", "En from 0.1 of the range to 0, He = En / 10"),
    Assumption("velocity limit", "not in our copy", "0.2 of the range"),
    Assumption(
        "PSO compared with",
        "inertia not in our copy",
        "Clerc and Kennedy's constriction values 0.7298, 1.49618, 1.49618; compared with eq. (4) as printed",
    ),
    Assumption(
        "coefficients of the sea", "one set for each course", "constant in an irregular sea, as Qi et al. 2025 have it"
    ),
)
_DEVIATIONS = (
    Deviation("eq. (4)", "the base method, no inertia weight", "w multiplies the velocity", "eq. (6) adjusts one"),
    Deviation("parameters", "twelve listed", "eight searched", "as the paper itself: stiffnesses come from theory"),
    Deviation("truth", "full-scale trials in eq. (7), theory in the text", "theory", "the simulation has no trials"),
    Deviation("waves", "harmonics at ω", "at the frequency of encounter", "the ship makes 18 kn"),
    Deviation("CPSO, the parent (Wei et al. 2009, reference 12)", "cited as its base", "left out",
              "no source of its law: stored documentation, web pages and program texts were searched for its English "
              "and "
              "Chinese names; only a program of a variant was found, which cites nothing"),
)  # fmt: skip
_FIGURES = (
    FigureCounterpart("Figure 1", "flow chart", reason="It shows no result; section 3 says the same."),
    FigureCounterpart("Figure 2", "heave over samples, theory and identified", ("Figure 2: heave",)),
    FigureCounterpart("Figure 3", "pitch over samples, theory and identified", ("Figure 3: pitch",)),
)
DECLARATIONS = Declarations(_SYMBOLS, _ASSUMPTIONS, _DEVIATIONS, _FIGURES)


def declaration_tables(reproduction: CloudSwarmReproduction) -> tuple[Table, ...]:
    """Return the tables of the page; a note says what a quick run leaves out."""
    runs = reproduction.run_count
    note = f"{runs} runs of {reproduction.iterations} iterations at each heading, each in a sea of its own."
    if (runs, reproduction.iterations) != (RUNS, ITERATIONS):
        note += f" This is the quick version: the whole one has {RUNS} runs of {ITERATIONS}."
    return DECLARATIONS.tables(note)


# Tables: coefficients at five headings, what the cloud does, times, declarations, controllers.


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
        "PSO by eq. (4), the base method": made.unweighted_searches,
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
        "Iterations until the fitness comes as near as the noise allows to the better of ICPSO's and PSO's ends in the "
        "same sea and box. Medians over the runs, a dash where it never does; box \u00b150 % off centre."
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


# Figures: curves of the paper, convergence of all swarms, histories of coefficients.

# deg, heading of the figures
FIGURE_HEADING = 135
# iterations of the figure of convergence: later nothing moves; our choice
_DRAWN_ITERATIONS = 300
# smallest excess that is drawn, a tenth of what the noise explains; our choice
_LEAST_EXCESS = 6e-5


def figures(evidence: CloudSwarmEvidence) -> tuple[Figure, ...]:
    """Figures 2 and 3, convergence, and histories."""
    return (*_curves(evidence), _convergence_figure(evidence), _history(evidence))


def _curves(evidence: CloudSwarmEvidence) -> list[Figure]:
    data = evidence.reproduction.seas[FIGURE_HEADING][0]
    found = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, FIGURE_HEADING, SwarmAlgorithm.ICPSO]
    A, B = candidate_matrices(found.points[:1])
    y = trajectories(A, B, data.forcing, np.zeros(4))[0]
    samples = np.arange(len(y), dtype=np.float64)
    made = []
    note = (
        f"{FIGURE_HEADING}\u00b0 (assumed, the paper does not say), first run of ICPSO, box \u00b150 % off centre, a "
        f"sample every {STEP} s: the simulated truth with its noise, and the motion by the identified coefficients. "
        "That they coincide says little of the coefficients."
    )
    for j, factor, title, unit in (
        (0, 100.0, "Figure 2: heave", "cm"),
        (1, float(np.degrees(1.0)), "Figure 3: pitch", "deg"),
    ):
        measured = Curve("truth with noise, simulated", samples, -factor * data.measured[:, j])
        identified = Curve("identified", samples, -factor * y[:, j])
        made.append(Figure(title, "sample", unit, (measured, identified), note))
    return made


def _convergence_figure(evidence: CloudSwarmEvidence) -> Figure:
    made = evidence.reproduction
    swarms = {str(a): evidence.off_centre(a) for a in SwarmAlgorithm}
    swarms["PSO by eq. (4), the base method"] = made.unweighted_searches
    curves = []
    for name, searches in swarms.items():
        excess = _median_excess(evidence, searches)[:_DRAWN_ITERATIONS]
        curves.append(Curve(name, np.arange(len(excess), dtype=np.float64), np.log10(excess)))
    drawn = np.arange(min(_DRAWN_ITERATIONS, made.iterations), dtype=np.float64)
    curves.append(Curve("within noise", drawn, np.full(len(drawn), np.log10(evidence.noise_allowance))))
    note = (
        "Median over all headings and runs of the best fitness over the less of the two with which ICPSO and PSO end "
        "in the same "
        f"sea and box, less 1, its first {_DRAWN_ITERATIONS} iterations; box \u00b150 % off centre."
    )
    return Figure("Convergence", "iteration", "log10 of the excess of the fitness", tuple(curves), note)


def _median_excess(evidence: CloudSwarmEvidence, searches: dict[int, RepeatedSearches]) -> Array:
    excess = np.concatenate([evidence.reproduction.excess_fitness(h, searches[h]) for h in HEADINGS])
    return np.maximum(np.median(excess, axis=0), _LEAST_EXCESS)


def _history(evidence: CloudSwarmEvidence) -> Figure:
    found = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, FIGURE_HEADING, SwarmAlgorithm.ICPSO]
    iterations = np.arange(len(found.trace), dtype=np.float64)
    errors = 100.0 * (found.trace / found.truth - 1.0)
    names = ("a33", "a55", "b33", "b55", "b53")
    curves = tuple(Curve(n, iterations, errors[:, COEFFICIENTS.index(n)]) for n in names)
    return Figure(
        "Histories of coefficients", "iteration", "error, %", curves, f"ICPSO, {FIGURE_HEADING}\u00b0, first run."
    )
