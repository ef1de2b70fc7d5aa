"""Waves that nobody measured: a fit that takes their motions for the ship's response to something else is refused."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values import NOTATION, InputError, Record, display_unit
from seatrial.estimation.estimate.criterion_choice import WAVE_FORCES
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.settings import WHITE_INFLATION


def refuse_unmeasured_waves(estimation: Estimation, records: Sequence[Record]) -> None:
    """Refuse records without any wave force whose motions the other inputs do not explain.

    Unmeasured waves lie in the band of the ship's own motions: as process noise they make coefficients several times
    too large, with small errors.

    Raises:
        InputError: how much is left unexplained, and what to give.
    """
    forces = [name for name in WAVE_FORCES if name in estimation.model.input_names]
    if not forces or any(name in record for name in forces for record in records):
        return
    if np.max(estimation.inflation) <= WHITE_INFLATION and not estimation.has_process_noise:
        return
    problem = estimation.shooting.problem
    remaining = np.sqrt(np.nanmean(estimation.shooting.residuals() ** 2, axis=0))
    moved = np.nanstd(problem.data.measured, axis=0)
    unexplained = [
        _residual_text(channel, r, m) for channel, r, m in zip(problem.data.outputs, remaining, moved, strict=True)
    ]
    raise InputError(
        f"the ship moves although no wave is recorded: the model leaves {' and '.join(unexplained)} unexplained; "
        "give the elevation zeta with [excitation], or F3 and M5, or the sea under [records.waves], "
        "or record in calm water"
    )


def _residual_text(channel: str, residual: float, motion: float) -> str:
    factor, unit = display_unit(NOTATION[channel].unit)
    return f"{residual * factor:.2g} of {motion * factor:.2g} {unit} of {NOTATION[channel].meaning}"
