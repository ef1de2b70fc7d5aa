"""Lasso on the regressors as section 1.3.1 prints them: raw products of u, v, r on the forces X_H, Y_H, N_H."""

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.estimation.regress import Lasso, RegressionSystem
from seatrial.physics.models import with_candidate_terms
from seatrial.physics.simulate import forces
from seatrial_studies.song2025.craft_models import TRUTH
from seatrial_studies.song2025.published import MotionEquation

_TERMS = {
    MotionEquation.SURGE: ("X_uu", "X_vv", "X_rr"),
    MotionEquation.SWAY: ("Y_v", "Y_r", "Y_vv", "Y_vr", "Y_rr"),
    MotionEquation.YAW: ("N_v", "N_r", "N_rr", "N_vvr", "N_vrr"),
}
_FORCES = {MotionEquation.SURGE: "X_H", MotionEquation.SWAY: "Y_H", MotionEquation.YAW: "N_H"}


def printed_systems(record: Record) -> tuple[RegressionSystem, ...]:
    """Return X_H, Y_H, N_H against [u², v², r²], [v, r, v|v|, |v|r, r|r|] and [v, r, r|r|, v²r, vr²].

    None of the products has the speed U of eq. (14) beside it.
    """
    u, v, r = (record[c] for c in "uvr")
    columns: dict[MotionEquation, tuple[Array, ...]] = {
        MotionEquation.SURGE: (u**2, v**2, r**2),
        MotionEquation.SWAY: (v, r, v * np.abs(v), np.abs(v) * r, r * np.abs(r)),
        MotionEquation.YAW: (v, r, r * np.abs(r), v**2 * r, v * r**2),
    }
    hull = forces(with_candidate_terms(TRUTH.craft()), record)
    return tuple(
        RegressionSystem((equation,), _TERMS[equation], np.stack(columns[equation], axis=1), hull[_FORCES[equation]])
        for equation in MotionEquation
    )


def lasso_choice(record: Record, *, is_scaled: bool) -> tuple[tuple[str, ...], tuple[str, ...], dict[str, float]]:
    """Return the terms kept, those taken out, and the penalty by equation."""
    kept, dropped, penalties = list[str](), list[str](), dict[str, float]()
    for system in printed_systems(record):
        solved = Lasso(is_scaled=is_scaled).solve(system)
        penalties[system.title] = solved.settings["penalty"]
        for name, value in zip(system.names, solved.coefficients, strict=True):
            (kept if value != 0.0 else dropped).append(name)
    return tuple(kept), tuple(dropped), penalties
