"""What the page declares of the paper: its symbols, what is assumed, what deviates from the print, its figures."""

from seatrial.core.results import Table
from seatrial_studies.declarations import Assumption, Declarations, Deviation, FigureCounterpart, Symbol
from seatrial_studies.yu2014.energy import BLOCK_COEFFICIENT, EFFICIENCY, GYRADIUS_SHARE
from seatrial_studies.yu2014.published import ASPECT, CHORD, DENSITY, SPAN, THICKNESS

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
