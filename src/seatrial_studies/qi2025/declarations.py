"""What the page declares of the paper: its symbols, what is assumed, what deviates from the print, its figures."""

from seatrial.core.results import Table
from seatrial_studies.declarations import Assumption, Declarations, Deviation, FigureCounterpart, Symbol
from seatrial_studies.qi2025.reproduction import (
    QUICK_RUNS,
    RUNS,
    TEN_RUN_SETTINGS,
    SearchSetting,
    WildHorseReproduction,
)

FREQUENCY_TITLE = "Frequencies of encounter"
"""Title of the table on what constant coefficients and equal intervals mean."""

_SYMBOLS = (
    Symbol("z, θ", "heave and pitch", "m, rad", "z up, θ bow down in figures; the model has z down, θ bow up"),
    Symbol("m, I5", "mass and pitch moment of inertia", "kg, kg m²", "table 1"),
    Symbol("a33, a35, a53, a55", "added masses", "kg, kg m, kg m, kg m²", "searched; theory in tables 2 to 4"),
    Symbol("b33, b35, b53, b55", "damping", "kg/s, kg m/s, kg m/s, kg m²/s", "searched; theory in tables 2 to 4"),
    Symbol("c33, c35, c53, c55", "restoring coefficients", "N/m, N/rad, N, N m/rad", "table 1, known to the search"),
    Symbol("F3, M5", "force and moment of the waves, eq. (14)", "N, N m", "30 harmonics, known to the search"),
    Symbol("X, Y, U, V", "states, motions, forces, measurement noise", "SI", "eqs. (2) to (7)"),
    Symbol("F3r, F3i, M5r, M5i", "parts of force and moment in and out of phase", "N/m, N", "eq. (14); not printed"),
    Symbol("M, A_M, B_M", "matrices of eqs. (3) to (5)", "SI", "A = M⁻¹ A_M, B = M⁻¹ B_M"),
    Symbol("A, B, H; Φ, Ψ", "matrices in continuous time; over a sample, eq. (12)", "SI", "zero-order hold, eq. (8)"),
    Symbol(
        "x(k), y(k), t, t0, τ", "state and output at sample k; times of eqs. (8) to (11)", "SI, s", "eqs. (8) to (12)"
    ),
    Symbol("T_S", "sampling interval, one iteration", "s", "0.5"),
    Symbol("S_ξ, A, B, h1/3", "spectrum of the waves, eq. (13)", "m² s, m²/s⁴, 1/s⁴, m", "h1/3 = 2.27"),
    Symbol("ω, Δω, ξ_ak", "frequency of a harmonic, interval, amplitude", "rad/s, rad/s, m", "√(2 S_ξ Δω)"),
    Symbol("g", "acceleration of gravity", "m/s²", "9.81"),
    Symbol("h, rr, ss, v", "draught, equivalent radius and section, speed", "m, m, m², kn", "table 1"),
    Symbol("N, P_S, P_C, T_max", "population, stallions, crossover, iterations", "1", "40, 0.25, 0.13, 200"),
    Symbol("G, T", "groups N P_S; iteration, eq. (17)", "1", "10; 1 to 200"),
    Symbol("x_G, x̄_G", "place of a foal of group G, and its new one", "as the unknowns", "eqs. (15), (18), (20)"),
    Symbol("Crossover, Mean", "mating: mean of two foals of other groups", "as the unknowns", "eq. (18)"),
    Symbol("R of eqs. (15), (19), (23)", "random number in [−2, 2]", "1", "uniform"),
    Symbol("R1, R3; R2", "random vectors, a random number, in [0, 1]", "1", "eq. (16)"),
    Symbol("R_w", "random number in [0, 1], which line of eq. (19) or (25)", "1", "0.5 divides them"),
    Symbol("Q1, Q2", "random numbers in [−1, 1]", "1", "eqs. (24), (25)"),
    Symbol("f_i, f_min, f_avg", "fitness of a stallion, least and mean of all", "as F", "eq. (22)"),
    Symbol("ω of eqs. (22) to (25)", "dynamic inertia weight", "1", "0.1 to 0.9"),
    Symbol("rand", "random number in [0, 1]", "1", "eq. (21)"),
    Symbol("ω_min, ω_max", "limits of the dynamic inertia weight, eq. (22)", "1", "0.1, 0.9"),
    Symbol("Z, R, IDX, P, FT", "adaptive parameter of a stride and what it is drawn from", "1", "eqs. (16), (17)"),
    Symbol("N_S, WH", "place of a stallion, of the best one (waterhole)", "as the unknowns", "eqs. (15), (19)"),
    Symbol("ub, lb", "bounds of the search", "as the unknowns", "not printed"),
    Symbol("ω, c1, c2, r1, r2", "particle swarm, eq. (29)", "1", "not printed"),
    Symbol("v_ij, x_ij, P_ij, G_j", "velocity, place, own best and best of all of PSO", "as the unknowns", "eq. (29)"),
    Symbol("N of eqs. (26) to (28)", "observations; eq. (28) has the two motions of one sample", "1", "2"),
    Symbol("θ of eqs. (26) to (28)", "the unknowns; in (28) also pitch", "theirs; not printed", "one letter for both"),
    Symbol("y_s, y_m", "motions by the theoretical and by the identified values", "m and an angle", "eqs. (26), (27)"),
    Symbol("z0, θ0; z1, θ1", "heave and pitch, theoretical and identified", "m and an angle", "eq. (28)"),
    Symbol(
        "J, ε, F", "error functional, output error, fitness, eqs. (26) to (28)", "m and an angle", "unit not printed"
    ),
)
_ASSUMPTIONS = (
    Assumption(
        "box of the searches", "not printed",
        "±10 % about the truth, as WHO's clipped values suggest; compared with others",
    ),
    Assumption("ω, c1, c2 of PSO", "not printed",
               "Clerc and Kennedy's constriction values 0.7298, 1.49618, 1.49618; clipped to the box"),
    Assumption("velocities of PSO", "start, limit and wall not printed",
               "start: half the way to a random point of the box; limit: the width of the box; at a wall a particle "
               "stays there and its velocity across becomes zero (standard swarm of 2006)"),
    Assumption("which foals mate, eq. (18)", "two of other groups",
               "the worst of two other groups, as in the program of WHO's authors"),
    Assumption("coefficients of the sea", "one set for each heading",
               f"as printed, constant in an irregular sea; what that means: '{FREQUENCY_TITLE}'"),
    Assumption(
        "state a candidate steps from", "not printed", "the true previous one (generous); compared with the model's own"
    ),
    Assumption("unit of pitch in eq. (28)", "not printed", "rad; compared with degrees"),
    Assumption("remembered fitness", "not printed",
               "judged again by each new sample; kept beside it, at 45° and, in the full version, at all headings"),
    Assumption("coefficients at 45°", "not printed", "those of 90°"),
    Assumption("forces of the waves", "not printed", "box-shaped hull in closed form, Jensen, Mansour & Olsen 2004"),
    Assumption("hull behind table 1", "half length 30 m, section 16.2 m²", "L 60 m, B 16.2/2.27 = 7.14 m"),
    Assumption("phases of the harmonics", "not printed", "random, one sea a run"),
    Assumption("spacing of the harmonics", "30 equal intervals",
               f"as printed; at 90° the sea then repeats itself within a record: '{FREQUENCY_TITLE}'"),
    Assumption("band of the harmonics", "not printed", "0.1 to 99 % of the energy, 0.544 to 2.78 rad/s"),
    Assumption("measurement noise", "V in eq. (7), no number", "none; 1 cm and 0.02° for our fit beside it"),
    Assumption("state at the start", "not printed", "at rest"),
    Assumption("after the last iteration", "figures run to 200 s, the search ends at 100 s", "the last point is kept"),
)  # fmt: skip
_DEVIATIONS = (
    Deviation("figures 6, 7", "motions of the search of figure 5", "of the chosen setting; figure 5 from the own state",
              "no one setting is near to all of the print"),
    Deviation("tables 2 to 4", "b53 positive", "negative", "(b35 + |b53|) / (2 a33) is the speed only then"),
    Deviation("eq. (14)", "harmonics at ω", "at the frequency of encounter ω − ω² U cos β / g", "the ship has way on"),
    Deviation("eq. (14)", "no phases", "a random phase for each harmonic", "without them every crest meets at t = 0"),
    Deviation("eq. (13)", "B = 3.11 / h³", "B = 3.11 / h²", "h³ gives 3.42 m for 2.27 m; one parameter, not two"),
    Deviation("eq. (2)", "states z, θ, ż, θ̇", "z, ż, θ, θ̇", "the matrices of eqs. (3), (4) and H fit this order only"),
    Deviation("eq. (7)", "Ẋ = AX + AU", "Ẋ = AX + BU", "eq. (6) has B, and A has no columns for the forces"),
    Deviation("eqs. (19), (25)", "a stallion takes its new place", "only where the new place is fitter",
              "as the program of WHO's authors; otherwise the waterhole itself is lost"),
    Deviation("eqs. (15), (19), (25)", "places may leave the box", "clipped to it", "eq. (21) has bounds for all"),
    Deviation("eq. (22)", "undefined if f_avg = f_min", "ω_min", "no division by zero"),
    Deviation("eq. (15)", "x̄ on the left lost in print", "new place of the foal", "the text explains the symbol so"),
)  # fmt: skip
_FIGURES = (
    FigureCounterpart("Figure 1", "heave at 45°, 200 s", ("Figure 1: heave",)),
    FigureCounterpart("Figure 2", "pitch at 45°, 200 s", ("Figure 2: pitch",)),
    FigureCounterpart("Figure 3", "block diagram of the output error",
                      reason="It shows no result; eqs. (26) to (28) say the same."),
    FigureCounterpart("Figure 4", "pseudo-code of the identification",
                      reason="It shows no result; the steps are those of section 3.2."),
    FigureCounterpart("Figure 5", "fitness over iterations at 45°",
                      ("Figure 5: fitness of IWHO", "Figure 5a: fitness of the best point",
                       "Figure 5b: fitness of the best point")),
    FigureCounterpart("Figure 6", "heave, observed and identified, at 45°", ("Figure 6: heave tracked",)),
    FigureCounterpart("Figure 7", "pitch, observed and identified, at 45°", ("Figure 7: pitch tracked",)),
    FigureCounterpart("Figure 8", "a33 and b33 over time at 45°", ("Figure 8: a33 and b33",)),
    FigureCounterpart("Figure 9", "a35 and b35 over time at 45°", ("Figure 9: a35 and b35",)),
    FigureCounterpart("Figure 10", "a55 and b55 over time at 45°", ("Figure 10: a55 and b55",)),
    FigureCounterpart("Figure 11", "a53 and b53 over time at 45°", ("Figure 11: a53 and b53",)),
)  # fmt: skip
DECLARATIONS = Declarations(_SYMBOLS, _ASSUMPTIONS, _DEVIATIONS, _FIGURES)


def declaration_tables(reproduction: WildHorseReproduction) -> tuple[Table, ...]:
    """Return the tables of the page; a note says what was left out of a quick run."""
    ten = " and ".join(f"'{s.value}'" for s in TEN_RUN_SETTINGS)
    times = f"{QUICK_RUNS} runs ({ten}: {RUNS})" if reproduction.is_quick else f"{RUNS} runs"
    note = (
        "Unit, memory and state were chosen as the combination whose IWHO comes nearest to the print; the tables of "
        f"settings show the others. Each of them has {times} at each of 90, 135 and 180°. At 45°, for figures 1, 2 and "
        f"5 to 11: {RUNS} runs in the setting '{SearchSetting.PAPER.value}', one run in each of the others shown."
    )
    absent = [s.value for s in SearchSetting if s not in reproduction.settings]
    if absent:
        note += f" Left out of this quick version at 90, 135 and 180°: {'; '.join(absent)}."
    return DECLARATIONS.tables(note)
