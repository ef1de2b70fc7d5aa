"""The equations along a record: each rate as known terms plus features times coefficients, from the model itself."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.numerics.kernels.sensitivity import evaluate_tangent
from seatrial.physics.simulate.replay import inputs_of
from seatrial.physics.simulate.states import hidden_states, measured_states

_PROBE_FACTOR = 1.37  # no round number, so that no term vanishes at the probe; chosen
_TIME_TOLERANCE = 1e-3  # of a sampling step, beyond which it is a gap


def demand_positive(name: str, value: float) -> None:
    """Refuse a setting that is not a positive number.

    Raises:
        InputError: naming it.
    """
    if not 0.0 < value < np.inf:
        raise InputError(f"{name} is {value:g}; give a positive number")


@dataclass(frozen=True, eq=False)
class RegressionMotion:
    """What a record says of a model: times (n,) [s], states (n, nx), inputs (n, nu) in the model's signs.

    Times may have gaps, where cleaning took samples away.
    """

    time: Array
    states: Array
    inputs: Array

    @classmethod
    def from_record(cls, model: Model, record: Record) -> Self:
        """The motion of a record; velocities that were not measured are derived where that can be done.

        Raises:
            InputError: a state is hidden, not derivable or without a value; an input is missing; too few samples.
        """
        if hidden := hidden_states(model, [record]):
            raise InputError(
                f"record '{record.name}' does not show {', '.join(hidden)}, states of model '{model.name}': "
                "regression needs every state; use output error (seatrial identify)"
            )
        if len(record) < 3:
            raise InputError(f"record '{record.name}' has {len(record)} samples; regression needs at least three")
        for state in model.states:
            if state in record and not np.isfinite(record[state]).all():
                raise InputError(
                    f"record '{record.name}': channel '{state}' has no value at sample "
                    f"{int(np.argmin(np.isfinite(record[state]))) + 1}; use regress.cleaning.without_missing first"
                )
        return cls(record.time, measured_states(model, record), inputs_of(model, record))

    @property
    def dt(self) -> float:
        """The usual time step [s]."""
        return float(np.median(np.diff(self.time)))

    def gapless_slices(self) -> list[slice]:
        """The stretches without a gap."""
        gaps = np.flatnonzero(np.abs(np.diff(self.time) - self.dt) > _TIME_TOLERANCE * self.dt) + 1
        return [slice(int(a), int(b)) for a, b in pairwise([0, *gaps, len(self.time)])]

    def rows(self, index: slice) -> Self:
        """The samples of a slice."""
        return type(self)(self.time[index], self.states[index], self.inputs[index])


@dataclass(frozen=True, eq=False)
class Features:
    """dx/dt = known_rates + slope theta: (n, nx), slope (n, nx, k), k the free coefficients of the model."""

    known_rates: Array
    slope: Array


def features(model: Model, motion: RegressionMotion) -> Features:
    """The features of every rate at every sample, from the generated Jacobian.

    Raises:
        InputError: the rates are not linear in the free coefficients.
    """
    values = model.parameters.values
    free = [model.parameters.index(n) for n in model.parameters.free_names]
    rates, slope = _tangent(model, motion, values)
    probe = values.copy()
    probe[free] = _PROBE_FACTOR * values[free] + np.where(values[free] == 0.0, 1.0, 0.0)
    moved = np.abs(_tangent(model, motion, probe)[1] - slope).max(axis=(0, 1))
    curved = np.flatnonzero(moved > 1e-9 * np.abs(slope).max(axis=(0, 1)))  # rounding; chosen
    if curved.size:
        named = ", ".join(model.parameters.free_names[i] for i in curved)
        raise InputError(
            f"model '{model.name}' is not linear in {named}, as regression needs: fix under [model] what multiplies or "
            "divides the others, or use output error"
        )
    return Features(rates - slope @ values[free], slope)


def _tangent(model: Model, motion: RegressionMotion, values: Array) -> tuple[Array, Array]:
    nx, nu, n = len(model.states), len(model.inputs), len(motion.time)
    rates, jacobian = np.empty((n, nx)), np.zeros((n, nx, nx + nu + len(values)))
    x, u = np.ascontiguousarray(motion.states), np.ascontiguousarray(motion.inputs)
    evaluate_tangent(model.compiled.rates_tangent, x, u, np.tile(values, (n, 1)), motion.dt, rates, jacobian)
    return rates, jacobian[:, :, [nx + nu + model.parameters.index(name) for name in model.parameters.free_names]]
