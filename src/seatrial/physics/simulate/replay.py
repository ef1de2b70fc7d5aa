"""A record's inputs run through a model: what the model says the ship would have done."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Array, InputError, Provenance, Record, spelling_hint
from seatrial.core.values.between import Between
from seatrial.physics.simulate.channels import inputs_of, record_of
from seatrial.physics.simulate.divergence import require_bounded
from seatrial.physics.simulate.linear import batch_class
from seatrial.physics.simulate.steps import is_within_range, sufficient_substeps

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
        substeps = 1 if model.is_affine else sufficient_substeps(simulated, is_within_range)
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
