"""What the stated stiffness of a box hull decides: its wave forces grow with it, and so does every coefficient.

Forces of `BoxHull` are proportional to c33, c35, c53 and c55 together. Were all four larger by one factor, the motions
would stay the same if masses, dampings and lifts were larger by it too; so a change of stiffness and forces does to the
outputs what the opposite change of all the others does.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Symmetry
from seatrial.core.values import Array
from seatrial.data.trial import Trial
from seatrial.estimation.information.symmetry_text import join_names
from seatrial.physics.hydro.excitation import BoxHull
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS, HEAVE_PITCH_STIFFNESSES

_OWN_INERTIA = {"a33": "m", "a55": "I5"}
_LIFTS = ("lift_1", "lift_2")


def stands_on_box(trial: Trial) -> bool:
    """Return whether wave forces of the trial are those of a box with the stated stiffness."""
    return any(run.waves is not None and isinstance(run.waves.excitation, BoxHull) for run in trial.runs)


@dataclass(frozen=True)
class BoxScale:
    """One factor of stiffness and wave forces.

    Attributes:
        stiffness: stated values other than zero.
        resisting: what is as large as these forces too: masses, dampings, lifts; held: those of them that are fixed.
    """

    stiffness: tuple[str, ...]
    resisting: tuple[str, ...]
    held: tuple[str, ...]

    def changes(
        self, changes: Mapping[str, Array], place: Mapping[str, int], values: Array, step: float
    ) -> dict[str, Array]:
        """Return assumed changes with one of the stiffness, and the forces with it, for those of each stiffness.

        changes: name -> (n,); place: parameter -> position in `values`, (n,); step: relative.
        """
        together = np.zeros(len(values))
        for name in self.resisting:
            together[place[name]] = -step * values[place[name]]
        rest = {name: change for name, change in changes.items() if name not in self.stiffness}
        return {f"{join_names(self.stiffness)} with the forces of the box": together, **rest}

    def symmetry(self, model: Model, outputs: tuple[str, ...]) -> Symmetry | None:
        """Return what no record can show where waves alone move the craft; None where fins of known lift do too."""
        if any(model.parameters[name].free or model.parameters[name].value for name in _LIFTS):
            return None
        change = dict.fromkeys(self.stiffness, 1.0)
        for name in (n for n in self.resisting if n in HEAVE_PITCH_COEFFICIENTS):
            own = model.parameters[_OWN_INERTIA[name]].value if name in _OWN_INERTIA else 0.0
            value = model.parameters[name].value
            change[name] = 1.0 + own / value if value else 1.0
        sums = (f"{own} + {name}" for name, own in _OWN_INERTIA.items() if name in change)
        alone = [n for n in self.resisting if n in HEAVE_PITCH_COEFFICIENTS and n not in _OWN_INERTIA]
        text = (
            f"{join_names([*self.stiffness, *sums, *alone])} can all be scaled together by one common factor, and the "
            f"wave forces of the box with them, without any change of {join_names(outputs, 'or')}: the stated "
            "stiffness sets the size of every coefficient; state it from the hydrostatics of the hull"
        )
        return Symmetry(tuple(change), text, change)


def box_scale(model: Model) -> BoxScale | None:
    """Return the factor of a model of heave and pitch whose stiffness is stated; None where it is estimated."""
    parameters = model.parameters
    if not {*HEAVE_PITCH_STIFFNESSES, *HEAVE_PITCH_COEFFICIENTS, "m", "I5"} <= {p.name for p in parameters}:
        return None
    if any(parameters[name].free for name in HEAVE_PITCH_STIFFNESSES):
        return None
    resisting = (*HEAVE_PITCH_COEFFICIENTS, "m", "I5", *(n for n in _LIFTS if n in {p.name for p in parameters}))
    resisting = tuple(n for n in resisting if parameters[n].free or parameters[n].value)
    stiffness = tuple(n for n in HEAVE_PITCH_STIFFNESSES if parameters[n].value)
    return BoxScale(stiffness, resisting, tuple(n for n in resisting if not parameters[n].free))
