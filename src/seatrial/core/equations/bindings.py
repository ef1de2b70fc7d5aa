"""What is written down of a model, and its machine code: everything numeric is generated from bindings."""

import hashlib
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from importlib.metadata import version
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from seatrial.core.values import NOTATION, Index, quantity
from seatrial.numerics.kernels.cache import discard_entry, entry_path, read_entry, source_digest, write_entry

if TYPE_CHECKING:
    import sympy as sp


# What was worked out once about equations, as JSON in the compile cache: a warm process neither repeats it nor needs

_HERE = Path(__file__).parent


def entry_key(key: Sequence[object], sources: Sequence[Path] = ()) -> str:
    """Return 24 hexadecimal digits for a question and all source text that decides its answer.

    key: values whose `repr` is the same in every process. sources: folders of Python files, besides this one.
    """
    digests = [source_digest(folder) for folder in (_HERE, *sources)]
    facts = repr((tuple(key), version("sympy"))).encode()
    return hashlib.sha256(b"\0".join((facts, *digests))).hexdigest()[:24]


def stored(kind: str, key: Sequence[object], work_out: Callable[[], Any], sources: Sequence[Path] = ()) -> Any:
    """Return a JSON value from the compile cache, or work it out and keep it there.

    kind: first part of the entry's name. key, sources: as for `entry_key`.
    """
    name = f"{kind}-{entry_key(key, sources)}.json"
    content = read_entry(name)
    if content is not None:
        try:
            return json.loads(content)
        except ValueError as error:
            discard_entry(name, str(error))
    content = json.dumps(work_out()).encode()
    write_entry(name, content)
    return json.loads(content)


# What is written down of a model: inputs, named bindings, rates. Everything numeric is generated from it.


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
        from seatrial.core.equations.generate import parsed

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

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(rate.name for rate in self.rates)

    @cached_property
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
        from seatrial.core.equations.generate import is_affine

        return is_affine(self)

    @cached_property
    def digest(self) -> str:
        """SHA-256 over names and expressions."""
        inputs = [f"{i.name} held" if i.is_held else i.name for i in self.inputs]
        lines = [self.name, *inputs, *self.outputs, *self.parameters]
        lines += [f"{b.name} = {b.text}" for b in self.bindings]
        lines += [f"d{b.name} = {b.text}" for b in self.rates]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


# Machine code of a set of equations: generated modules in the compile cache, their functions compiled at first use.

_MAIN = ("main",)  # kind of the module with the four functions


@dataclass(frozen=True)
class CompiledEquations:
    """Functions of one set of equations.

    Attributes:
        rates_pattern, outputs_pattern: structural nonzeros of their Jacobians, (row, column) with columns [x | u | p].
    """

    equations: ModelEquations
    rates: Callable[..., None]
    rates_tangent: Callable[..., None]
    outputs: Callable[..., None]
    outputs_tangent: Callable[..., None]
    rates_pattern: Index
    outputs_pattern: Index

    def load(self) -> None:
        """Load or compile the four functions now."""
        from seatrial.numerics.kernels.kernel import load_kernels

        load_kernels(sys.modules[self.rates.__module__])

    @cached_property
    def bindings(self) -> Callable[..., None]:
        """Every binding in order: the breakdown of forces."""

        def text() -> str:
            from seatrial.core.equations.generate import bindings_text

            return bindings_text(self.equations)

        return _load_or_generate(self.equations, ("bindings",), text).bindings

    def tangent_function(self, names: tuple[str, ...]) -> Callable[..., None]:
        """Return the function of the named bindings, in that order, with their exact Jacobians by [x | u | p]."""

        def text() -> str:
            from seatrial.core.equations.generate import tangent_text

            return tangent_text(self.equations, names)

        return _load_or_generate(self.equations, ("tangent", *names), text).tangent


def is_cached(equations: ModelEquations) -> bool:
    """Return whether the generated module lies in the compile cache, and so its machine code."""
    return entry_path(_entry_name(equations, _MAIN)).exists()


def _entry_name(equations: ModelEquations, kind: tuple[str, ...]) -> str:
    return f"model_{entry_key((equations.digest, *kind))}.py"


def _load_or_generate(equations: ModelEquations, kind: tuple[str, ...], text: Callable[[], str]) -> ModuleType:
    """The generated module of that kind; its text is generated where the cache has none."""
    name = _entry_name(equations, kind)
    content = read_entry(name)
    if content is None:
        content = text().encode()
        write_entry(name, content)
    module = ModuleType(name.removesuffix(".py"))
    vars(module)["SOURCE_DIGEST"] = hashlib.sha256(content).digest()  # decides its machine code, see `kernel`
    sys.modules[module.__name__] = module
    exec(compile(content, str(entry_path(name)), "exec"), vars(module))
    return module


@lru_cache(maxsize=64)  # models kept in a process; chosen
def compile_equations(equations: ModelEquations) -> CompiledEquations:
    """Return the functions of a set of equations, generated where the cache does not hold them."""

    def text() -> str:
        from seatrial.core.equations.generate import source_text

        return source_text(equations)

    module = _load_or_generate(equations, _MAIN, text)

    def table(pairs: list[tuple[int, int]]) -> Index:
        return np.array(pairs, dtype=np.int64).reshape(-1, 2)

    return CompiledEquations(
        equations,
        module.rates,
        module.rates_tangent,
        module.outputs,
        module.outputs_tangent,
        table(module.RATES_PATTERN),
        table(module.OUTPUTS_PATTERN),
    )
