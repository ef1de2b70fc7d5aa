"""What the page declares of the paper: its symbols, what is assumed, what deviates from the print, its figures."""

from seatrial.core.results import Table
from seatrial_studies.declarations import Assumption, Declarations, Deviation, FigureCounterpart, Symbol

_SYMBOLS = (
    Symbol("x, y, ψ (φ in eq. (1))", "position and heading, earth-fixed", "m, m, rad", "states"),
    Symbol("u, v, r", "surge, sway, yaw rate", "m/s, m/s, rad/s", "states"),
    Symbol("V, V_x, V_y; U", "speed over ground and its parts; speed through water", "m/s", "figure 1"),
    Symbol("U_c, ψ_c", "speed and direction of a uniform current", "m/s, rad", "figure 1 alone; none is simulated"),
    Symbol("δ", "nozzle angle", "rad", "input"),
    Symbol("m, m_x, m_y", "mass, added masses", "kg", "5540; not printed"),
    Symbol(
        "m', m_x', m_y'; I_zz', J_zz'", "the same over ρ L² d / 2; inertias over ρ L⁴ d / 2", "1", "read from eq. (14)"
    ),
    Symbol("X_uu' ... N_rr'", "coefficients in eq. (14)", "1", "those of table 2"),
    Symbol("I_zz, J_zz", "yaw inertia, added inertia", "kg m²", "not printed"),
    Symbol("X_H, Y_H, N_H", "hull forces and moment, eqs. (2), (13)", "N, N, N m", "thirteen, then eleven terms"),
    Symbol("X_uu ... N_rr, N_vrr, N_vvr", "hydrodynamic coefficients", "1", "table 2; the last two are not in it"),
    Symbol("X_P, Y_P, N_P", "jet forces and moment, eq. (3)", "N, N, N m", "eq. (3) corrected"),
    Symbol("ρ, α, x_T, v_j, A_j", "density, momentum factor, lever, jet velocity and area", "SI", "not printed"),
    Symbol("ρ in eq. (17)", "factor of the quasi-difference", "1", "1: a difference"),
    Symbol("L, B, C_b, d", "length, breadth, block coefficient, draught", "m, m, 1, m", "9.8, 3.17, 0.251, 0.71"),
    Symbol(
        "z_i, Z, Z'; I, E, σ", "data; standard score, mean, deviation, eqs. (4) to (7)", "as the data", "section 1.2"
    ),
    Symbol("Λ", "threshold of small values, eq. (8)", "as the data", "not printed"),
    Symbol("M, N, r; D", "training samples, samples, share, eq. (9); data sets", "1", "r = 0.8"),
    Symbol(
        "Y, X, ε in eq. (10)", "responses, regressors, random error of the linear model", "of the rows", "section 1.3.1"
    ),
    Symbol("λ, K; β, p", "penalties, their list, eqs. (11), (12); coefficients", "1", "1e-6 to 1e6"),
    Symbol("h, k", "sampling interval, sample", "s, 1", "0.1"),
    Symbol("X_w, Y_w, N_w; C_Xw, C_Yw, C_Nw", "coefficients and features, eq. (14)", "1; m²/s²", "section 1.4"),
    Symbol("μ", "mean that centring takes off, eq. (18)", "as the data", "of the rows"),
    Symbol("ω, b, Φ, K", "weights, bias, map, linear kernel, eqs. (19) to (26)", "1", "b should be near 0"),
    Symbol("C, ζ (ε; E in eq. (24)), ξ, α, η", "penalty, tube, slacks, multipliers", "1", "C and tube not printed"),
    Symbol("Cond, λ_max, λ_min", "condition number and singular values, eqs. (27), (28)", "1", "table 3"),
    Symbol("RMSE, CC", "root mean square error, correlation", "m/s, rad/s; 1", "table 4"),
)
_ASSUMPTIONS = (
    Assumption("added masses, inertias", "not printed",
               "Zhou 1983: 0.0281 m, 0.785 m, 0.0699 m L²; I_zz = m (0.25 L)²"),
    Assumption("density", "not printed", "1025 kg/m³; 1000 is what makes the printed mass of C_b L B d"),
    Assumption("A_j, α, x_T", "not printed", "0.035 m², 1, -0.45 L"),
    Assumption("v_j", "not printed, nor whether it is constant", "1.866 m/s, constant: balances 0.8 m/s"),
    Assumption("nozzle rate; integrator", "not printed", "4°/s; fourth-order Runge-Kutta of 0.01 s"),
    Assumption("limits of the cleaning", "not printed", "standard score 3, small values 0.001 deviations"),
    Assumption("8:2 split, random or in blocks", "not printed", "in blocks, the end of the record for testing"),
    Assumption("number of Lasso penalties; folds in blocks or shuffled", "not printed", "49; in blocks"),
    Assumption("C, tube, scaling of features and targets", "not printed",
               "1, 0.1 deviations, scaled; others in a table"),
    Assumption("N_vrr, N_vvr in the reference motions", "in eq. (2), not in table 2", "zero"),
    Assumption("current of figure 1", "U_c, ψ_c without values", "none"),
    Assumption("predictions with the helmsman in the loop or replayed",
               "not said; figures 4c, 7c compare nozzle angles",
               "both: table 4 replayed, nozzle figures with the helmsman"),
    Assumption("unit of r in table 4 and figures", "not printed", "rad/s"),
    Assumption("CFD test values as truth", "“CFD test values” of table 2", "coefficients of a simulated craft: all "
               "motions here are simulated, none is measured or computed by CFD"),
)  # fmt: skip
_DEVIATIONS = (
    Deviation("table 2, N_v; improved Y_vv", "+0.1708; +0.6083", "-0.1708; -0.6083",
              "printed, the turn reverses; sway is "
              "driven (misprints, with evidence)"),
    Deviation("eqs. (1), (2), (3), (13), (14)", "as printed", "corrected", "see the misprints, each with what it does"),
    Deviation("section 1.3.1, responses of Lasso", "forces X_H, Y_H, N_H on raw products",
              "acceleration times inertia on eq. (14)'s features; also the printed ones", "forces are not measured"),
    Deviation("section 1.2, training data",
              "10/10, 15/15, 20/20, 25/25, 30/30, five executes each, 0.1 s: 2100 s, 21000 samples",
              "the same, ending with the last execute; samples in the table of cleaning",
              "what follows the last execute is not printed"),
    Deviation("section 1.3.1, folds", "ten subsets", "ten contiguous blocks", "neighbouring samples are one sample"),
    Deviation("eq. (27)", "norm times an inverse without norm", "norm times norm of the inverse", "eq. (28) is that"),
    Deviation("table 3", "labels", "surge and sway exchanged beside", "sway's number cannot be below yaw's"),
)  # fmt: skip
_FIGURES = (
    FigureCounterpart("Figure 1", "coordinate systems and current",
                      reason="not drawn: a schematic; its quantities are in Symbols"),
    FigureCounterpart("Figure 2", "sensitivity of each coefficient",
                      ("Figure 2: indirect sensitivity of each coefficient",)),
    FigureCounterpart("Figure 3", "flow of the identification",
                      reason="not drawn: a schematic; its steps are in the tables of the chain and of steps left out"),
    FigureCounterpart("Figure 4", "20/20: motions, track, heading and nozzle", (
        "Figures 4, 5: zigzag:20/20, u", "Figure 4b: zigzag:20/20, track", "Figure 4c: zigzag:20/20, nozzle")),
    FigureCounterpart("Figure 5", "20/20: forces", ("Figures 4, 5: zigzag:20/20, X", "Figures 4, 5: zigzag:20/20, N")),
    FigureCounterpart("Figure 6", "correlation of the features", ("Figure 6: correlation of the features, sway",)),
    FigureCounterpart("Figure 7", "35/35: motions, track, heading and nozzle", (
        "Figures 7, 8: zigzag:35/35, u", "Figure 7b: zigzag:35/35, track", "Figure 7c: zigzag:35/35, nozzle")),
    FigureCounterpart("Figure 8", "35/35: forces", ("Figures 7, 8: zigzag:35/35, X", "Figures 7, 8: zigzag:35/35, N")),
    FigureCounterpart("Figure 9", "35° turn: motions and track", (
        "Figures 9, 10: turning-circle:35, u", "Figure 9b: turning-circle:35, track")),
    FigureCounterpart("Figure 10", "35° turn: forces", ("Figures 9, 10: turning-circle:35, X",)),
)  # fmt: skip
DECLARATIONS = Declarations(_SYMBOLS, _ASSUMPTIONS, _DEVIATIONS, _FIGURES)


def declaration_tables() -> tuple[Table, ...]:
    """Return the tables of symbols, assumptions, deviations and figures."""
    return DECLARATIONS.tables("Signs under other choices of these: in the table of misprints.")
