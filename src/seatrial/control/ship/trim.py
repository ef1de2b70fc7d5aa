"""Steady motion about which a model is linearised: a straight run, or rest, with the propulsion that holds it."""

from collections.abc import Mapping

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.numerics.kernels.sensitivity import evaluate_tangent
from seatrial.physics.models.thrust_orders import YAW
from seatrial.physics.simulate.replay import ZERO_BY_DEFAULT
from seatrial.physics.simulate.states import RUDDER, approach_speed, balancing_input, held_inputs, settled_actuators

_ITERATIONS = 30  # Newton steps at most; chosen
_MOST_RUDDER = 0.6  # rad, 34 deg: largest mean rudder of a trim; of a yaw command a share of the full one; chosen
# relative, of a speed that inputs balance, and of the speed a model was identified at; chosen
_SPEED_TOLERANCE, _NOMINAL_TOLERANCE = 1e-3, 1e-2
_RATE_TOLERANCE, _STEP_TOLERANCE = 1e-9, 1e-13  # SI, of the rates at a trim, and of the last relative step: rounding
_POSE = ("psi", "x0", "y0")


def held_inputs_at_speed(
    model: Model, approach: Mapping[str, float], speed: float | None, given_inputs: Mapping[str, float] | None
) -> tuple[Model, Array]:
    """The model and its held inputs in its own signs, with the propulsion solved for where a speed is required."""
    names, own = model.input_names, dict(given_inputs or {})
    known = {k: v for k, v in approach.items() if k in names and k != RUDDER and k not in ZERO_BY_DEFAULT} | own
    drives = [n for n in names if n not in (RUDDER, YAW) and n not in ZERO_BY_DEFAULT and n != "u" and n != "omega_e"]
    if speed is None:
        return model, held_inputs(model, known, RUDDER)
    if not speed > 0.0:
        raise InputError(f"the speed of a straight run must be positive, not {speed:g} m/s")
    if "u" in names:
        return model, held_inputs(model, known | {"u": speed}, RUDDER)
    if "u" not in model.states:
        return _at_nominal_speed(model, speed), held_inputs(model, known, RUDDER)
    free = [n for n in drives if n not in own]
    if len(free) != 1:
        held = held_inputs(model, known, RUDDER)
        balanced = approach_speed(model, held)
        if abs(balanced - speed) > _SPEED_TOLERANCE * speed:
            raise InputError(
                f"model '{model.name}' runs at {balanced:.4g} m/s with these inputs, not at {speed:.4g} m/s; "
                "give the speed or the propulsion, not both"
            )
        return model, held
    held = held_inputs(model, known | {free[0]: known.get(free[0], 0.0)}, RUDDER)
    held[names.index(free[0])] = balancing_input(model, held, free[0], speed)
    return model, held


def _at_nominal_speed(model: Model, speed: float) -> Model:
    if "U" not in model.parameters:
        return model
    U = model.parameters["U"].value
    if U > 0.0 and abs(U - speed) > _NOMINAL_TOLERANCE * speed:
        raise InputError(
            f"model '{model.name}' holds for {U:.4g} m/s, where it was identified, not for {speed:.4g} m/s; "
            "leave the speed out, or take a model with surge"
        )
    return model.with_values({"U": speed})


def steering_input(model: Model) -> str:
    """Return the input that keeps a straight course: the rudder, or a yaw command; empty where there is neither."""
    return next((name for name in (RUDDER, YAW) if name in model.input_names), "")


def find_trim(model: Model, held: Array) -> tuple[Array, Array]:
    """State (nx,) and inputs (nu,) of steady motion: a straight course if there is a heading, else rest.

    The rudder, or the yaw command of a craft with thrusters, carries what asymmetry requires. held: (nu,) in the
    model's signs.
    """
    names, nx = model.states, len(model.states)
    steering = steering_input(model)
    steers = "psi" in names and bool(steering)
    still = (*_POSE, "r") if "psi" in names else ()
    state, inputs = settled_actuators(model, held), held.copy()
    if "u" in names:
        state[names.index("u")] = approach_speed(model, held)
    rows = [i for i, s in enumerate(names) if s not in _POSE]
    columns = [i for i, s in enumerate(names) if s not in still]
    if steers:
        columns.append(nx + model.input_names.index(steering))
    unknown, rates = np.concatenate([state, inputs]), np.empty(nx)
    for _ in range(_ITERATIONS):
        x, u = np.ascontiguousarray(unknown[:nx]), np.ascontiguousarray(unknown[nx:])
        model.compiled.rates(0.0, x, u, model.parameters.values, rates)
        slopes = jacobian_at(model, x[None], u, of_outputs=False)[0][np.ix_(rows, columns)]
        step = np.linalg.lstsq(slopes, -rates[rows], rcond=None)[0]
        unknown[columns] += step
        small = _STEP_TOLERANCE * max(1.0, np.abs(x).max())
        if not np.all(np.isfinite(unknown)) or np.max(np.abs(step), initial=0.0) < small:
            break
    state, inputs = np.ascontiguousarray(unknown[:nx]), np.ascontiguousarray(unknown[nx:])
    model.compiled.rates(0.0, state, inputs, model.parameters.values, rates)
    kept = not steers or abs(inputs[model.input_names.index(steering)]) < _MOST_RUDDER
    if not (np.all(np.isfinite(unknown)) and np.max(np.abs(rates[rows])) < _RATE_TOLERANCE and kept):
        most = "34 degrees of rudder" if steering == RUDDER else f"{_MOST_RUDDER:g} of the full yaw command"
        what = f"straight course with less than {most}" if steers else "steady motion"
        raise InputError(f"model '{model.name}' has no {what} with these inputs; check them and the model's values")
    return state, inputs


def jacobian_at(model: Model, states: Array, inputs: Array, *, of_outputs: bool) -> Array:
    """Return the exact Jacobian at each of the states (n, nx), shape (n, rows, nx + nu + np)."""
    rows = len(model.outputs) if of_outputs else len(model.states)
    n, width = len(states), len(model.states) + len(model.inputs) + len(model.parameters)
    jac = np.zeros((n, rows, width))
    if rows:
        code = model.compiled.outputs_tangent if of_outputs else model.compiled.rates_tangent
        repeated = np.tile(inputs, (n, 1)), np.tile(model.parameters.values, (n, 1))
        evaluate_tangent(code, np.ascontiguousarray(states), *repeated, 1.0, np.empty((n, rows)), jac)
    return jac
