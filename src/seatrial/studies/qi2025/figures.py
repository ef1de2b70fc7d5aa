"""The paper's figures drawn again: motions, convergence, tracking, histories of the coefficients."""

import numpy as np

from seatrial.models.heave_pitch import COEFFICIENTS
from seatrial.results import Curve, Figure
from seatrial.simulate.population import trajectories
from seatrial.studies.qi2025.audit import Audit
from seatrial.studies.qi2025.published import Algorithm
from seatrial.studies.qi2025.repetition import Repetition, Setting
from seatrial.studies.swarm_search import STEP, heave_pitch_candidates

TIME = "t, s"


def figures(made: Repetition, audited: Audit) -> tuple[Figure, ...]:
    """Figures 1-2, 5, 6-7 and 8-11."""
    return (*_motions(audited), _convergence(made), *_tracking(made), *_histories(made))


def _motions(audited: Audit) -> list[Figure]:
    states = audited.theory_45.states
    time = np.arange(len(states), dtype=np.float64) * STEP
    note = "45\u00b0, 2.27 m, 18 kn. Coefficients assumed: those of 90\u00b0; the paper prints none."
    heave = Curve("heave, up", time, -states[:, 0])
    pitch = Curve("pitch, bow down", time, -np.degrees(states[:, 2]))
    return [
        Figure("Figure 1: heave at 45\u00b0", TIME, "m", (heave,), f"{note} The paper's stays within \u00b1.3 m."),
        Figure(
            "Figure 2: pitch at 45\u00b0", TIME, "deg", (pitch,), f"{note} The paper's stays within \u00b1.3\u00b0."
        ),
    ]


def _convergence(made: Repetition) -> Figure:
    curves = []
    for a in Algorithm:
        history = made.searches[Setting.PAPER, 135, a].history
        curves.append(Curve(str(a), np.arange(len(history), dtype=np.float64), np.log10(np.maximum(history, 1e-12))))
    note = (
        "First run at 135\u00b0. Each iteration judges by a sample of its own, so that the best value rises and falls "
        "with "
        "the sample: no best-so-far could rebound as the paper's does at iterations 50 and 150."
    )
    return Figure("Figure 5: fitness", "iteration", "log10 of the fitness (m and rad)", tuple(curves), note)


def _tracking(made: Repetition) -> list[Figure]:
    data = made.seas[135][0]
    found = made.searches[Setting.PAPER, 135, Algorithm.IWHO]
    A, B = heave_pitch_candidates(found.points[:1])
    y = trajectories(A, B, data.forcing, np.zeros(4))[0]
    time = np.arange(len(y), dtype=np.float64) * STEP
    note = "IWHO's first run at 135\u00b0 open loop from rest. Good tracking says little about the coefficients."
    pairs = ((0, 0, 1.0, "Figure 6: heave tracked", "m"), (1, 2, 57.29578, "Figure 7: pitch tracked", "deg"))
    made_figures = []
    for j, state, factor, title, unit in pairs:
        sailed, found_ = -factor * data.states[:, state], -factor * y[:, j]
        lines = (Curve("ship", time, sailed), Curve("identified", time, found_))
        made_figures.append(Figure(title, TIME, unit, lines, note))
    return made_figures


def _histories(made: Repetition) -> list[Figure]:
    found = made.searches[Setting.PAPER, 135, Algorithm.IWHO]
    iterations = np.arange(len(found.trace), dtype=np.float64) * STEP
    made_figures = []
    for number, pair in enumerate((("a33", "b33"), ("a35", "b35"), ("a55", "b55"), ("a53", "b53")), start=8):
        curves = []
        for name in pair:
            j = COEFFICIENTS.index(name)
            curves.append(Curve(name, iterations, 100.0 * (found.trace[:, j] / found.truth[j] - 1.0)))
        title = f"Figure {number}: {pair[0]} and {pair[1]}"
        made_figures.append(Figure(title, TIME, "error, %", tuple(curves), "IWHO's first run at 135\u00b0."))
    return made_figures
