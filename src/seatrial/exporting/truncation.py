"""The coefficients that a model itself has for the terms of another simulator, at its approach speed."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.data.folder.model_file import ModelFile
from seatrial.exporting.target_structure import ADDED, OFF_COURSE, RigidBody, TargetStructure
from seatrial.numerics.kernels.integrate import evaluate
from seatrial.physics.simulate.replay import inputs_of

_SMALL = 1e-3  # v over u, and L r over u, at which linear terms are read off the model; chosen


def truncation(
    file: ModelFile, structure: TargetStructure, rigid: RigidBody, records: Sequence[Record]
) -> dict[str, float]:
    """Return the coefficients that the model itself has for the target's terms, at its approach speed."""
    model, speed = file.model, float(records[0]["u"][0]) or 1.0
    length = model.parameters["L"].value if "L" in model.parameters else 1.0
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
