"""Whether a stream has the channels its model needs, checked before anything is started."""

import numpy as np

from seatrial.core.values import Channel, InputError, Record
from seatrial.data.check.conventions import canonical_record
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial import Role, Trial
from seatrial.data.trial.runs import require_stream
from seatrial.physics.simulate.replay import ZERO_BY_DEFAULT
from seatrial.physics.simulate.states import hidden_states, unobserved_states

_WAVE_FORCES = ("F3", "M5")
# samples of the record that stands for the stream: enough for every check of a record
_REST_SAMPLES = 32


def check_required_channels(trial: Trial) -> None:
    """Refuse a trial whose [follow] lacks channels that the model needs, all of them named.

    Raises:
        InputError: the file is one of the trial's records already; inputs and states that are neither recorded nor
            implied; no channel that the model can be compared with; conventions that cannot be converted.
    """
    stream, model = require_stream(trial), trial.model
    where = f"{trial.path}: " if trial.path else ""
    _check_not_a_record(trial, where)
    record = rest_record(trial)
    inputs = [i.name for i in model.inputs if i.name not in record and i.name not in ZERO_BY_DEFAULT]
    if stream.waves is not None:
        inputs += [] if "zeta" in record or set(_WAVE_FORCES) <= set(record.channels) else ["zeta (or F3 and M5)"]
    hidden = hidden_states(model, [record])
    states = [s for s in unobserved_states(model, record) if s not in hidden]
    if missing := [*inputs, *states]:
        raise InputError(
            f"{where}[follow] lacks channels that model '{model.name}' needs: {', '.join(missing)}; add them to "
            "[follow.channels]"
        )
    if not any(name in record for name in model.observables):
        raise InputError(
            f"{where}[follow] has no channel that model '{model.name}' can be compared with; add one of "
            f"{', '.join(model.observables)} to [follow.channels]"
        )


def _check_not_a_record(trial: Trial, prefix: str) -> None:
    file = require_stream(trial).file
    for run in trial.runs:
        if file is None or run.file is None or run.role is Role.LEAVE_OUT:
            continue
        if run.file.path.resolve() == file.resolve():
            raise InputError(
                f"{prefix}{file.name} is named under both [[records]] and [follow]; leave it out of the records"
            )


def rest_record(trial: Trial) -> Record:
    """Return a record of the stream's channels, all zero, in canonical conventions."""
    stream = require_stream(trial)
    time = np.arange(_REST_SAMPLES) / stream.rate
    rest = record_from_values("stream", stream.layout, time, np.zeros((_REST_SAMPLES, len(stream.layout.columns))))
    record = canonical_record(rest, trial.reference_point)
    if stream.waves is None or "u" in record:
        return record
    return record.with_channel("u", Channel.from_notation("u", np.full(_REST_SAMPLES, stream.waves.U)))
