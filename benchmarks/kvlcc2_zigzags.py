"""KVLCC2 from twelve zigzags, the thirteenth and the 35 deg turns predicted: the published benchmark repeated.

Records from SEATRIAL_DATA; without them there are no lines. `seatrial reproduce alexandersson2022` shows all of it.
"""

import os

import numpy as np
from measure import Line, at_most

from seatrial_studies.alexandersson2022 import study
from seatrial_studies.study_file import read_study

LIMIT_DEG, LIMIT_M = 10.0, 7.0


def run() -> list[Line]:
    """Errors of the validation run, whole and open loop, and of the runs left out."""
    if not os.environ.get("SEATRIAL_DATA"):
        return []
    first, *others = study(quick=False, seed=0, report_progress=None).predictions
    limits = read_study("alexandersson2022").limits
    heading, position = (float(np.mean([p.rms[key] for p in others])) for key in ("psi_deg", "position_m"))
    return [
        at_most("Z_35_05 left out, 210 s open loop: heading", first.rms["psi_deg"], "deg", LIMIT_DEG),
        at_most("Z_35_05 left out, 210 s open loop: position", first.rms["position_m"], "m", LIMIT_M),
        Line("the published code on the same run, best setting: heading", limits["best_rerun_heading"], "deg"),
        Line("the published code on the same run, best setting: position", limits["best_rerun_position"], "m"),
        Line("twelve runs left out one at a time: heading", heading, "deg"),
        Line("twelve runs left out one at a time: position", position, "m"),
    ]
