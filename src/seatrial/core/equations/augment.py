"""A model with more states: disturbances with a memory, biased or lagging sensors. ModelEquations like any others.

A gust is a force of first order (Gauss-Markov; Gelb 1974, section 3.5), given as the acceleration it causes; a bias is
the same on a channel; a lagging channel follows its state with one time constant. What drives them is white noise on
the new states.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from seatrial.core.equations.bindings import Binding, ModelEquations
from seatrial.core.equations.model import Model, stored_equations
from seatrial.core.values import InputError, Parameter, Parameters

if TYPE_CHECKING:
    import sympy as sp

SENSOR_LAG = "sensor_lag"
BIAS_MEMORY = "bias_memory"
DAMPINGS = (0.005, 0.7)
"""Relative damping of waves: from a swell that hardly varies to a band without a peak (zeta = 1 / sqrt 2); chosen."""
MEMORY_PREFIX = "gust_memory_"
WAVE = "wave_"
"""What names of states and parameters of wave forces begin with."""
_FREQUENCY = "_force_frequency"
_BIASED = "_biased"
_SOURCE = "augmented model"
_WAVE_SOURCE = "Saelid, Jenssen & Balchen 1983; Fossen 2011, section 8.2.6"


def gust_name(state: str) -> str:
    """Name of the state that holds a gust's acceleration of `state`."""
    return f"gust_{state}"


def memory_name(state: str) -> str:
    """Name of the parameter that holds the memory of a gust on `state`."""
    return f"{MEMORY_PREFIX}{state}"


def wave_names(state: str, peak: int) -> tuple[str, str]:
    """Names of the states that hold the acceleration of `state` by waves at a peak, integrated and as it is."""
    return f"{WAVE}{peak}_{state}", f"{WAVE}{peak}_rate_{state}"


def band_names(peak: int) -> tuple[str, str]:
    """Names of the parameters that hold frequency and relative damping of wave forces at a peak."""
    return f"{WAVE}{peak}{_FREQUENCY}", f"{WAVE}{peak}_force_damping"


def force_peaks(model: Model) -> int:
    """Return the number of peaks at which waves force the model."""
    return sum(name.endswith(_FREQUENCY) for name in model.parameters.names)


def bias_name(channel: str) -> str:
    """Name of the state that holds a channel's bias."""
    return f"bias_{channel}"


def lagged_name(channel: str) -> str:
    """Name of the state that follows a channel late."""
    return f"{channel}_lagged"


def biased_name(channel: str) -> str:
    """Name of the output that is a channel with its bias."""
    return f"{channel}{_BIASED}"


def is_biased(observable: str) -> bool:
    """Return whether an output is a channel with its bias."""
    return observable.endswith(_BIASED)


def with_gusts(model: Model, memories: Mapping[str, float], shortest: float = 0.0) -> Model:
    """Return the model with accelerations gust_s on states, d(gust_s)/dt = -gust_s / gust_memory_s, the memories free.

    memories: state -> time constant [s], start value; shortest: least of them [s] that a search may reach.

    Raises:
        InputError: the model has one of the new names already.
    """

    def write() -> ModelEquations:
        gusts = {s: _symbol(gust_name(s)) for s in memories}
        rates = [b.bound_to(b.expression + gusts[b.name]) if b.name in gusts else b for b in model.equations.rates]
        rates += [
            Binding.from_expression(str(g), -g / _symbol(memory_name(s)), "Gelb 1974, section 3.5")
            for s, g in gusts.items()
        ]
        return _extended(model, "gusts", rates, new=tuple(map(memory_name, memories)))

    constants = [
        _time_constant(memory_name(s), value, f"memory of gusts on {s}", shortest) for s, value in memories.items()
    ]
    return _augmented(model, ("gusts", *memories), write, *constants)


def with_wave_forces(model: Model, driven: Sequence[str], peak: int, frequency: float, damping: float) -> Model:
    """Return the model with accelerations by waves on states, in a narrow band, frequency and damping free.

    They are the rates xi' of xi'' + 2 zeta omega xi' + omega^2 xi = noise: first-order loads have no mean.

    peak: number of the band, from 1; frequency: omega [rad/s], damping: zeta, start values.

    Raises:
        InputError: the model has one of the new names already.
    """
    names = band_names(peak)

    def write() -> ModelEquations:
        omega, zeta = map(_symbol, names)
        forces = {s: _symbol(wave_names(s, peak)[1]) for s in driven}
        rates = [b.bound_to(b.expression + forces[b.name]) if b.name in forces else b for b in model.equations.rates]
        for s, eta in forces.items():
            xi = _symbol(wave_names(s, peak)[0])
            rates.append(Binding.from_expression(str(xi), eta, _WAVE_SOURCE))
            rates.append(Binding.from_expression(str(eta), -(omega**2) * xi - 2 * zeta * omega * eta, _WAVE_SOURCE))
        return _extended(model, "wave forces", rates, new=names)

    description = f"of the waves' force at peak {peak}"
    band = _time_constant(names[0], frequency, f"frequency {description}"), Parameter(
        names[1], damping, "1", *DAMPINGS, damping, None, True, _SOURCE, f"relative damping {description}", ""
    )  # fmt: skip
    return _augmented(model, (f"wave forces {peak}", *driven), write, *band)


def with_biases(model: Model, channels: Sequence[str], memory: float) -> Model:
    """Return the model with outputs `biased_name(c)`: c as shown + bias_c, d(bias_c)/dt = -bias_c / bias_memory.

    memory: time constant of all biases [s], free, start value.

    Raises:
        InputError: the model has one of the new names already.
    """

    def write() -> ModelEquations:
        biases = {c: _symbol(bias_name(c)) for c in channels}
        rates = [
            *model.equations.rates,
            *(
                Binding.from_expression(str(b), -b / _symbol(BIAS_MEMORY), "Gelb 1974, section 3.5")
                for b in biases.values()
            ),
        ]
        outputs = [
            Binding.from_expression(biased_name(c), _symbol(model.observable_of(c)) + b, _SOURCE)
            for c, b in biases.items()
        ]
        return _extended(model, "biases", rates, outputs, (BIAS_MEMORY,))

    constant = _time_constant(BIAS_MEMORY, memory, f"memory of biases of {', '.join(channels)}")
    return _augmented(model, ("biases", "memory", *channels), write, constant)


def with_lags(model: Model, channels: Sequence[str], lag: float) -> Model:
    """Return the model with states `lagged_name(c)` that follow the states c, all with one free time constant.

    lag: time constant [s], start value.

    Raises:
        InputError: the model has one of the new names already.
    """

    def write() -> ModelEquations:
        symbols = {c: _symbol(model.observable_of(c)) for c in channels}
        late = [(lagged_name(c), (s - _symbol(lagged_name(c))) / _symbol(SENSOR_LAG)) for c, s in symbols.items()]
        followers = [Binding.from_expression(name, rate, _SOURCE) for name, rate in late]
        return _extended(model, "lags", [*model.equations.rates, *followers], new=(SENSOR_LAG,))

    return _augmented(model, ("lags", *channels), write, _time_constant(SENSOR_LAG, lag, "lag of sensors"))


def _symbol(name: str) -> "sp.Symbol":
    import sympy as sp

    return sp.Symbol(name, real=True)


def _time_constant(name: str, value: float, meaning: str, least: float = 0.0) -> Parameter:
    """Free between 0.05 and 200 times its start value: to longer than any run, chosen; not below `least`."""
    low, high = max(0.05 * value, least), 200.0 * value  # as the docstring says; chosen
    return Parameter(name, value, "s", low, high, value, None, True, _SOURCE, meaning, "")


def _extended(
    model: Model, addition: str, rates: Sequence[Binding], outputs: Sequence[Binding] = (), new: tuple[str, ...] = ()
) -> ModelEquations:
    """The equations with these rates, more outputs and new parameters."""
    old, names = model.equations, [b.name for b in (*rates, *outputs)]
    present = {*old.parameters, *old.input_names, *(b.name for b in old.bindings)}
    clash = sorted(present & {*names, *new})
    if clash or len(set(names)) < len(names):
        raise InputError(
            f"model '{model.name}' has a '{(clash or sorted(names))[0]}' already and cannot take {addition}"
        )
    return replace(
        old, name=f"{old.name} with {addition}", rates=tuple(rates), bindings=(*old.bindings, *outputs),
        outputs=(*old.outputs, *(b.name for b in outputs)), parameters=(*old.parameters, *new),
    )  # fmt: skip


def _augmented(model: Model, key: tuple[str, ...], write: Callable[[], ModelEquations], *more: Parameter) -> Model:
    equations = stored_equations((model.equation_hash, *key), write)
    return replace(model, equations=equations, parameters=Parameters((*model.parameters, *more)))
