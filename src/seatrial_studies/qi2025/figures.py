"""The paper's figures drawn again: motions, convergence, tracking, histories of the coefficients."""

import numpy as np

from seatrial.core.results import Curve, Figure
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.simulate import trajectories
from seatrial_studies.qi2025.published import SearchAlgorithm
from seatrial_studies.qi2025.reproduction import FIGURE_HEADING, SearchSetting, WildHorseReproduction
from seatrial_studies.swarm_search import STEP, candidate_matrices

TIME_LABEL = "t, s"
_ASSUMPTION_NOTE = "45°, 2.27 m, 18 kn. Coefficients assumed: those of 90°; the paper prints none."


def figures(reproduction: WildHorseReproduction) -> tuple[Figure, ...]:
    """Figures 1-2, 5, 6-7 and 8-11, at 45 degrees as in the paper."""
    return (*_motions(reproduction), *_convergence(reproduction), *_tracking(reproduction), *_histories(reproduction))


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
        SearchSetting.MODEL_STATE: "From the identified model's own state: the size of the paper's figure, which ends "
        "at 0.010.",
    }
    drawn = []
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


def _tracking(reproduction: WildHorseReproduction) -> list[Figure]:
    data = reproduction.seas[FIGURE_HEADING][0]
    found = reproduction.searches[SearchSetting.PAPER, FIGURE_HEADING, SearchAlgorithm.IWHO]
    A, B = candidate_matrices(found.points[:1])
    y = trajectories(A, B, data.forcing, np.zeros(4))[0]
    time = np.arange(len(y), dtype=np.float64) * STEP
    note = (
        f"IWHO's first run, open loop from rest. Good tracking says little about the coefficients. {_ASSUMPTION_NOTE}"
    )
    pairs = ((0, 0, 1.0, "Figure 6: heave tracked", "m"), (1, 2, 57.29578, "Figure 7: pitch tracked", "deg"))
    drawn = []
    for j, state, factor, title, unit in pairs:
        ship, identified = -factor * data.states[:, state], -factor * y[:, j]
        drawn.append(
            Figure(title, TIME_LABEL, unit, (Curve("ship", time, ship), Curve("identified", time, identified)), note)
        )
    return drawn


def _histories(reproduction: WildHorseReproduction) -> list[Figure]:
    found = reproduction.searches[SearchSetting.PAPER, FIGURE_HEADING, SearchAlgorithm.IWHO]
    time = np.arange(len(found.trace), dtype=np.float64) * STEP
    errors = 100.0 * (found.trace / found.truth - 1.0)
    drawn = []
    for number, pair in enumerate((("a33", "b33"), ("a35", "b35"), ("a55", "b55"), ("a53", "b53")), start=8):
        curves = tuple(Curve(name, time, errors[:, COEFFICIENTS.index(name)]) for name in pair)
        title = f"Figure {number}: {pair[0]} and {pair[1]}"
        note = "IWHO's first run at 45°, box ±10 % about the truth; coefficients of 90° assumed."
        drawn.append(Figure(title, TIME_LABEL, "error, %", curves, note))
    return drawn
