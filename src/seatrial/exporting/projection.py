"""A craft's hull forces projected onto the structure that another simulator computes."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model, ModelEquations
from seatrial.core.equations.model import stored_equations
from seatrial.core.values import Array, InputError, Parameter, Parameters, Record
from seatrial.data.folder.model_file import ModelFile
from seatrial.numerics.kernels.integrate import evaluate
from seatrial.physics.simulate.replay import inputs_of, trajectory

# What another simulator computes for a hull: the terms that it has, and the rigid body that they act on.

HULL = ("X_H", "Y_H", "N_H")
ADDED: tuple[str, ...] = ("xDotU", "yDotV", "nDotR")
"""Tags of added mass in surge, sway and yaw."""
OFF_COURSE = 0.2
"""v over u, and L r over u, at which quadratic terms are read off a model; chosen."""


@dataclass(frozen=True)
class RigidBody:
    """Mass [kg], yaw inertia about the centre of gravity [kg m^2], and how far forward of the origin that is [m]."""

    mass: float
    inertia: float
    x_G: float

    @property
    def inertia_at_origin(self) -> float:
        """Yaw inertia about the origin [kg m^2]."""
        return self.inertia + self.mass * self.x_G**2


@dataclass(frozen=True)
class ForceTerm:
    """A term of the target: `tag` times `first` times `second` (of u, v, r; ``|u|`` for a magnitude; empty: 1)."""

    tag: str
    force: str
    first: str
    second: str = ""
    sign: float = 1.0


@dataclass(frozen=True)
class TargetStructure:
    """What a simulator computes for one link.

    Attributes:
        terms: of damping.
        added_mass_sign: of xDotU, yDotV, nDotR for an added mass that is positive.
        is_inertial: whether added mass acts on the acceleration in space (u' - v r), else on the rate (u') alone.
    """

    terms: tuple[ForceTerm, ...]
    added_mass_sign: float
    is_inertial: bool


def unsuitable_hull(file: ModelFile) -> str:
    """Return why a model cannot be projected; empty where it can."""
    model = file.model
    absent = [s for s in ("u", "v", "r", "psi") if s not in model.states]
    if absent:
        return f"it has no state '{absent[0]}', and the target is a craft in surge, sway and yaw"
    names = {b.name for b in model.bindings}
    absent = [b for b in (*HULL, "X_sum", "Y_sum", "N_sum") if b not in names]
    if absent:
        return f"it has no binding '{absent[0]}', so that forces of hull and actuators cannot be separated"
    rigid = rigid_body(file)
    if rigid is None:
        return "neither the model nor its ship states the mass m and the inertia I_z that the link needs"
    if model.parameters.value_of("M_u", math.inf) < rigid.mass:
        return (
            f"its M_u of {model.parameters['M_u'].value:.4g} kg is less than the mass m of {rigid.mass:.4g} kg, so "
            "that its forces are not in newtons; identify it with the bollard thrust of a thruster"
        )
    return ""


def rigid_body(file: ModelFile) -> RigidBody | None:
    """Return mass and inertia of the model or its ship; None where neither states both."""
    ship = {} if file.ship is None else file.ship.particulars
    values = {**ship, **{p.name: p.value for p in file.model.parameters}}
    if not {"m", "I_z"} <= set(values):
        return None
    return RigidBody(float(values["m"]), float(values["I_z"]), float(values.get("x_G", 0.0)))


# The coefficients that a model itself has for the terms of another simulator, at its approach speed.

_SMALL = 1e-3  # v over u, and L r over u, at which linear terms are read off the model; chosen


def truncation(
    file: ModelFile, structure: TargetStructure, rigid: RigidBody, records: Sequence[Record]
) -> dict[str, float]:
    """Return the coefficients that the model itself has for the target's terms, at its approach speed."""
    model, speed = file.model, float(records[0]["u"][0]) or 1.0
    length = model.parameters.value_of("L", 1.0)
    sway, turn = OFF_COURSE * speed, OFF_COURSE * speed / length
    rows = {"": (speed, 0.0, 0.0), "v": (speed, sway, 0.0), "r": (speed, 0.0, turn), "vr": (speed, sway, turn),
            "small v": (speed, _SMALL * speed, 0.0), "small r": (speed, 0.0, _SMALL * speed / length)}  # fmt: skip
    states = np.zeros((2 * len(rows), len(model.states)))
    places = [model.states.index(s) for s in ("u", "v", "r")]
    states[: len(rows), places] = list(rows.values())
    states[len(rows) :, places] = [(u, -v, -r) for u, v, r in rows.values()]
    inputs = np.repeat(inputs_of(model, records[0])[:1], len(states), axis=0)
    bindings = model.forces(states, inputs)
    added = _added_masses(file, rigid, bindings)
    forces = _required_forces(model, structure, rigid, added, states, inputs, bindings)
    index = {key: k for k, key in enumerate(rows)}

    def part(force: str, key: str, parity: float) -> float:
        """The part of a force that is odd (-1) or even (1) in sway and yaw."""
        values, k = forces[force], index[key]
        return 0.5 * float(values[k] + parity * values[k + len(rows)])

    added_masses = dict(zip(ADDED, (structure.added_mass_sign * a for a in added), strict=True))
    ahead = part("X", "", 1.0)
    for term in structure.terms:
        kind = f"{term.first}{term.second}"
        force = term.force
        linear = {"v": part(force, "small v", -1.0) / (_SMALL * speed),
                  "r": part(force, "small r", -1.0) / (_SMALL * speed / length)}  # fmt: skip
        value = {
            "u|u|": ahead / speed**2, "vv": (part(force, "v", 1.0) - ahead) / sway**2,
            "rr": (part(force, "r", 1.0) - ahead) / turn**2,
            "vr": (part(force, "vr", 1.0) - part(force, "v", 1.0) - part(force, "r", 1.0) + ahead) / (sway * turn),
            "v": linear["v"], "r": linear["r"],
            "v|v|": (part(force, "v", -1.0) - linear["v"] * sway) / sway**2,
            "r|r|": (part(force, "r", -1.0) - linear["r"] * turn) / turn**2,
        }.get(kind, 0.0)  # fmt: skip
        added_masses[term.tag] = term.sign * value
    return added_masses


def _added_masses(file: ModelFile, rigid: RigidBody, forces: Mapping[str, Array]) -> list[float]:
    """m_x, m_y, J_z of the model; from its sums with the rigid body where it has these."""
    parameters = file.model.parameters
    if "m_x" in parameters:
        return [parameters[n].value for n in ("m_x", "m_y", "J_z")]
    sums = [float(forces[n][0]) if n in forces else parameters[n].value for n in ("M_u", "M_v", "M_r")]
    return [total - body for total, body in zip(sums, (rigid.mass, rigid.mass, rigid.inertia_at_origin), strict=True)]


def _required_forces(
    model: Model, structure: TargetStructure, rigid: RigidBody, added: list[float], states: Array,
    inputs: Array, bindings: Mapping[str, Array],
) -> dict[str, Array]:  # fmt: skip
    """Return the damping forces X, Y, N with which the target would accelerate as the model does, (n,) each."""
    rates = np.empty_like(states)
    evaluate(model.compiled.rates, states, inputs, model.parameters.values, 0.0, rates)
    u, v, r = (states[:, model.states.index(s)] for s in ("u", "v", "r"))
    u_dot, v_dot, r_dot = (rates[:, model.states.index(s)] for s in ("u", "v", "r"))
    m, x_G = rigid.mass, rigid.x_G
    A_x, A_y, A_r = added
    in_space = 1.0 if structure.is_inertial else 0.0
    X, Y, N = (bindings[f"{axis}_sum"] - bindings[f"{axis}_H"] for axis in "XYN")
    across = v_dot + u * r
    return {
        "X": (m + A_x) * u_dot - (m + in_space * A_x) * v * r - m * x_G * r**2 - X,
        "Y": m * across + A_y * (v_dot + in_space * u * r) + m * x_G * r_dot - Y,
        "N": (rigid.inertia_at_origin + A_r) * r_dot + m * x_G * across - N,
    }


# A craft's hull forces projected onto the structure that another simulator computes, refitted over manoeuvres.

MOTION = ("u", "v", "r", "psi")
_MASS, _INERTIA, _X_G = "rigid_mass", "rigid_inertia", "rigid_x_G"
_LARGEST_ADDED = (
    0.9  # of the rigid mass: a simulator that adds the force of added mass a step late diverges at 1; chosen
)
_RIDGE = 1e-3  # weight of a coefficient's departure from truncation, for what the motions do not determine; chosen
_EVALUATIONS = 60  # rounds of the refit; chosen, it ends before
_DIVERGED_SIZE = 10.0  # of a residual, in rms values of its channel, where the projected craft runs away; chosen


@dataclass(frozen=True, eq=False)
class MotionError:
    """Heading error of a projected craft on one manoeuvre, rms in rad, refitted and truncated."""

    manoeuvre: str
    refitted: float
    truncated: float


@dataclass(frozen=True, eq=False)
class Projection:
    """Coefficients by tag, in the target's signs, refitted and truncated, and what both cost."""

    coefficients: Mapping[str, float]
    truncated: Mapping[str, float]
    rigid: RigidBody
    errors: tuple[MotionError, ...]
    run_errors: tuple[MotionError, ...] = ()


def project(
    file: ModelFile, structure: TargetStructure, records: Sequence[Record], runs: Sequence[Record] = ()
) -> Projection:
    """Return the coefficients refitted over records and runs, all of which the model of the file has simulated.

    Args:
        records: manoeuvres, on each of which the refit has to be better than truncation.
        runs: under the inputs of the training runs; together they weigh as much as the manoeuvres.

    Raises:
        InputError: the truncated and the refitted craft both run away.
    """
    rigid = rigid_body(file)
    assert rigid is not None
    model, truncated = file.model, truncation(file, structure, rigid, records)
    craft = _projected(model, structure, rigid)
    start = np.array(list(truncated.values()))
    first = _errors(craft, truncated, records)
    fitted = _refitted(craft, structure, rigid, start, records, runs)
    second = _errors(craft, dict(zip(truncated, fitted, strict=True)), records)
    if not math.fsum(second) < math.fsum(first) or any(b > a for a, b in zip(first, second, strict=True)):
        fitted, second = start, first
    if not math.isfinite(math.fsum(second)):
        raise InputError(f"model '{model.name}' projected onto the target runs away; the target cannot hold it")
    values = dict(zip(truncated, fitted.tolist(), strict=True))
    errors = tuple(MotionError(r.name, b, a) for r, a, b in zip(records, first, second, strict=True))
    run_errors = tuple(
        MotionError(r.name, b, a)
        for r, a, b in zip(runs, _errors(craft, truncated, runs), _errors(craft, values, runs), strict=True)
    )
    return Projection(values, truncated, rigid, errors, run_errors)


def _projected(model: Model, structure: TargetStructure, rigid: RigidBody) -> Model:
    """Return the model with the target's forces in place of hull, added mass and Coriolis terms."""
    tags = (*ADDED, *(t.tag for t in structure.terms))
    names = (_MASS, _INERTIA, _X_G, *tags)
    equations = stored_equations(
        (model.equation_hash, "projected", repr(structure)), lambda: _write(model, structure, names)
    )
    values: dict[str, float] = {_MASS: rigid.mass, _INERTIA: rigid.inertia, _X_G: rigid.x_G}
    extra = tuple(Parameter(n, values.get(n, 0.0), free=n in tags) for n in names)
    return Model(equations, Parameters((*model.parameters.fixed(*model.parameters.free_names), *extra)))


def _write(model: Model, structure: TargetStructure, names: tuple[str, ...]) -> ModelEquations:
    import sympy as sp

    def symbol(name: str) -> "sp.Symbol":
        return sp.Symbol(name, real=True)

    def factor(name: str) -> "sp.Expr":
        return sp.Integer(1) if not name else sp.Abs(symbol(name[1])) if name[0] == "|" else symbol(name)

    u, v, r, m, inertia, x_G = (symbol(n) for n in ("u", "v", "r", _MASS, _INERTIA, _X_G))
    A_x, A_y, A_r = (structure.added_mass_sign * symbol(n) for n in ADDED)
    force = {axis: symbol(f"{axis}_sum") - symbol(f"{axis}_H") for axis in "XYN"}
    for t in structure.terms:
        force[t.force] += t.sign * symbol(t.tag) * factor(t.first) * factor(t.second)
    added = 1 if structure.is_inertial else 0
    X = force["X"] + (m + added * A_x) * v * r + m * x_G * r**2
    Y = force["Y"] - (m + added * A_y) * u * r
    N = force["N"] - m * x_G * u * r
    M_v, M_r, M_c = m + A_y, inertia + m * x_G**2 + A_r, m * x_G
    D = M_v * M_r - M_c**2
    rates = {"u": X / (m + A_x), "v": (Y * M_r - N * M_c) / D, "r": (N * M_v - Y * M_c) / D}
    old = model.equations
    changed = tuple(b.bound_to(rates[b.name]) if b.name in rates else b for b in old.rates)
    return replace(old, name=f"{old.name} projected", rates=changed, parameters=(*old.parameters, *names))


def _motion(craft: Model, record: Record) -> Array:
    """Return u, v, r, psi of the craft under the record's inputs, (n, 4); NaN where it runs away."""
    start = np.array([record[s][0] for s in craft.states])
    states, _ = trajectory(craft, inputs_of(craft, record), record.dt, start)
    return states[:, [craft.states.index(s) for s in MOTION]]


def _errors(craft: Model, values: Mapping[str, float], records: Sequence[Record]) -> list[float]:
    """Rms error of the heading on each record, rad; infinite where the craft runs away."""
    moved = craft.with_values(values)
    headings = [_motion(moved, record)[:, -1] - record["psi"] for record in records]
    return [float(np.sqrt(np.mean(e**2))) if np.isfinite(e).all() else math.inf for e in headings]


def _refitted(
    craft: Model, structure: TargetStructure, rigid: RigidBody, start: Array, manoeuvres: Sequence[Record],
    runs: Sequence[Record],
) -> Array:  # fmt: skip
    from scipy.optimize import least_squares

    records = (*manoeuvres, *runs)
    weights = [1.0] * len(manoeuvres) + [math.sqrt(len(manoeuvres) / max(len(runs), 1))] * len(runs)
    wanted = [np.column_stack([record[s] for s in MOTION]) for record in records]
    scales = [np.sqrt(np.mean(w**2, axis=0)) + np.finfo(float).tiny for w in wanted]
    unit = np.abs(start) + _unit_sizes(structure, rigid, records)
    largest = np.array([rigid.mass, rigid.mass, rigid.inertia_at_origin]) * _LARGEST_ADDED
    lower, upper = np.full(len(start), -np.inf), np.full(len(start), np.inf)
    low, high = sorted((0.0, structure.added_mass_sign))
    lower[:3], upper[:3] = low * largest, high * largest
    for k, term in enumerate(structure.terms, start=3):
        if term.second == f"|{term.first}|":  # drag: what grows fastest must not drive the craft
            upper[k], lower[k] = (0.0, -np.inf) if term.sign > 0.0 else (np.inf, 0.0)
    names = craft.parameters.free_names

    def residuals(scaled: Array) -> Array:
        moved = craft.with_values(dict(zip(names, scaled * unit, strict=True)))
        parts = [
            weight * np.nan_to_num((_motion(moved, r) - w) / s, nan=_DIVERGED_SIZE) / math.sqrt(len(w))
            for r, w, s, weight in zip(records, wanted, scales, weights, strict=True)
        ]
        bounded = [np.clip(p, -_DIVERGED_SIZE, _DIVERGED_SIZE).ravel() for p in parts]
        return np.concatenate([*bounded, _RIDGE * (scaled - start / unit)])

    inner_start = np.clip(start, lower + 1e-9 * unit, upper - 1e-9 * unit)  # a hair inside, as the solver requires
    solution = least_squares(residuals, inner_start / unit, bounds=(lower / unit, upper / unit), max_nfev=_EVALUATIONS)
    return solution.x * unit


def _unit_sizes(structure: TargetStructure, rigid: RigidBody, records: Sequence[Record]) -> Array:
    """Size of each coefficient at which its term turns the craft within a few lengths: mass over length, and so on."""
    m, inertia = rigid.mass, rigid.inertia
    speed = float(np.max(np.abs(records[0]["u"])))
    rate = max(float(np.max(np.abs(record["r"]))) for record in records)
    typical = {"u": speed, "v": OFF_COURSE * speed, "r": rate, "": 1.0}
    force = {"X": OFF_COURSE * m * speed * rate, "Y": m * speed * rate, "N": inertia * rate**2}
    sizes = [m, m, inertia]
    sizes += [force[t.force] / (typical[t.first.strip("|")] * typical[t.second.strip("|")]) for t in structure.terms]
    return OFF_COURSE * np.array(sizes)
