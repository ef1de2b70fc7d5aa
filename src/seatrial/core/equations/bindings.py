"""What is written down of a model: inputs, named bindings, rates. Everything numeric is generated from it.

Expressions are kept in SymPy's own notation, so that a process whose code is in the compile cache never imports SymPy.
"""

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

from seatrial.core.values import NOTATION, quantity

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Binding:
    """A named expression with its source; a rate is a binding named after its state.

    Attributes:
        text: the expression as `sympy.srepr` writes it.
        source: where the expression is published.
        unit: of its value.
    """

    name: str
    text: str
    source: str = ""
    unit: str = "1"

    @classmethod
    def from_expression(cls, name: str, expression: "sp.Expr", source: str = "", unit: str = "1") -> Self:
        """Return the binding of a name to a SymPy expression."""
        import sympy as sp

        return cls(name, sp.srepr(expression), source, unit)

    def bound_to(self, expression: "sp.Expr") -> Self:
        """Return the same name, source and unit with another expression."""
        return replace(self, text=type(self).from_expression(self.name, expression).text)

    @cached_property
    def expression(self) -> "sp.Expr":
        """The SymPy expression."""
        from seatrial.core.equations.differentiate import parsed

        return parsed(self.text)


@dataclass(frozen=True)
class Input:
    """An input channel; `positive` is its positive direction where it differs from the notation table's.

    `is_held`: constant from sample to sample; straight between samples, or smooth in linear models, where it is not.
    """

    name: str
    positive: str = ""
    is_held: bool = False

    @property
    def direction(self) -> str:
        """The positive direction in force."""
        return self.positive or (quantity(self.name).positive if self.name in NOTATION else "none")

    @property
    def is_reversed(self) -> bool:
        """Whether it points against the notation table's positive direction."""
        return self.name in NOTATION and self.direction != quantity(self.name).positive


@dataclass(frozen=True)
class ModelEquations:
    """The equations of a model, whatever the values of its parameters; models that differ in values share them.

    Equal equations share their machine code, however often they are written.

    Attributes:
        rates: one binding a state, in the order of the states.
        outputs: names of bindings that can be measured, besides the states.
        parameters: names of all parameters, in order.
        sensors: text from which the instruments' outputs are written again, where the model has any.
        layout: text from which the registry writes the equations again, where a name alone does not (thrusters).
    """

    name: str
    source: str
    inputs: tuple[Input, ...]
    bindings: tuple[Binding, ...]
    rates: tuple[Binding, ...]
    outputs: tuple[str, ...]
    parameters: tuple[str, ...]
    meaning: str = ""
    layout: str = ""
    sensors: str = ""

    def __hash__(self) -> int:
        return hash(self.digest)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(rate.name for rate in self.rates)

    @property
    def input_names(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return tuple(i.name for i in self.inputs)

    @property
    def output_bindings(self) -> tuple[Binding, ...]:
        """The bindings of the outputs, in the order of `outputs`."""
        by_name = {b.name: b for b in self.bindings}
        return tuple(by_name[name] for name in self.outputs)

    @cached_property
    def is_affine(self) -> bool:
        """Whether rates and outputs are affine in states and inputs, so that exact propagators serve."""
        from seatrial.core.equations.differentiate import is_affine

        return is_affine(self)

    @cached_property
    def digest(self) -> str:
        """SHA-256 over names and expressions."""
        inputs = [f"{i.name} held" if i.is_held else i.name for i in self.inputs]
        lines = [self.name, *inputs, *self.outputs, *self.parameters]
        lines += [f"{b.name} = {b.text}" for b in self.bindings]
        lines += [f"d{b.name} = {b.text}" for b in self.rates]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()
