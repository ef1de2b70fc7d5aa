"""The ship behind a loop: an identified model at its scale, its trim, its plant, and draws of its parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from seatrial.control.task import TrimmedShip, TuningTask
from seatrial.core.equations import Model
from seatrial.core.equations.model import RUDDER, ZERO_BY_DEFAULT
from seatrial.core.values import NOTATION, Array, InputError, Parameter, Parameters, frozen, spelling_hint
from seatrial.core.values.record import froude_factor
from seatrial.data.folder.model_file import ModelFile
from seatrial.numerics.kernels.integrate import evaluate_tangent
from seatrial.numerics.kernels.loop import is_hurwitz
from seatrial.physics.hydro.free_roll import equivalent_damping
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.loops.loop_states import plant_model
from seatrial.physics.models.thrust_orders import YAW
from seatrial.physics.simulate.linear import LinearSystem
from seatrial.physics.simulate.states import approach_speed, balancing_input, held_inputs, settled_actuators

# An identified model at another scale, by Froude's law: that of a ship from the trials of its model.

_LENGTHS = ("L", "B", "d")


def model_at_scale(file: ModelFile, ratio: float) -> ModelFile:
    """Return a model file of a craft `ratio` times as large: every parameter, its covariance, ship and approach.

    Coefficients without dimension stay; the density of the water does, too. Of the ship's particulars those that the
    model knows and its length, breadth and draught are kept.

    Raises:
        InputError: the ratio is not positive, or a parameter has a unit of which no exponent is known.
    """
    factors = {p.name: _factor(p, ratio) for p in file.model.parameters}
    scaled = Parameters(tuple(_scaled(p, factors[p.name]) for p in file.model.parameters))
    size = np.array([factors[name] for name in scaled.free_names])
    factors |= dict.fromkeys(_LENGTHS, froude_factor("m", ratio))
    ship = file.ship
    if ship is not None:
        particulars = {name: value * factors[name] for name, value in ship.particulars.items() if name in factors}
        ship = replace(ship, name=f"{ship.name}, times {ratio:g}", particulars=particulars, scale=ship.scale / ratio)
    return replace(
        file,
        model=file.model.with_parameters(scaled),
        covariance=frozen(file.covariance * np.outer(size, size)) if file.covariance.size else file.covariance,
        ship=ship,
        approach={name: value * froude_factor(NOTATION[name].unit, ratio) for name, value in file.approach.items()},
        interval_basis=None,
    )


def _factor(parameter: Parameter, ratio: float) -> float:
    try:
        return froude_factor(parameter.unit, ratio)
    except InputError as error:
        raise InputError(f"parameter {parameter.name}: {error}") from None


def _scaled(p: Parameter, factor: float) -> Parameter:
    """Return the parameter times a factor; what was known before the fit has gone into its value."""
    return replace(
        p, value=p.value * factor, lower=p.lower * factor, upper=p.upper * factor, scale=p.scale * factor, prior=None
    )


# Steady motion about which a model is linearised: a straight run, or rest, with the propulsion that holds it.

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
    if not model.has_speed:
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


# A ship of which only transfer functions are known: the plant of a loop as a linear model of its own.


def plant_as_model(loop: TransferLoop) -> TrimmedShip:
    """The plant as a linear model, at rest: its first state is the output.

    Raises:
        InputError: the plant answers at once.
    """
    model = plant_model(replace(loop, disturbance=loop.plant))
    return TrimmedShip(model, np.zeros(len(model.states)), np.zeros(len(model.inputs)), loop.actuator, loop.output)


# From an identified model to the plant of a loop: the trim, and the transfer functions about it.

# SI, off the straight course, for one-sided slopes; relative rounding error
_LATERAL_OFFSET, _NEGLIGIBLE = 1e-12, 1e-10
_ROLL_PARAMETERS = ("b_1", "b_2", "b_3", "c_1", "c_3", "c_5", "phi_0")


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
    if model.has_speed:
        where = f"straight run at {ship.state[model.states.index('u')]:.4g} m/s"
    held = [f"{i.name} {v:.4g}" for i, v in zip(model.inputs, ship.inputs, strict=True)
            if abs(v) > _NEGLIGIBLE and i.name != RUDDER]  # fmt: skip
    worst = float(plant.poles.real.max()) if plant.order else -1.0
    stable = "" if worst <= 0.0 else f"; unstable by itself: a disturbance grows by a factor e in {1.0 / worst:.3g} s"
    return f"model '{model.name}', {', '.join([where, *held])}{stable}"


def linearise(ship: TrimmedShip) -> LinearSystem:
    """Return the matrices about the trim, the mean over both sides."""
    return _mean_matrices(*_one_sided_matrices(ship))


def _mean_matrices(one: LinearSystem, other: LinearSystem) -> LinearSystem:
    return LinearSystem(*(0.5 * (getattr(one, name) + getattr(other, name)) for name in ("A", "B", "C", "D")))


def _one_sided_matrices(ship: TrimmedShip) -> tuple[LinearSystem, LinearSystem]:
    from seatrial.estimation.information.stability import lateral_states

    model = ship.model
    nx, nu = len(model.states), len(model.inputs)
    aside = np.zeros(nx)
    for name in lateral_states(model):
        aside[model.states.index(name)] = -_LATERAL_OFFSET if name == "v" else _LATERAL_OFFSET
    states = ship.state + np.stack([aside, -aside])
    rates, row = jacobian_at(model, states, ship.inputs, of_outputs=False), model.observables.index(ship.output)
    if row < nx:
        rows = np.eye(nx, nx + nu)[None, row].repeat(2, 0)
    else:
        rows = jacobian_at(model, states, ship.inputs, of_outputs=True)[:, row - nx]
    one, other = (LinearSystem(j[:, :nx], j[:, nx : nx + nu], c[:nx], c[nx : nx + nu])
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


def _transfer_function(ship: TrimmedShip, linear: LinearSystem, name: str) -> Block:
    """Return C (s I - A)^-1 B + D of one input, controllable and observable states only, in the notation's signs."""
    column = ship.model.input_names.index(name)
    sign = -1.0 if ship.model.inputs[column].is_reversed else 1.0
    return _response(ship, linear, sign * linear.B[:, column], sign * float(linear.D[column]), name)


def _minimal(linear: LinearSystem, b: Array) -> tuple[Array, Array, Array]:
    """Return A, b, c of the states that follow an input b (nx,) and show in the output."""
    kept = _linked_states(linear.A, _is_significant(b)) & _linked_states(linear.A.T, _is_significant(linear.C))
    return linear.A[np.ix_(kept, kept)], b[kept], linear.C[kept]


def _response(ship: TrimmedShip, linear: LinearSystem, b: Array, feed: float, name: str) -> Block:
    A, b, c = _minimal(linear, b)
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


# Ships sampled from the covariance of a fit, each trimmed anew, and how many of them a controller keeps stable.

SEED, DRAWS = 0, 100  # of the ships drawn, and how many; chosen
_KEPT = 8  # results kept in memory: one for each plant in use; chosen


@dataclass(frozen=True, eq=False)
class ParameterDraws:
    """Ships sampled from the covariance of a fit.

    Attributes:
        draws: number of samples, also of those without a trim or with an actuator without effect; no controller counts
            as stable on these.
        ships: the trimmed samples; plants: of each, the mean of both sides and, where they differ, the two sides.
    """

    draws: int
    ships: tuple[TrimmedShip, ...]
    plants: tuple[tuple[Block, ...], ...]

    def stable_ships(self, loop: TransferLoop, gains: Array) -> tuple[bool, ...]:
        """Return for each ship whether gains (g,) stabilise it, on the straight course and starting either turn."""
        rows = [np.add(*one.fraction(gains)) for one in loops_drawn(loop, self)]
        stable = iter([is_hurwitz(np.ascontiguousarray(row), len(row) - 1) for row in rows])
        return tuple(all(list(islice(stable, len(plants)))) for plants in self.plants)


def drawn_values(model: Model, covariance: Array, draws: int, seed: int) -> list[dict[str, float]]:
    """Return free parameters by name, sampled from their Gaussian; none without a covariance. Nothing is truncated."""
    if not covariance.size:
        return []
    from seatrial.estimation.predict.draws import square_root

    free = model.parameters.free
    spread = np.random.default_rng(seed).standard_normal((draws, len(free))) @ square_root(covariance).T
    points = np.array([p.value for p in free]) + spread
    return [dict(zip(model.parameters.free_names, point, strict=True)) for point in points.tolist()]


@lru_cache(maxsize=_KEPT)
def draw_parameters(ship: TrimmedShip, draws: int = DRAWS, seed: int = SEED) -> ParameterDraws:
    """Return ships sampled from the Gaussian of the free parameters; none where the fit has no covariance.

    The same seed gives the same ships.
    """
    if not ship.covariance.size or not draws:
        return ParameterDraws(0, (), ())
    ships, plants = [], []
    for values in drawn_values(ship.model, ship.covariance, draws, seed):
        try:
            sampled = with_parameters(ship, values)
            plants.append(_plant_blocks(sampled))
            ships.append(sampled)
        except InputError:
            continue
    return ParameterDraws(draws, tuple(ships), tuple(plants))


def stable_draws(
    task: TuningTask, gains: Array, loop: TransferLoop | None = None, *, draws: int = DRAWS
) -> tuple[int, int]:
    """Return how many sampled ships the gains (g,) stabilise, and how many were sampled; (0, 0) without covariance."""
    if task.trimmed_ship is None:
        return 0, 0
    samples = draw_parameters(task.trimmed_ship, draws, SEED)
    return sum(samples.stable_ships(task.loop if loop is None else loop, gains)), samples.draws


def _plant_blocks(ship: TrimmedShip) -> tuple[Block, ...]:
    sides, column = _one_sided_matrices(ship), ship.model.input_names.index(ship.actuator)
    parts = [(*_minimal(side, side.B[:, column]), side.D[column]) for side in sides]
    alike = all(np.array_equal(one, other) for one, other in zip(*parts, strict=True))
    matrices = sides[:1] if alike else (_mean_matrices(*sides), *sides)
    return tuple(_transfer_function(ship, linear, ship.actuator) for linear in matrices)


@lru_cache(maxsize=_KEPT)
def loops_drawn(loop: TransferLoop, samples: ParameterDraws) -> tuple[TransferLoop, ...]:
    """Return the loop before each plant drawn, in a row."""
    return tuple(replace(loop, plant=plant) for plants in samples.plants for plant in plants)
