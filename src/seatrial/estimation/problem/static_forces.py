"""Static force points as least squares: total forces of the model at given motions against measured ones.

The model's forces are named bindings; their Jacobians are generated like all others. What a table includes decides
which bindings it is compared with:

    hull           X_H, Y_H, N_H
    hydrodynamic   X_sum, Y_sum, N_sum
    balance        X_m, Y_m, N_m: X_sum with the centripetal terms of masses and added masses
    pressure       the same, the centripetal terms of the mass added to the measured forces first
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Array, ForceContent, ForcePoints, InputError
from seatrial.core.values.ship import FORCES
from seatrial.estimation.problem.output_error import Contribution
from seatrial.numerics.kernels.integrate import evaluate, evaluate_tangent

_SUFFIX = {
    ForceContent.HULL: "H",
    ForceContent.HYDRODYNAMIC: "sum",
    ForceContent.PRESSURE: "m",
    ForceContent.BALANCE: "m",
}
_CALM_INPUTS = ("wind_speed", "wind_direction")


@dataclass(frozen=True, eq=False)
class StaticForces:
    """One table of points beside a model; a `DataTerm` of the output-error problem.

    Raises:
        InputError: the model names no such forces, an input it needs is not among the points, or its mass is free.
    """

    model: Model
    points: ForcePoints

    def __post_init__(self) -> None:
        model, points = self.model, self.points
        known = {b.name for b in model.bindings}
        if not set(self.force_names) <= known or not {"u", "v", "r"} <= set(model.states):
            raise InputError(
                f"model '{model.name}' has no forces {', '.join(self.force_names)} to compare the force points "
                f"'{points.name}' (includes = \"{points.includes}\") with; use mmg, or leave [[forces]] out"
            )
        absent = [n for n in model.input_names if n not in points.motion and n not in _CALM_INPUTS]
        if absent and points.includes is not ForceContent.HULL:
            raise InputError(
                f"force points '{points.name}' do not say '{absent[0]}', an input of model '{model.name}'; "
                f"give a column or a value for it under forces.motion"
            )
        for name in ("m", "x_G"):
            if points.includes is ForceContent.PRESSURE and name in model.parameters and model.parameters[name].free:
                raise InputError(
                    f"force points '{points.name}' without inertia need a known '{name}', which is free; fix it"
                )

    @property
    def force_names(self) -> tuple[str, ...]:
        """The model's forces that the points are compared with."""
        return tuple(f"{force}_{_SUFFIX[self.points.includes]}" for force in FORCES)

    @cached_property
    def _states(self) -> Array:
        rest = np.zeros(len(self.points))
        columns = [self.points.motion[s] if s in ("u", "v", "r") else rest for s in self.model.states]
        return np.ascontiguousarray(np.stack(columns, axis=1))

    @cached_property
    def _inputs(self) -> Array:
        rest, columns = np.zeros(len(self.points)), []
        for one in self.model.inputs:
            values = self.points.motion.get(one.name, rest)
            columns.append(-values if one.is_reversed and one.name in NOTATION else values)
        return np.ascontiguousarray(np.stack(columns, axis=1))

    @cached_property
    def _measured(self) -> Array:
        missing = np.full(len(self.points), np.nan)
        table = np.stack([self.points.forces.get(force, missing) for force in FORCES], axis=1)
        if self.points.includes is not ForceContent.PRESSURE:
            return table
        mass, x_G = (self.model.parameters.value_of(n, 0.0) for n in ("m", "x_G"))
        u, v, r = (self.points.motion[s] for s in ("u", "v", "r"))
        # rigid body at constant u, v, r (Yasukawa & Yoshimura 2015, equations of motion)
        return table + mass * np.stack([v * r + x_G * r**2, -u * r, -x_G * u * r], axis=1)

    @cached_property
    def _scale(self) -> Array:
        """One over the standard deviation of each force, (3,); 0 where it is not measured."""
        return 1.0 / np.array([self.points.sd.get(force, np.inf) for force in FORCES])

    def _scaled(self, forces: Array) -> Array:
        return np.where(np.isfinite(self._measured), (forces - self._measured) * self._scale, 0.0)

    def forces(self, values: Array) -> Array:
        """Return the model's X, Y [N], N [N m] at the points for these values of all parameters, shape (n, 3)."""
        columns = {b.name: i for i, b in enumerate(self.model.bindings)}
        out = np.empty((len(self.points), len(columns)))
        evaluate(self.model.compiled.bindings, self._states, self._inputs, values, 0.0, out)
        return out[:, [columns[n] for n in self.force_names]]

    def _linearised(self, values: Array) -> tuple[Array, Array]:
        rows, width = len(self.points), len(self.model.states) + len(self.model.inputs)
        out, jac = np.empty((rows, 3)), np.zeros((rows, 3, width + len(values)))
        tangent, every = self.model.compiled.tangent_function(self.force_names), np.tile(values, (rows, 1))
        evaluate_tangent(tangent, self._states, self._inputs, every, 0.0, out, jac)
        return out, jac[:, :, width:]

    def residuals(self, values: Array) -> dict[str, Array]:
        """Return model minus measured in standard deviations, for each measured force, (n,); NaN where nothing was."""
        gap = (self._linearised(values)[0] - self._measured) * self._scale
        return {force: gap[:, i] for i, force in enumerate(FORCES) if force in self.points.forces}

    def cost(self, values: Array) -> float:
        """Return half the weighted sum of squares."""
        return 0.5 * float(np.sum(self._scaled(self._linearised(values)[0]) ** 2))

    def normal(self, values: Array, free: Sequence[int]) -> Contribution:
        """Return the Gauss-Newton model by the parameters at the positions `free`."""
        residuals, rows = self.scaled_rows(values, free)
        return Contribution(0.5 * float(np.sum(residuals**2)), rows.T @ residuals.ravel(), rows.T @ rows)

    def scaled_rows(self, values: Array, free: Sequence[int]) -> tuple[Array, Array]:
        """Return weighted residuals (n, 3) and their derivatives (3 n, k) by the parameters at the positions `free`."""
        forces, jacobian = self._linearised(values)
        scaled = self._scaled(forces)
        rows = np.where(np.isfinite(self._measured)[:, :, None], jacobian[:, :, list(free)], 0.0)
        return scaled, (rows * self._scale[:, None]).reshape(scaled.size, -1)
