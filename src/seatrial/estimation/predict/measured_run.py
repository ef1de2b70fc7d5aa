"""A measured run by a model that was fitted before: start from its first seconds, inputs corrected as in the fit."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import SessionOffset
from seatrial.core.values import InputError, Prior, Record
from seatrial.data.check import sample_noise
from seatrial.estimation.estimate.integration_steps import with_steps_of_start
from seatrial.estimation.estimate.settings import INITIAL_STATE_SHIP_LENGTHS
from seatrial.estimation.estimate.time_scale import characteristic_time
from seatrial.estimation.predict.open_loop import simulate_open_loop
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import compared_outputs, cut_segments
from seatrial.physics.simulate.batch import InputCorrection

_START_SHARE = 0.1  # of a run, whose beginning shows its initial state where the ship's length is not known; chosen
_LEAST_NOISE = 1e-6  # of a channel's largest value: one without noise is no better known; chosen
_ANY_DEVIATION = 1.0  # SI, of an offset that is known: none is estimated, and it counts nothing
_SMALLEST = 1e-12  # SI, noise of a channel that is zero throughout; chosen


def simulate_measured(
    model: Model, record: Record, length: float, offsets: Sequence[SessionOffset] = (), session: str | None = None
) -> tuple[Record, float]:
    """Return the run simulated from its inputs, and the seconds of it that its initial state is estimated from.

    Args:
        length: of the ship, m; 0 where it is not known.
        offsets: of the fit, with which the logged inputs are corrected.
        session: that the run belongs to; None as `SessionOffset.value_in`.

    Raises:
        InputError: an input is missing, the time base is uneven, the session is unknown, or the simulation diverges.
    """
    seconds = _start_seconds(model, record, length)
    values = np.array([offset.value_in(session) for offset in offsets])
    template = _template(model, record, offsets)
    template = with_steps_of_start(template, values, template.measured_initial_states())
    return simulate_open_loop(template, model, record, values, seconds).record, seconds


def _template(model: Model, record: Record, offsets: Sequence[SessionOffset]) -> OutputError:
    """The problem whose unknowns of a session are these offsets, weighted by the noise of the record's samples."""
    outputs = compared_outputs(model, [record])
    noise = [
        np.nanmax(
            [sample_noise(record.channel(name).readings), _LEAST_NOISE * np.nanmax(np.abs(record[name])), _SMALLEST]
        )
        for name in outputs
    ]
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    known = {offset.name: Prior(offset.expected, _ANY_DEVIATION, "of the fit, and held") for offset in offsets}
    own = [offset for offset in offsets if offset.name in model.parameters]
    corrections = [offset for offset in offsets if offset.name not in model.parameters]
    return OutputError(
        held,
        cut_segments(held, [record], outputs, None),
        np.array(noise),
        tuple(
            Nuisance(InputCorrection(*correction.correction), known[correction.name], correction.unit)
            for correction in corrections
        ),
        tuple((one.name, known[one.name]) for one in own),
    )


def _start_seconds(model: Model, record: Record, length: float) -> float:
    try:
        seconds = INITIAL_STATE_SHIP_LENGTHS * characteristic_time(model, [record], length)
    except InputError:  # neither speed nor positions were recorded
        seconds = 0.0
    return seconds or _START_SHARE * record.duration
