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

MEMORY, LAG = "gust_memory", "sensor_lag"
_SOURCE = "augmented model"


def gust_of(state: str) -> str:
    """Name of the state that holds a gust's acceleration of `state`."""
    return f"gust_{state}"


def bias_of(channel: str) -> str:
    """Name of the state that holds a channel's bias."""
    return f"bias_{channel}"


def lagged(channel: str) -> str:
    """Name of the state that follows a channel late."""
    return f"{channel}_lagged"


def biased(channel: str) -> str:
    """Name of the output that is a channel with its bias."""
    return f"{channel}_biased"


def with_gusts(model: Model, states: Sequence[str], memory: float) -> Model:
    """Accelerations gust_s on `states`, all with one free time constant [s]: d(gust_s)/dt = -gust_s / memory."""
    own = {s: _symbol(gust_of(s)) for s in states}
    rates = [replace(b, expression=b.expression + own.get(b.name, 0)) for b in model.equations.rates]
    rates += [Binding(str(g), -g / _symbol(MEMORY), _SOURCE, "1") for g in own.values()]
    return _with(model, "gusts", rates, (_time_constant(MEMORY, memory, "memory of gusts"),))


def with_biases(model: Model, channels: Sequence[str]) -> Model:
    """Outputs `biased(c)` = c + bias_c for states c, the biases being random walks."""
    rates = [*model.equations.rates, *(Binding(bias_of(c), sp.Float(0.0), _SOURCE) for c in channels)]
    outputs = [Binding(biased(c), _symbol(c) + _symbol(bias_of(c)), _SOURCE) for c in channels]
    return _with(model, "biases", rates, (), outputs)


def with_lags(model: Model, channels: Sequence[str], lag: float) -> Model:
    """States `lagged(c)` that follow the states c with one free time constant [s]."""
    rates = [*model.equations.rates]
    rates += [Binding(lagged(c), (_symbol(c) - _symbol(lagged(c))) / _symbol(LAG), _SOURCE) for c in channels]
    return _with(model, "lags", rates, (_time_constant(LAG, lag, "lag of sensors"),))


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


def _time_constant(name: str, value: float, meaning: str) -> Parameter:
    return Parameter(name, value, "s", 0.05 * value, 200.0 * value, value, None, True, _SOURCE, meaning, "")


def _with(
    model: Model, what: str, rates: Sequence[Binding], more: tuple[Parameter, ...], outputs: Sequence[Binding] = ()
) -> Model:
    old, names = model.equations, [b.name for b in (*rates, *outputs)]
    taken = {*old.parameters, *old.input_names, *(b.name for b in old.bindings)}
    clash = sorted(taken & {*names, *(p.name for p in more)})
    if clash or len(set(names)) < len(names):
        raise InputError(f"model '{model.name}' has a '{(clash or sorted(names))[0]}' already and cannot take {what}")
    parameters = Parameters((*model.parameters, *more))
    equations = replace(
        old, name=f"{old.name} with {what}", rates=tuple(rates), bindings=(*old.bindings, *outputs),
        outputs=(*old.outputs, *(b.name for b in outputs)), parameters=parameters.names,
    )  # fmt: skip
    return Model(equations, parameters)
