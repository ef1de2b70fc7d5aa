"""Whether a stream has what its model needs, before anything is started."""

import numpy as np

from seatrial.core.values import Channel, InputError, Record
from seatrial.data.check.conventions import canonical
from seatrial.data.read.assemble import as_declared
from seatrial.data.trial import Role, Trial
from seatrial.data.trial.follow_table import followed
from seatrial.physics.simulate.channels import AT_REST
from seatrial.physics.simulate.states import hidden_states, untold_states

_FORCES = ("F3", "M5")
_STAND_IN = 32


def refuse_lacking(trial: Trial) -> None:
    """Refuse a trial whose [follow] lacks channels that the model needs, all of them named.

    Raises:
        InputError: a file that is one of the trial's records already; which inputs and states are neither there nor
            implied; no channel that the model can be compared with; conventions that cannot be turned into the house's.
    """
    stream, model = followed(trial), trial.model
    where = f"{trial.path}: " if trial.path else ""
    _refuse_twice(trial, where)
    record = _stand_in(trial)
    inputs = [i.name for i in model.inputs if i.name not in record and i.name not in AT_REST]
    if stream.waves is not None:
        inputs += [] if "zeta" in record or set(_FORCES) <= set(record.channels) else ["zeta (or F3 and M5)"]
    hidden = hidden_states(model, [record])
    states = [s for s in untold_states(model, record) if s not in hidden]
    if lacking := [*inputs, *states]:
        raise InputError(
            f"{where}[follow] lacks channels that model '{model.name}' needs: {', '.join(lacking)}; add them to "
            "[follow.channels]"
        )
    if not any(name in record for name in model.observables):
        raise InputError(
            f"{where}[follow] has no channel that model '{model.name}' can be compared with; add one of "
            f"{', '.join(model.observables)} to [follow.channels]"
        )


def _refuse_twice(trial: Trial, where: str) -> None:
    file = followed(trial).file
    for run in trial.runs:
        if file is not None and run.role is not Role.LEAVE_OUT and run.path.resolve() == file.resolve():
            raise InputError(
                f"{where}{file.name} is named under both [[records]] and [follow]; leave it out of the records"
            )


def _stand_in(trial: Trial) -> Record:
    """A record of the stream's channels, at rest, in the house's conventions."""
    stream = followed(trial)
    time = np.arange(_STAND_IN) / stream.rate
    rest = as_declared("stream", stream.layout, time, np.zeros((_STAND_IN, len(stream.layout.columns))))
    record = canonical(rest, trial.reference_point)
    if stream.waves is None or "u" in record:
        return record
    return record.with_channel("u", Channel.of("u", np.full(_STAND_IN, stream.waves.U)))
