"""The paper's figures drawn again: motions, convergence, tracking, histories of the coefficients."""

import numpy as np

from seatrial.core.results import Curve, Figure
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.published_ship import B53_NOTE
from seatrial_studies.qi2025.print_claims import FIRST_ITERATIONS
from seatrial_studies.qi2025.published import (
    FIGURE_5_TOP,
    FIGURE_6_TOP,
    FIGURES_6_7,
    REBOUND_ITERATIONS,
    SearchAlgorithm,
)
from seatrial_studies.qi2025.reproduction import FIGURE_HEADING, ITERATIONS, SearchSetting, WildHorseReproduction
from seatrial_studies.qi2025.tracking import Tracking
from seatrial_studies.swarm_search import STEP

TIME_LABEL = "t, s"
_ASSUMPTION_NOTE = "45°, 2.27 m, 18 kn. Coefficients assumed: those of 90°; the paper prints none."


# the coefficients of figures 8 to 11, with their units and the power of ten that the tables print
_HISTORY_PAIRS = {
    ("a33", "b33"): (("kg", "kg/s"), 1e5, "10⁵"),
    ("a35", "b35"): (("kg m", "kg m/s"), 1e6, "10⁶"),
    ("a55", "b55"): (("kg m²", "kg m²/s"), 1e8, "10⁸"),
    ("a53", "b53"): (("kg m", "kg m/s"), 1e6, "10⁶"),
}


def figures(reproduction: WildHorseReproduction, tracking: Tracking) -> tuple[Figure, ...]:
    """Figures 1-2, 5, 6-7 and 8-11, at 45 degrees as in the paper."""
    return (
        *_motions(reproduction),
        *_convergence(reproduction),
        *_tracking(reproduction, tracking),
        *_histories(reproduction),
    )


def _motions(reproduction: WildHorseReproduction) -> list[Figure]:
    states = reproduction.seas[FIGURE_HEADING][0].states
    time = np.arange(len(states), dtype=np.float64) * STEP
    heave = Curve("heave, up", time, -states[:, 0])
    pitch = Curve("pitch, bow down", time, -np.degrees(states[:, 2]))
    return [
        Figure("Figure 1: heave", TIME_LABEL, "m", (heave,), f"{_ASSUMPTION_NOTE} The paper's stays within ±0.3 m."),
        Figure("Figure 2: pitch", TIME_LABEL, "deg", (pitch,), f"{_ASSUMPTION_NOTE} The paper's stays within ±0.3°."),
    ]


def _convergence(reproduction: WildHorseReproduction) -> list[Figure]:
    note = {
        SearchSetting.DEGREES: "From the true state before each sample.",
        SearchSetting.MODEL_STATE: "From the identified model's own state.",
    }
    drawn = [_printed_convergence(reproduction)]
    for (setting, said), letter in zip(note.items(), "ab", strict=True):
        histories = {a: reproduction.searches[setting, FIGURE_HEADING, a].best_fitness for a in SearchAlgorithm}
        curves = tuple(
            Curve(str(a), np.arange(len(h), dtype=np.float64), np.log10(np.maximum(h, 1e-12)))
            for a, h in histories.items()
        )
        title, y_label = f"Figure 5{letter}: fitness of the best point", "log10 of the fitness (m and deg)"
        more = (
            "First run. Each iteration judges by a sample of its own: the best rises and falls, as no best so far can."
        )
        drawn.append(Figure(title, "iteration", y_label, curves, f"{said} {more}"))
    return drawn


def _printed_convergence(reproduction: WildHorseReproduction) -> Figure:
    """Return IWHO alone on a linear axis, as the paper draws it."""
    history = reproduction.searches[SearchSetting.MODEL_STATE, FIGURE_HEADING, SearchAlgorithm.IWHO].best_fitness
    curve = Curve("IWHO", np.arange(len(history), dtype=np.float64), history)
    note = (
        f"{SearchSetting.MODEL_STATE.value}; after iteration {FIRST_ITERATIONS} the largest is "
        f"{history[FIRST_ITERATIONS:].max():.4f}. The paper's axis ends at {FIGURE_5_TOP:.3f}, its curve rebounds at "
        f"iterations {REBOUND_ITERATIONS[0]} and {REBOUND_ITERATIONS[1]}. {_ASSUMPTION_NOTE}"
    )
    return Figure("Figure 5: fitness of IWHO", "iteration", "fitness (m and deg)", (curve,), note)


def _tracking(reproduction: WildHorseReproduction, tracking: Tracking) -> list[Figure]:
    data = reproduction.seas[FIGURE_HEADING][0]
    time = np.arange(len(data.states), dtype=np.float64) * STEP
    note = (
        "IWHO's first run: the model is carried on from rest, each sample with the best point of its own iteration, "
        f"from {ITERATIONS * STEP:.0f} s on with the last one. Good tracking says little about the coefficients. "
        "In the paper this is the search of its figure 5; here figure 5 is from the model's own state, this one in the "
        "chosen setting. "
        f"{_ASSUMPTION_NOTE}"
    )
    ranges = (
        f"The paper's stays between -{FIGURES_6_7[0]:.2f} and {FIGURE_6_TOP:.2f} m",
        f"The paper's stays within ±{FIGURES_6_7[1]:.2f}°",
    )
    rows = ((0, 1.0, "Figure 6: heave tracked", "m"), (2, float(np.degrees(1.0)), "Figure 7: pitch tracked", "deg"))
    figures_ = []
    for (state, factor, title, unit), printed in zip(rows, ranges, strict=True):
        observed, identified = (-factor * states[:, state] for states in (data.states, tracking.states))
        curves = (Curve("observed", time, observed), Curve("identified", time, identified))
        figures_.append(Figure(title, TIME_LABEL, unit, curves, f"{printed}. {note}"))
    errors = tracking.states - data.states
    shares = 100.0 * errors / np.sqrt(np.mean(data.states**2, axis=0))
    curves = tuple(Curve(name, time, shares[:, state]) for name, state in (("heave", 0), ("pitch", 2)))
    below = (
        "Identified less observed, in per cent of the rms of the motion: too little to be visible in figures 6 and 7."
    )
    return [*figures_, Figure("Figures 6 and 7: error of tracking", TIME_LABEL, "% of rms", curves, below)]


def _histories(reproduction: WildHorseReproduction) -> list[Figure]:
    """Return figures 8 to 11 in the tables' units over the paper's 200 s; b53 by magnitude, as printed."""
    data = reproduction.seas[FIGURE_HEADING][0]
    found = reproduction.searches[SearchSetting.PAPER, FIGURE_HEADING, SearchAlgorithm.IWHO]
    time = np.arange(len(data.states), dtype=np.float64) * STEP
    rows = np.abs(found.trace[np.minimum(np.arange(len(time)), len(found.trace) - 1)])
    note = (
        "IWHO's first run at 45°, box ±10 % about the truth; coefficients of 90° assumed. The search ends at "
        f"{ITERATIONS * STEP:.0f} s, the figures of the paper at {time[-1]:.0f} s: the last point is kept."
    )
    errors = np.abs(found.errors[0])
    figures_ = []
    for number, (pair, (units, size, power)) in enumerate(_HISTORY_PAIRS.items(), start=8):
        curves = []
        for name, unit in zip(pair, units, strict=True):
            k = COEFFICIENTS.index(name)
            curves.append(Curve(f"{name}, {power} {unit}", time, rows[:, k] / size))
            curves.append(Curve(f"{name}, theory", time, np.full(len(time), abs(found.truth[k]) / size)))
        label = ", ".join(f"{power} {unit}" for unit in units)
        ends = " and ".join(f"{name} {100.0 * errors[COEFFICIENTS.index(name)]:.1f} %" for name in pair)
        said = f"{note} Then {ends} off." + (f" {B53_NOTE}" if "b53" in pair else "")
        figures_.append(Figure(f"Figure {number}: {pair[0]} and {pair[1]}", TIME_LABEL, label, tuple(curves), said))
    return figures_
