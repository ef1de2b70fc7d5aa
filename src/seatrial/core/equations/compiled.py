"""Machine code of a set of equations: one generated module, compiled once a machine.

The module holds four functions with the project's fixed signatures: `rates`, `rates_tangent`, `outputs` and
`outputs_tangent`; `bindings`, for the breakdown of forces, and `tangent_of` some of them are modules of their own,
compiled when they are asked for.
They lie in the cache folder under the hash of their text.
"""

import hashlib
import importlib.util
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from types import ModuleType

import numpy as np

from seatrial.core.equations.bindings import ModelEquations
from seatrial.core.equations.generate import bindings_text, source_text, tangent_text
from seatrial.core.values import Index
from seatrial.core.values.files import write_atomically
from seatrial.numerics.kernels.cache import cache_folder

# of everything that decides how the text comes about: a changed generator finds no old index
_GENERATOR = hashlib.sha256(b"".join(p.read_bytes() for p in sorted(Path(__file__).parent.glob("*.py")))).hexdigest()


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

    @cached_property
    def bindings(self) -> Callable[..., None]:
        """Every binding in order: the breakdown of forces."""
        return _load_or_generate(self.equations, "bindings", bindings_text).bindings

    def tangent_function(self, names: tuple[str, ...]) -> Callable[..., None]:
        """The named bindings, in that order, with their exact Jacobians by [x | u | p]."""
        return _load_or_generate(
            self.equations, "_".join(("tangent", *names)), lambda e: tangent_text(e, names)
        ).tangent


def _write_module(text: str) -> Path:
    path = cache_folder() / "generated" / f"model_{hashlib.sha256(text.encode()).hexdigest()[:24]}.py"
    if not path.exists():
        write_atomically(path, text.encode())
    return path


@lru_cache(maxsize=64)
def _load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def is_cached(equations: ModelEquations) -> bool:
    """Whether the generated module lies in the cache folder, and so its machine code."""
    return _index_path(equations, "index").exists()


def _index_path(equations: ModelEquations, kind: str) -> Path:
    return cache_folder() / "generated" / f"{kind}_{_GENERATOR[:12]}_{equations.digest[:24]}.txt"


def _load_or_generate(equations: ModelEquations, kind: str, text: Callable[[ModelEquations], str]) -> ModuleType:
    """The generated module; the index from equation hash to module spares generating the text again."""
    index = _index_path(equations, kind)
    if index.exists():
        path = index.parent / index.read_text(encoding="utf-8").strip()
        if path.exists():
            return _load(path)
    path = _write_module(text(equations))
    write_atomically(index, path.name.encode())
    return _load(path)


@lru_cache(maxsize=64)
def compile_equations(equations: ModelEquations) -> CompiledEquations:
    """Generate, load and compile the functions of a set of equations."""
    module = _load_or_generate(equations, "index", source_text)

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
