"""Machine code of a set of equations: generated modules in the compile cache, their functions compiled at first use.

The main module holds four functions with the project's fixed signatures: `rates`, `rates_tangent`, `outputs` and
`outputs_tangent`; `bindings`, for the breakdown of forces, and `tangent_function` of some of them are in modules of
their own.
"""

import hashlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import ModuleType

import numpy as np

from seatrial.core.equations.bindings import ModelEquations
from seatrial.core.equations.stored import entry_key
from seatrial.core.values import Index
from seatrial.numerics.kernels.cache import entry_path, read_entry, write_entry

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
