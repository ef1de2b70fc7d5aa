"""A model: states, inputs, outputs, parameters and equations, written once."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
import sympy as sp

from seatrial.kernels.integrate import evaluate
from seatrial.values import Array, InputError, Parameters, Ship, quantity
from seatrial.values.notation import NOTATION

if TYPE_CHECKING:
    from seatrial.equations.generate import Compiled


@dataclass(frozen=True)
class Binding:
    """A named expression with its source; a rate is a binding named after its state."""

    name: str
    expression: sp.Expr
    source: str = ""
    unit: str = "1"


@dataclass(frozen=True)
class Input:
    """An input channel; `positive` is its positive direction where it differs from the notation table's."""

    name: str
    positive: str = ""

    @property
    def direction(self) -> str:
        """The positive direction in force."""
        return self.positive or (quantity(self.name).positive if self.name in NOTATION else "none")


@dataclass(frozen=True)
class Model:
    """Equations with their parameters. Everything numeric is generated from `bindings` and `rates`.

    Attributes:
        inputs, bindings, rates: the equations; `rates` in the order of the states.
        outputs: names of bindings that can be measured, besides the states.
        parameters: all parameters, free and fixed.
    """

    name: str
    source: str
    inputs: tuple[Input, ...]
    bindings: tuple[Binding, ...]
    rates: tuple[Binding, ...]
    outputs: tuple[str, ...]
    parameters: Parameters
    meaning: str = ""

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(rate.name for rate in self.rates)

    @property
    def input_names(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return tuple(i.name for i in self.inputs)

    @property
    def observables(self) -> tuple[str, ...]:
        """Everything a record can be compared with: states, then measurable outputs."""
        return (*self.states, *self.outputs)

    @cached_property
    def equation_hash(self) -> str:
        """SHA-256 over names and expressions: what the equations are, whatever the parameter values."""
        lines = [self.name, *self.input_names, *self.outputs, *self.parameters.names]
        lines += [f"{b.name} = {sp.srepr(b.expression)}" for b in self.bindings]
        lines += [f"d{b.name} = {sp.srepr(b.expression)}" for b in self.rates]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()

    @cached_property
    def compiled(self) -> "Compiled":
        """The generated machine code: rates, outputs, bindings and exact Jacobians (cached between processes)."""
        from seatrial.equations.generate import compiled

        return compiled(self)

    def with_parameters(self, parameters: Parameters) -> Self:
        """The same equations with other parameters (same names, same order).

        Raises:
            InputError: the names differ.
        """
        if parameters.names != self.parameters.names:
            raise InputError(f"the parameters do not belong to model '{self.name}'")
        changed = replace(self, parameters=parameters)
        for name in ("equation_hash", "compiled"):
            if name in self.__dict__:
                changed.__dict__[name] = self.__dict__[name]
        return changed

    def with_values(self, values: Mapping[str, float], source: str | None = None) -> Self:
        """Other parameter values."""
        return self.with_parameters(self.parameters.with_values(values, source))

    def of_ship(self, ship: Ship) -> Self:
        """Particulars the model knows by name, taken from the ship.

        Raises:
            InputError: a parameter still has no value.
        """
        known = {n: v for n, v in ship.particulars.items() if n in self.parameters}
        model = self.with_values(known, source=ship.source or ship.name)
        if model.parameters.missing:
            names = ", ".join(model.parameters.missing)
            raise InputError(f"model '{self.name}' needs {names}; give them under [ship] or [model.fixed]")
        return model

    def forces(self, states: Array, inputs: Array) -> dict[str, Array]:
        """Every binding along a record: states (n, nx), inputs (n, nu) -> name -> (n,)."""
        out = np.empty((len(states), max(1, len(self.bindings))))
        evaluate(
            self.compiled.bindings,
            np.ascontiguousarray(states),
            np.ascontiguousarray(inputs),
            self.parameters.values,
            0.0,
            out,
        )
        return {b.name: out[:, i] for i, b in enumerate(self.bindings)}
