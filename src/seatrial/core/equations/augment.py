"""A model with more states: gusts with a memory, biased or lagging sensors. Equations like any others.

A gust is a force of first order (Gauss-Markov; Gelb 1974, section 3.5) given as the acceleration it causes; a bias is
a random walk on a channel; a lagging channel follows its state with one time constant. What drives them is white noise
on the new states.
"""

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from seatrial.core.equations.bindings import Binding
from seatrial.core.equations.model import Model
from seatrial.core.values import InputError, Parameter, Parameters

GUST_MEMORY, SENSOR_LAG = "gust_memory", "sensor_lag"
_SOURCE = "augmented model"


def gust_name(state: str) -> str:
    """Name of the state that holds a gust's acceleration of `state`."""
    return f"gust_{state}"


def bias_name(channel: str) -> str:
    """Name of the state that holds a channel's bias."""
    return f"bias_{channel}"


def lagged_name(channel: str) -> str:
    """Name of the state that follows a channel late."""
    return f"{channel}_lagged"


def biased_name(channel: str) -> str:
    """Name of the output that is a channel with its bias."""
    return f"{channel}_biased"


def with_gusts(model: Model, states: Sequence[str], memory: float) -> Model:
    """Accelerations gust_s on `states`, all with one free time constant [s]: d(gust_s)/dt = -gust_s / memory."""
    own = {s: _symbol(gust_name(s)) for s in states}
    rates = [replace(b, expression=b.expression + own.get(b.name, 0)) for b in model.equations.rates]
    rates += [Binding(str(g), -g / _symbol(GUST_MEMORY), _SOURCE, "1") for g in own.values()]
    return _augmented(model, "gusts", rates, (_time_constant(GUST_MEMORY, memory, "memory of gusts"),))


def with_biases(model: Model, channels: Sequence[str]) -> Model:
    """Outputs `biased(c)` = c + bias_c for states c, the biases being random walks."""
    rates = [*model.equations.rates, *(Binding(bias_name(c), sp.Float(0.0), _SOURCE) for c in channels)]
    outputs = [Binding(biased_name(c), _symbol(c) + _symbol(bias_name(c)), _SOURCE) for c in channels]
    return _augmented(model, "biases", rates, (), outputs)


def with_lags(model: Model, channels: Sequence[str], lag: float) -> Model:
    """States `lagged(c)` that follow the states c with one free time constant [s]."""
    rates = [*model.equations.rates]
    rates += [
        Binding(lagged_name(c), (_symbol(c) - _symbol(lagged_name(c))) / _symbol(SENSOR_LAG), _SOURCE) for c in channels
    ]
    return _augmented(model, "lags", rates, (_time_constant(SENSOR_LAG, lag, "lag of sensors"),))


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


def _time_constant(name: str, value: float, meaning: str) -> Parameter:
    return Parameter(name, value, "s", 0.05 * value, 200.0 * value, value, None, True, _SOURCE, meaning, "")


def _augmented(
    model: Model,
    label: str,
    rates: Sequence[Binding],
    new_parameters: tuple[Parameter, ...],
    outputs: Sequence[Binding] = (),
) -> Model:
    old, names = model.equations, [b.name for b in (*rates, *outputs)]
    taken = {*old.parameters, *old.input_names, *(b.name for b in old.bindings)}
    clash = sorted(taken & {*names, *(p.name for p in new_parameters)})
    if clash or len(set(names)) < len(names):
        raise InputError(f"model '{model.name}' has a '{(clash or sorted(names))[0]}' already and cannot take {label}")
    parameters = Parameters((*model.parameters, *new_parameters))
    equations = replace(
        old, name=f"{old.name} with {label}", rates=tuple(rates), bindings=(*old.bindings, *outputs),
        outputs=(*old.outputs, *(b.name for b in outputs)), parameters=parameters.names,
    )  # fmt: skip
    return Model(equations, parameters)
