"""The straight run before a manoeuvre: inputs that are held, the steady speed, the time to travel one's own length."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record, spelling_hint
from seatrial.physics.simulate.actuators import settled_actuators
from seatrial.physics.simulate.channels import ZERO_BY_DEFAULT, inputs_of

RUDDER = "delta"
_MAX_SPEED = 100.0  # m/s; guards against a wrong unit
_SEARCHED = np.geomspace(1e-3, 1e3, 121)  # propulsion over speed, m/s or rps: twenty a decade; chosen


def held_inputs(model: Model, values_by_name: Mapping[str, float], rudder: str) -> Array:
    """Return constant inputs in the model's signs, shape (nu,), rudder amidships; absent wind channels mean still air.

    Raises:
        InputError: an input is missing, unknown, or the rudder is among those given.
    """
    known = [name for name in model.input_names if name != rudder]
    for name in values_by_name:
        if name not in known:
            raise InputError(f"'{name}' is no held input of model '{model.name}'{spelling_hint(name, known)}")
    values = np.zeros(len(model.inputs))
    for j, item in enumerate(model.inputs):
        if item.name in values_by_name:
            values[j] = -values_by_name[item.name] if item.is_reversed else values_by_name[item.name]
        elif item.name != rudder and item.name not in ZERO_BY_DEFAULT:
            raise InputError(f"model '{model.name}' needs the input '{item.name}'; give the value it is held at")
    return values


def approach_speed(model: Model, held: Array) -> float:
    """Return the speed u [m/s] at which surge is in balance on a straight course without drift."""
    from scipy.optimize import brentq

    place, parameters = model.states.index("u"), model.parameters.values
    state, rates = settled_actuators(model, held), np.empty(len(model.states))

    def surge(u: float) -> float:
        state[place] = u
        model.compiled.rates(0.0, state, held, parameters, rates)
        return float(rates[place])

    speeds = np.geomspace(1e-3, _MAX_SPEED, 60)  # m/s; grid that brackets the speed; chosen
    for low, high in pairwise(speeds):
        if surge(low) > 0.0 >= surge(high):
            return float(brentq(surge, low, high, xtol=1e-12))  # m/s of rounding; chosen
    raise InputError(f"model '{model.name}' has no steady speed ahead with these inputs; give the approach speed")


def balancing_input(model: Model, held: Array, name: str, speed: float) -> float:
    """Return the input at which surge is in balance on a straight course at u = `speed` [m/s], the others as held.

    Raises:
        InputError: there is none.
    """
    from scipy.optimize import brentq

    place, k = model.input_names.index(name), model.states.index("u")
    inputs, rates = held.copy(), np.empty(len(model.states))

    def surge(value: float) -> float:
        inputs[place] = value
        state = settled_actuators(model, inputs)
        state[k] = speed
        model.compiled.rates(0.0, state, inputs, model.parameters.values, rates)
        return float(rates[k])

    tried = _SEARCHED * speed
    least = next((i for i, value in enumerate(tried) if surge(value) > 0.0), 0)
    if least == 0:
        raise InputError(
            f"model '{model.name}' has no '{name}' that drives the ship at {speed:.4g} m/s; take another speed"
        )
    return float(brentq(surge, tried[least - 1], tried[least], xtol=1e-12))  # of the propulsion: rounding


def straight_run(model: Model, plan: Record, speed: float | None = None) -> dict[str, float]:
    """Return where a planned record starts: on a straight course at u = `speed`, thrusters at rest, all else zero.

    Without a speed it is the one at which surge balances with the plan's first inputs, rudder amidships; a craft with
    thrusters starts at rest.
    """
    start = dict.fromkeys(model.states, 0.0)
    if "u" in start and speed is not None:
        start["u"] = speed
    elif "u" in start and not model.equations.layout:
        first = inputs_of(model, plan)[0].copy()
        first[[name == RUDDER for name in model.input_names]] = 0.0
        start["u"] = approach_speed(model, first)
    return start


def characteristic_time(model: Model, start: Array, given_speed: float | None, length: float = 0.0) -> float:
    """L/U [s] from the start's u, the speed given, or the model's parameter U; else a Nomoto model's time constant.

    length: L [m] where it is no parameter of the model.
    """
    names = model.parameters.names
    length = model.parameters["L"].value if "L" in names else length
    if "u" in model.states:
        speed = float(start[model.states.index("u")])
    else:
        speed = given_speed or (model.parameters["U"].value if "U" in names else 0.0)
    if length > 0.0 and speed > 0.0:
        return length / speed
    for constant in ("T", "T_1"):
        if constant in names:
            return model.parameters[constant].value
    raise InputError(f"model '{model.name}': the approach speed must be positive, and its parameters must give L")
