"""Records and settings put together as an output-error problem."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Prior, Record
from seatrial.estimation.estimate.settings import Settings
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import compared_outputs, cut_segments
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.physics.simulate.batch import InputCorrection


def _nuisances(settings: Settings) -> tuple[Nuisance, ...]:
    return tuple(
        Nuisance(InputCorrection(i, kind), Prior(1.0 if kind == "gain" else 0.0, spread, "house default"), unit)
        for i, kind, spread, unit in settings.corrections
    )


def _current_priors(settings: Settings) -> tuple[tuple[str, Prior], ...]:
    if settings.current <= 0:
        return ()
    prior = Prior(0.0, settings.current, "house default")
    return (("current_north", prior), ("current_east", prior))


def output_error_problem(
    model: Model, records: Sequence[Record], sessions: Sequence[str], seconds: float, settings: Settings
) -> OutputError:
    """The records in segments of `seconds` (infinite: whole runs); each channel's noise a tenth of its spread.

    Beside them stand the settings' force points and other data.

    Raises:
        InputError: outputs that cannot be compared, time steps that differ, a record of fewer than three samples, or
            force points that the model cannot be compared with.
    """
    outputs = compared_outputs(model, records, settings.channels)
    data = cut_segments(model, records, outputs, None if np.isinf(seconds) else seconds, sessions)
    spread = np.nanstd(data.measured, axis=0)
    others = (*(StaticForces(model, points) for points in settings.forces), *settings.extra_terms)
    return OutputError(model, data, np.maximum(0.1 * spread, 1e-9), _nuisances(settings), _current_priors(settings),
                       substeps=settings.substeps, workers=settings.workers, extra_terms=others)  # fmt: skip
