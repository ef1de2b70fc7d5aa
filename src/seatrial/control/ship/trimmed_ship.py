"""From an identified model to the plant of a loop: the trim, and the transfer functions about it.

The trim is a straight run where the model steers or surges, else rest. Matrices are the model's exact Jacobians there.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from seatrial.control.ship.trim import find_trim, held_inputs_at_speed, jacobian_at, steering_input
from seatrial.control.task import TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.data.folder.model_file import ModelFile
from seatrial.estimation.information.stability import lateral_states
from seatrial.physics.hydro.free_roll import equivalent_damping
from seatrial.physics.loops import Block
from seatrial.physics.simulate.states import RUDDER

# SI, off the straight course, for one-sided slopes; relative rounding error
_LATERAL_OFFSET, _NEGLIGIBLE = 1e-12, 1e-10
_ROLL_PARAMETERS = ("b_1", "b_2", "b_3", "c_1", "c_3", "c_5", "phi_0")


@dataclass(frozen=True, eq=False)
class LinearisedShip:
    """x' = A x + B u, y = C x + D u about a trim, inputs in the model's signs; (n, n), (n, nu), (n,), (nu,)."""

    A: Array
    B: Array
    C: Array
    D: Array


def trim_ship(
    file: ModelFile,
    *,
    output: str,
    actuator: str,
    disturbance: str = "",
    speed: float | None = None,
    inputs: Mapping[str, float] | None = None,
) -> TrimmedShip:
    """Return the model of a file, trimmed, with its covariance.

    Args:
        output: symbol of a state or a measurable output; actuator, disturbance: symbols of inputs.
        speed: m/s, of a straight run; what drives the ship is then found. Without it the speed at which surge
            balances with the inputs given, or with those of the file's own approach.
        inputs: held constant, by name, SI in the notation's signs (``n``, ``v_j``).
    """
    model = file.model
    if output not in model.observables:
        hint = f"{spelling_hint(output, list(model.observables))}; it has {', '.join(model.observables)}"
        raise InputError(f"'{output}' is no output of model '{model.name}'{hint}")
    inputs_known = ", ".join(model.input_names)
    for role, name in (("actuator", actuator), ("disturbance", disturbance)):
        if name not in model.input_names and (name or role == "actuator"):
            hint = spelling_hint(name, list(model.input_names))
            raise InputError(f"{role} '{name}' is no input of model '{model.name}'{hint}; it has {inputs_known}")
    if model.parameters.missing:
        raise InputError(f"model '{model.name}' has no value for {', '.join(model.parameters.missing)}")
    model, held = held_inputs_at_speed(model, file.approach, speed, inputs)
    state, trim = find_trim(model, held)
    made = TrimmedShip(model, state, trim, actuator, output, disturbance, file.covariance, file.provenance.warnings)
    plant_and_disturbance(made)
    return made


def with_parameters(ship: TrimmedShip, values: Mapping[str, float]) -> TrimmedShip:
    """Return the same ship with other parameters, trimmed anew with the propulsion held."""
    model, held = ship.model.with_values(values), ship.inputs.copy()
    if steering_input(model):
        held[model.input_names.index(steering_input(model))] = 0.0
    state, inputs = find_trim(model, held)
    return replace(ship, model=model, state=state, inputs=inputs)


def plant_and_disturbance(ship: TrimmedShip, amplitude: float | None = None) -> tuple[Block, Block]:
    """Return transfer functions from actuator to output and from disturbance to output, in the notation's signs.

    Without a disturbance the second is the first: something that acts like the actuator. What neither follows the input
    nor shows in the output is left out; a heading keeps its integrator. Where a model has a kink on the straight course
    (flow straightening that differs with the side) the Jacobian is the mean of both sides.

    amplitude: rad, of the roll about which a model of nonlinear roll is linearised by equivalent energy and first
    harmonic; without it at rest. Other models do not heed it.
    """
    made = linearise(ship)
    if amplitude is not None and set(_ROLL_PARAMETERS) <= set(ship.model.parameters.names):
        made = replace(made, A=_roll_equivalent_matrix(ship.model, made.A, amplitude))
    plant = _transfer_function(ship, made, ship.actuator)
    return plant, _transfer_function(ship, made, ship.disturbance) if ship.disturbance else plant


def one_sided_plants(ship: TrimmedShip) -> tuple[Block, ...]:
    """Return the plant for a turn just begun to starboard and to port; they differ where the model has a kink."""
    return tuple(_transfer_function(ship, side, ship.actuator) for side in _one_sided_matrices(ship))


def plant_text(ship: TrimmedShip) -> str:
    """Return the plant in words: the model, the trim, whether it is stable by itself."""
    model, (plant, _) = ship.model, plant_and_disturbance(ship)
    where = "about its mean position"
    if "u" in model.states:
        where = f"straight run at {ship.state[model.states.index('u')]:.4g} m/s"
    held = [f"{i.name} {v:.4g}" for i, v in zip(model.inputs, ship.inputs, strict=True)
            if abs(v) > _NEGLIGIBLE and i.name != RUDDER]  # fmt: skip
    worst = float(plant.poles.real.max()) if plant.order else -1.0
    stable = "" if worst <= 0.0 else f"; unstable by itself: a disturbance grows by a factor e in {1.0 / worst:.3g} s"
    return f"model '{model.name}', {', '.join([where, *held])}{stable}"


def linearise(ship: TrimmedShip) -> LinearisedShip:
    """Return the matrices about the trim, the mean over both sides."""
    one, other = _one_sided_matrices(ship)
    return LinearisedShip(*(0.5 * (getattr(one, k) + getattr(other, k)) for k in ("A", "B", "C", "D")))


def _one_sided_matrices(ship: TrimmedShip) -> tuple[LinearisedShip, LinearisedShip]:
    model = ship.model
    nx, nu = len(model.states), len(model.inputs)
    aside = np.zeros(nx)
    for name in lateral_states(model):
        aside[model.states.index(name)] = -_LATERAL_OFFSET if name == "v" else _LATERAL_OFFSET
    states = ship.state + np.stack([aside, -aside])
    rates, seen = (jacobian_at(model, states, ship.inputs, of_outputs=b) for b in (False, True))
    row = model.observables.index(ship.output)
    rows = np.eye(nx, nx + nu)[None, row].repeat(2, 0) if row < nx else seen[:, row - nx]
    one, other = (LinearisedShip(j[:, :nx], j[:, nx : nx + nu], c[:nx], c[nx : nx + nu])
                  for j, c in zip(rates, rows, strict=True))  # fmt: skip
    return one, other


def _roll_equivalent_matrix(model: Model, A: Array, amplitude: float) -> Array:
    """Return a with the damping of equal energy and the stiffness of the first harmonic at that amplitude [rad].

    b_e as in `hydro.rolling`; c_e = c_1 + 3/4 c_3 a^2 + 5/8 c_5 a^4, the first harmonic of the restoring moment
    (ITTC 7.5-02-07-04.5; Nayfeh & Mook 1979, section 4.1).
    """
    if not 0.0 <= amplitude < 1.5:  # rad, 86 deg: largest amplitude accepted; chosen
        raise InputError(
            f"the roll amplitude of a linearisation must lie between 0 and 86 degrees, not at {amplitude:g} rad"
        )
    # powers of the roll rate and of the roll in `physics/models/roll.py`
    b, c = (np.array([model.parameters[f"{letter}_{i}"].value for i in of])
            for letter, of in (("b", (1, 2, 3)), ("c", (1, 3, 5))))  # fmt: skip
    damping = float(equivalent_damping(b, c, np.array([amplitude]))[0][0])
    # first harmonics of x^3 and x^5: 3/4 and 5/8
    stiffness = float(c @ [1.0, 0.75 * amplitude**2, 0.625 * amplitude**4])
    if not (np.isfinite(damping) and stiffness > 0.0):
        raise InputError(
            f"a roll of {np.degrees(amplitude):.3g} degrees does not come back: the restoring moment of model "
            f"'{model.name}' has gone by then; linearise at a smaller amplitude"
        )
    phi, p = model.states.index("phi"), model.states.index("p")
    made = A.copy()
    made[p, [phi, p]] = -stiffness, -damping
    return made


def rate_response(ship: TrimmedShip, state: str) -> Block:
    """Return the transfer function from something added to the rate of a state to the output.

    Of the yaw rate ``r``: from a yaw acceleration [rad/s^2] to the output.

    Raises:
        InputError: the model has no such state, or it does not move the output.
    """
    names, linear = ship.model.states, linearise(ship)
    if state not in names:
        raise InputError(f"model '{ship.model.name}' has no state '{state}' that waves could accelerate")
    return _response(ship, linear, np.eye(len(names))[names.index(state)], 0.0, f"acceleration of {state}")


def response_of_states(ship: TrimmedShip, name: str, weights: Mapping[str, float]) -> Block:
    """Return the transfer function from an input to a weighted sum of states, in the notation's signs."""
    linear, C = linearise(ship), np.zeros(len(ship.model.states))
    for state, weight in weights.items():
        C[ship.model.states.index(state)] = weight
    return _transfer_function(ship, replace(linear, C=C, D=np.zeros(len(linear.D))), name)


def _transfer_function(ship: TrimmedShip, linear: LinearisedShip, name: str) -> Block:
    """Return C (s I - A)^-1 B + D of one input, controllable and observable states only, in the notation's signs."""
    column = ship.model.input_names.index(name)
    sign = -1.0 if ship.model.inputs[column].is_reversed else 1.0
    return _response(ship, linear, sign * linear.B[:, column], sign * float(linear.D[column]), name)


def _response(ship: TrimmedShip, linear: LinearisedShip, b: Array, feed: float, name: str) -> Block:
    kept = _linked_states(linear.A, _is_significant(b)) & _linked_states(linear.A.T, _is_significant(linear.C))
    A, b, c = linear.A[np.ix_(kept, kept)], b[kept], linear.C[kept]
    den = _characteristic_polynomial(A)
    num, M = [feed], np.eye(len(A))
    for k in range(len(A)):
        num.append(float(c @ M @ b) + feed * den[k + 1])
        M = A @ M + den[k + 1] * np.eye(len(A))
    block = Block(f"{name} to {ship.output}", tuple(num), tuple(den), f"model {ship.model.name}, linearised")
    if block.num == (0.0,):
        hint = "; give the parameter K_alpha" if name == "alpha_f" and "K_alpha" in ship.model.parameters else ""
        raise InputError(f"'{name}' has no effect on '{ship.output}' of model '{ship.model.name}' at this trim{hint}")
    return block


def _is_significant(entries: Array) -> NDArray[np.bool_]:
    """Return which are more than rounding of the largest."""
    return np.abs(entries) > _NEGLIGIBLE * np.abs(entries).max(initial=0.0)


def _linked_states(A: Array, start: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return states that follow those of `start` through A, themselves included."""
    link, reached = _is_significant(A), start
    for _ in range(len(A)):
        reached = reached | (link @ reached)
    return reached


def _characteristic_polynomial(A: Array) -> Array:
    """Return det(s I - A), highest power first; roots of rounding size are zeros, so that an integrator stays one."""
    roots = np.linalg.eigvals(A)
    roots[np.abs(roots) < _NEGLIGIBLE * np.abs(roots).max(initial=0.0)] = 0.0
    return np.asarray(np.atleast_1d(np.poly(roots).real), dtype=np.float64)
