"""Between records and a model's arrays: where inputs take the model's signs, and lose them again."""

import numpy as np

from seatrial.core.equations import Input, Model
from seatrial.core.equations.model import MEASURED
from seatrial.core.values import NOTATION, Array, Channel, InputError, Record, RecordKind, frozen
from seatrial.core.values.notation import OPPOSITE
from seatrial.physics.manoeuvres.own_motion import TRUE

ZERO_BY_DEFAULT = ("wind_speed", "wind_direction", "F3", "M5", "delta_f1", "delta_f2", "alpha_w", "alpha_f")


def inputs_of(model: Model, record: Record) -> Array:
    """Inputs in the model's own signs, shape (n, nu); absent wind, waves and fins are at rest.

    A channel whose positive direction is the opposite of the input's is turned.

    Raises:
        InputError: an input channel is missing, holds NaN, or points in a direction that has nothing to do with the
            model's.
    """
    require_inputs(model, record)
    columns = [_input_values(model, record, item) for item in model.inputs]
    return np.ascontiguousarray(np.stack(columns, axis=1)) if columns else np.empty((len(record), 0))


def require_inputs(model: Model, record: Record) -> None:
    """Raise for a record without a channel of an input of the model.

    Raises:
        InputError: the first input that the record lacks and that is not zero by default.
    """
    for item in model.inputs:
        if item.name not in record and item.name not in ZERO_BY_DEFAULT:
            raise InputError(
                f"record '{record.name}' has no channel '{item.name}', an input of model '{model.name}'; add it "
                "to the channels, or choose another model"
            )


def _input_values(model: Model, record: Record, item: Input) -> Array:
    if item.name not in record:
        return np.zeros(len(record))
    channel = record.channel(item.name)
    if not np.all(np.isfinite(channel.values)):
        row = int(np.argmin(np.isfinite(channel.values)))
        raise InputError(
            f"record '{record.name}': input channel '{item.name}' has no value at sample {row} "
            f"(t = {record.time[row]:g} s); repair it first"
        )
    if item.direction in (channel.positive, "none"):
        return channel.values
    if OPPOSITE.get(item.direction) == channel.positive:
        return -channel.values
    raise InputError(
        f"record '{record.name}': input channel '{item.name}' is positive to '{channel.positive}', "
        f"model '{model.name}' has it positive to '{item.direction}'; declare one of the two directions"
    )


def record_of(
    model: Model,
    name: str,
    time: Array,
    states: Array,
    outputs: Array,
    inputs: Array,
    kind: RecordKind = RecordKind.SIMULATED,
) -> Record:
    """States, measurable outputs and inputs (model's signs) as a record in the notation table's signs.

    Of a model with sensors a channel is what its instrument shows; the state itself has `_true` behind its name.
    """
    shown = {s: s if model.observable_of(s) == s else f"{s}{TRUE}" for s in model.states}
    channels = {shown[s]: _channel(s, states[:, i]) for i, s in enumerate(model.states)}
    for i, output in enumerate(model.outputs):
        channel = output.removesuffix(MEASURED)
        channels[channel] = _channel(channel, outputs[:, i])
    for j, item in enumerate(model.inputs):
        channels[item.name] = _channel(item.name, -inputs[:, j] if item.is_reversed else inputs[:, j])
    return Record(name, frozen(time), channels, kind)


def _channel(symbol: str, values: Array) -> Channel:
    if symbol in NOTATION:
        return Channel.from_notation(symbol, values)
    return Channel(frozen(values), "1", "none", "none")
