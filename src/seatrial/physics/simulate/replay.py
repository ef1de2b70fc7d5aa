"""A record's inputs run through a model: what the model says the ship would have done."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from seatrial.core.equations import Input, Model
from seatrial.core.equations.model import MEASURED, ZERO_BY_DEFAULT
from seatrial.core.values import (
    NOTATION,
    Array,
    Channel,
    DivergedError,
    InputError,
    Provenance,
    Record,
    RecordKind,
    frozen,
    spelling_hint,
)
from seatrial.core.values.arrays import Between
from seatrial.core.values.notation import OPPOSITE
from seatrial.physics.manoeuvres.recognition import TRUE

# Between records and a model's arrays: where inputs take the model's signs, and lose them again.


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


def series_record(
    name: str, dt: float, series: Mapping[str, Array], source: str, like: Mapping[str, str] | None = None
) -> Record:
    """Return series (n,) by symbol, every dt [s] from 0, as a simulated record in the notation table's signs.

    like: symbol of the notation that a series has unit and direction of, where it is not its own.
    """
    kinds = {symbol: symbol for symbol in series} | dict(like or {})
    channels = {symbol: _channel(kinds[symbol], np.ascontiguousarray(values)) for symbol, values in series.items()}
    time = frozen(dt * np.arange(len(next(iter(series.values())))))
    return Record(name, time, channels, RecordKind.SIMULATED, provenance=Provenance(source))


def _channel(symbol: str, values: Array) -> Channel:
    if symbol in NOTATION:
        return Channel.from_notation(symbol, values)
    return Channel(frozen(values), "1", "none", "none")


# When a simulation leaves the world: a sentence that says when, and which channel went first.

# by SI unit: beyond these no ship is believable (and nothing is, beyond 1e9)
_LIMITS_BY_UNIT = {"m": 1e7, "m/s": 150.0, "rad": 1e4, "rad/s": 20.0}
_DEFAULT_LIMIT = 1e9  # of a state in any other unit, as said above


def state_limits(model: Model) -> Array:
    """Return bounds of the states' magnitudes, shape (nx,)."""
    units = [NOTATION[s].unit if s in NOTATION else "" for s in model.states]
    return np.array([_LIMITS_BY_UNIT.get(unit, _DEFAULT_LIMIT) for unit in units])


def first_row_outside(states: Array, limits: Array) -> int | None:
    """Return the first row of states (n, nx) in which one exceeds its limit (nx,) or is NaN; None where none is."""
    largest = np.array([np.abs(column).max(initial=0.0) for column in states.T])
    return None if np.all(largest <= limits) else int(np.argmin(np.all(np.abs(states) <= limits, axis=1)))


def require_bounded(model: Model, time: Array, states: Array, subject: str) -> None:
    """Accept states (n, nx) that stay within their bounds.

    Raises:
        DivergedError: they do not; the first time [s] and channel are named.
    """
    row = first_row_outside(states, state_limits(model))
    if row is None:
        return
    state = model.states[_diverging_state(states, row, state_limits(model))]
    raise DivergedError(
        f"the simulation of {subject} with model '{model.name}' diverges: '{state}' left its bounds at "
        f"t = {time[row]:g} s; check the model's coefficients and initial state, or take a smaller step"
    )


def _diverging_state(states: Array, row: int, bounds: Array) -> int:
    """The state farthest outside at `row`, or the fastest growing one before it where nothing there is finite."""
    here = np.abs(states[row]) / bounds
    if np.isfinite(here).any() and np.nanmax(here) > 1.0:
        return int(np.nanargmax(here))
    return int(np.argmax(np.abs(states[max(row - 1, 0)]) / bounds))


# A command in the loop: it sees the state at the start of each step and sets the inputs until the next.


def commanded(
    model: Model, command: Callable[..., None], memory: Array, dt: float, count: int, start: Array, inputs: Array,
    subject: str,
) -> tuple[Array, Array]:  # fmt: skip
    """Return states (n, nx) and inputs (n, nu) of a model that a command steers for `count` steps of dt [s].

    Steps of an affine model are exact, of another those of Runge and Kutta.
    memory: of the command, which writes in it; start: (nx,); inputs: (nu,), held but for what the command sets.

    Raises:
        DivergedError: the subject runs away; when, and which state.
    """
    from seatrial.numerics.kernels.feedback import steer
    from seatrial.physics.simulate.linear import exact_step

    states, applied = np.empty((count, len(start))), np.empty((count, len(inputs)))
    lost = steer(
        model.compiled.rates, command, start.copy(), inputs, model.parameters.values, memory, dt, states, applied,
        *((exact_step(model, dt),) if model.is_affine else ()),
    )  # fmt: skip
    last = count if lost < 0 else lost + 1
    time = frozen(dt * np.arange(last))
    require_bounded(model, time, states[:last], subject)
    if lost >= 0:
        raise DivergedError(f"{subject} with model '{model.name}' runs away at {time[-1]:g} s")
    return states, applied


# A record's inputs run through a model: what the model says the ship would have done.

ZERO_STARTS = ("x0", "y0", "psi")


def replay(
    model: Model, record: Record, initial: Mapping[str, float] | None = None, substeps: int | None = None
) -> Record:
    """Simulate `model` from the record's inputs: classical Runge-Kutta, inputs linear between samples; exact if affine.

    Args:
        model: all parameters must have values.
        record: its input channels are used, whatever their sign; absent wind channels mean still air.
        initial: state -> value in SI units and notation signs; the others start at the record's first sample where it
            has the channel, x0, y0 and psi otherwise at zero.
        substeps: Runge-Kutta steps, or pieces of a smooth input of an affine model, in each sample; by default as many
            as the motion needs (`steps.sufficient_substeps`).

    Returns:
        A simulated record on the same time base: states, measurable outputs, inputs.

    Raises:
        InputError: an input or an initial state is missing, the time base is uneven, or the simulation diverges.
    """
    inputs = inputs_of(model, record)
    states, outputs = trajectory(model, inputs, record.dt, initial_state(model, record, initial or {}), substeps)
    require_bounded(model, record.time, states, f"record '{record.name}'")
    made = _with_input_course(model, record_of(model, record.name, record.time, states, outputs, inputs))
    step = f"inputs of '{record.name}' replayed through model '{model.name}'"
    return replace(made, provenance=Provenance(record.provenance.source, record.provenance.sha256, (step,)))


def _with_input_course(model: Model, record: Record) -> Record:
    """Return the record with how each input ran between samples, which a simulation knows."""
    runs = {i.name: replace(record.channel(i.name), between=_course(i.is_held)) for i in model.inputs}
    return replace(record, channels={**record.channels, **runs})


def _course(is_held: bool) -> Between:
    return "held" if is_held else "straight"


def trajectory(
    model: Model, inputs: Array, dt: float, start: Array, substeps: int | None = None
) -> tuple[Array, Array]:
    """Return states (n, nx) and outputs (n, ny) from inputs (n, nu) in the model's signs; NaN after a divergence.

    substeps: as of `replay`.

    Raises:
        InputError: a parameter has no value, or `substeps` is less than one.
    """
    from seatrial.physics.simulate.batch import batch_class, error_over_range, sufficient_substeps

    if model.parameters.missing:
        raise InputError(f"model '{model.name}' has no value for {', '.join(model.parameters.missing)}")
    if substeps is not None and substeps < 1:
        raise InputError(f"{substeps} sub-steps are less than one")
    batch = batch_class(model)(model, inputs, np.array([0, len(inputs)]), dt, model.observables)

    @cache
    def simulated(count: int) -> Array:
        one = replace(batch, substeps=count)
        return one.simulate(0, 1, start[None], model.parameters.values[None], np.empty((1, 0)))[0]

    if substeps is None:
        substeps = 1 if model.is_affine else sufficient_substeps(simulated, error_over_range)
    y, nx = simulated(substeps), len(model.states)
    return np.ascontiguousarray(y[:, :nx]), y[:, nx:]


def initial_state(model: Model, record: Record, initial: Mapping[str, float]) -> Array:
    """Return the state at the record's first sample, shape (nx,): given, measured, or zero for the pose.

    Raises:
        InputError: `initial` names no state, a state is neither given nor measured, or its channel is not the model's.
    """
    for name in initial:
        if name not in model.states:
            raise InputError(f"'{name}' is no state of model '{model.name}'{spelling_hint(name, list(model.states))}")
    return np.array([float(initial[s]) if s in initial else _measured_start(model, record, s) for s in model.states])


def _first_slope(record: Record, symbol: str) -> float:
    """Return rate of a channel at its first sample, by a cubic through its first second or five samples."""
    count = min(len(record), max(6, round(1.0 / record.dt)))  # samples at least, a second otherwise; chosen
    time, values = record.time[:count] - record.time[0], record[symbol][:count]
    good = np.isfinite(values)
    if np.count_nonzero(good) < 4:
        raise InputError(f"record '{record.name}': channel '{symbol}' has too few values at its start for a rate")
    return float(np.polynomial.polynomial.polyfit(time[good], values[good], 3)[1])


def _measured_start(model: Model, record: Record, state: str) -> float:
    if state not in record:
        if state in ZERO_STARTS:
            return 0.0
        if state.endswith("_dot") and state.removesuffix("_dot") in record:
            return _first_slope(record, state.removesuffix("_dot"))
        raise InputError(
            f"record '{record.name}' has no channel '{state}', a state of model '{model.name}': give its initial value"
        )
    channel = record.channel(state)
    value = float(channel.values[0])
    if not np.isfinite(value):
        raise InputError(
            f"record '{record.name}': channel '{state}' is empty at the first sample; give its initial value"
        )
    if state not in NOTATION:
        return value
    if channel.frame != NOTATION[state].frame:
        raise InputError(
            f"record '{record.name}': channel '{state}' is {channel.frame}-fixed, model '{model.name}' needs it "
            f"{NOTATION[state].frame}-fixed; turn it first or give its initial value"
        )
    return value if channel.positive == NOTATION[state].positive else -value


def forces(model: Model, record: Record) -> dict[str, Array]:
    """Return every binding of the model (forces, speeds, angles; SI units) at the record's samples: name -> (n,).

    Raises:
        InputError: the record lacks a state or an input of the model.
    """
    absent = [s for s in model.states if s not in record]
    if absent:
        raise InputError(
            f"record '{record.name}' has no channel '{absent[0]}', a state of model '{model.name}'; simulate it first"
        )
    return model.forces(record.matrix(model.states), inputs_of(model, record))
