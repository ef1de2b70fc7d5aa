"""What the page declares of the paper: its symbols, what is assumed, what deviates from the print, its figures."""

from seatrial.core.results import Table
from seatrial_studies.declarations import Assumption, Declarations, Deviation, FigureCounterpart, Symbol
from seatrial_studies.meng2014.reproduction import ITERATIONS, RUNS, CloudSwarmReproduction

_SYMBOLS = (
    Symbol("z, θ", "heave and pitch", "m, rad", "figures 2 and 3 in cm and degrees; drawn z up, θ bow down"),
    Symbol("m, I5", "mass and pitch moment of inertia, eqs. (1) and (3)", "kg, kg m²", "lost with the equations"),
    Symbol("F_R, X_R", "lift of the horizontal fin and its lever", "N, m", "not printed"),
    Symbol("F3, M5", "force and moment of the waves", "N, N m", "not printed"),
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
    Symbol("Y_i, dataNum", "observed motions, i = 1 to dataNum their number, eq. (7)", "m, deg", "dataNum not printed"),
)
_ASSUMPTIONS = (
    Assumption("table 1: coefficients and errors", "lost", "nothing; errors of our own searches"),
    Assumption("ship and coefficients", "not printed", "Qi et al. 2025; at 0 and 45° those of 90°; b53 negative"),
    Assumption(
        "eqs. (1) to (3)",
        "lost but for their symbols",
        "heave and pitch as Qi et al. 2025 have them, eqs. (1) to (5), the fin's force and moment added",
    ),
    Assumption("heading of figures 2, 3", "not printed", "135°"),
    Assumption("box of the searches", "not printed", "±50 % with the truth off centre; compared with ±10 % about it"),
    Assumption("sea state 3", "no height printed", "0.88 m, ITTC spectrum, 30 equal intervals, random phases"),
    Assumption("forces of the waves", "not printed", "box-shaped hull in closed form, Jensen, Mansour & Olsen 2004"),
    Assumption("fin", "±10, no unit, pseudo-random", "±10° held for 1 s; 6 m², lift slope 3/rad, 25 m aft"),
    Assumption("measurement noise", "white, Gaussian, mean 0, no deviation", "the same; 1 cm and 0.02°"),
    Assumption("record", "number of samples not printed", "200 s, a sample every 0.5 s, from rest, force held"),
    Assumption("fitness, eq. (7)", "lost", "root mean square of heave in m and pitch in degrees"),
    Assumption(
        "law of the weight, eq. (6)",
        "lost but for its constants",
        "our form, a normal cloud of the kind ascribed to Wei et al. 2009; unverified",
    ),
    Assumption("mutation", "probability 0.2; law lost", "particles with ratio below B become drops round the best"),
    Assumption("its spread", "lost", "En from 0.1 of the range to 0, He = En / 10"),
    Assumption("velocity limit", "not printed", "0.2 of the range"),
    Assumption(
        "PSO compared with",
        "inertia not printed",
        "Clerc and Kennedy's constriction values 0.7298, 1.49618, 1.49618; compared with eq. (4) as printed",
    ),
    Assumption(
        "coefficients of the sea", "one set for each course", "constant in an irregular sea, as Qi et al. 2025 have it"
    ),
)
_DEVIATIONS = (
    Deviation("eq. (4)", "no inertia weight", "w multiplies the velocity", "eq. (6) adjusts one; see the claim"),
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
