"""What is written down of a model: inputs, named bindings, rates. Everything numeric is generated from it."""

import hashlib
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from seatrial.values import NOTATION, quantity


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

    @property
    def is_turned(self) -> bool:
        """Whether it points against the notation table's positive direction."""
        return self.name in NOTATION and self.direction != quantity(self.name).positive


@dataclass(frozen=True, eq=False)
class Equations:
    """The equations of a model, whatever the values of its parameters; models that differ in values share them.

    Attributes:
        rates: one binding a state, in the order of the states.
        outputs: names of bindings that can be measured, besides the states.
        parameters: names of all parameters, in order.
    """

    name: str
    source: str
    inputs: tuple[Input, ...]
    bindings: tuple[Binding, ...]
    rates: tuple[Binding, ...]
    outputs: tuple[str, ...]
    parameters: tuple[str, ...]
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
    def measurable(self) -> tuple[Binding, ...]:
        """The bindings of the outputs, in the order of `outputs`."""
        by_name = {b.name: b for b in self.bindings}
        return tuple(by_name[name] for name in self.outputs)

    @cached_property
    def digest(self) -> str:
        """SHA-256 over names and expressions."""
        lines = [self.name, *self.input_names, *self.outputs, *self.parameters]
        lines += [f"{b.name} = {sp.srepr(b.expression)}" for b in self.bindings]
        lines += [f"d{b.name} = {sp.srepr(b.expression)}" for b in self.rates]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()
