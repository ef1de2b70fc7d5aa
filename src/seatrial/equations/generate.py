"""From equations to machine code: one generated module for each set of equations, compiled once a machine.

The module holds four functions with the project's fixed signatures: `rates`, `rates_tangent`, `outputs` and
`outputs_tangent`; `bindings`, for the breakdown of forces, is a module of its own, compiled when it is asked for.
They lie in the cache folder under the hash of their text.
"""

# SymPy annotates its printers and `args` too narrowly:
# pyright: reportIncompatibleMethodOverride=false, reportAttributeAccessIssue=false, reportGeneralTypeIssues=false
# pyright: reportArgumentType=false, reportReturnType=false

import hashlib
import importlib.util
import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from types import ModuleType

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.printing.pycode import PythonCodePrinter

from seatrial.equations.differentiate import partials
from seatrial.equations.model import Binding, Model
from seatrial.kernels.cache import cache_folder

Pattern = NDArray[np.int64]


@dataclass(frozen=True)
class Compiled:
    """Functions of one model and the structural nonzeros of their Jacobians, (row, column) with columns [x | u | p]."""

    model: Model
    rates: Callable[..., None]
    rates_tangent: Callable[..., None]
    outputs: Callable[..., None]
    outputs_tangent: Callable[..., None]
    rates_pattern: Pattern
    outputs_pattern: Pattern

    @cached_property
    def bindings(self) -> Callable[..., None]:
        """Every binding in order: the breakdown of forces."""
        return _module(self.model, "bindings", bindings_text).bindings


class _Printer(PythonCodePrinter):
    """SymPy to scalar Python for Numba: integer powers as products, sign by copysign, Piecewise as conditionals."""

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        return mangled(expr.name)

    def _print_Pow(self, expr: sp.Pow, **_: object) -> str:
        base, exponent = expr.as_base_exp()
        text = self._print(base)
        if exponent == sp.Rational(1, 2):
            return f"math.sqrt({text})"
        if exponent == -sp.Rational(1, 2):
            return f"(1.0/math.sqrt({text}))"
        if exponent.is_Integer and 1 <= abs(int(exponent)) <= 8:
            product = "*".join([f"({text})"] * abs(int(exponent)))
            return f"({product})" if exponent > 0 else f"(1.0/({product}))"
        return f"({text})**({self._print(exponent)})"

    def _print_Mul(self, expr: sp.Mul) -> str:
        # reciprocals as factors: 1/(m + m_x) waits for nothing, a quotient would wait for its numerator
        return "*".join(f"({self._print(factor)})" for factor in expr.args)

    def _print_Integer(self, expr: sp.Integer) -> str:
        return f"{int(expr)}.0"

    def _print_Rational(self, expr: sp.Rational) -> str:
        return repr(float(expr))

    def _print_Float(self, expr: sp.Float) -> str:
        return repr(float(expr))

    def _print_Abs(self, expr: sp.Abs) -> str:
        return f"abs({self._print(expr.args[0])})"

    def _print_sign(self, expr: sp.sign) -> str:
        return f"math.copysign(1.0, {self._print(expr.args[0])})"

    def _print_Piecewise(self, expr: sp.Piecewise) -> str:
        text = self._print(expr.args[-1].expr)
        for value, condition in reversed(expr.args[:-1]):
            text = f"({self._print(value)} if {self._print(condition)} else {text})"
        return text


class _Lines:
    """Lines of one generated function; every angle's sine and cosine are computed once, before their first use."""

    def __init__(self, first: Sequence[str]) -> None:
        self.text = list(first)
        self._angles: dict[sp.Expr, int] = {}
        self._printer = _Printer({"fully_qualified_modules": True})

    def expression(self, value: sp.Expr) -> str:
        """The text of an expression, after the sines and cosines it needs."""
        replaced = {}
        for call in sorted(value.atoms(sp.sin, sp.cos), key=sp.default_sort_key):
            angle = call.args[0]
            if angle not in self._angles:
                text = self.expression(angle)
                k = self._angles[angle] = len(self._angles)
                self.text.append(f"    {mangled(f'sin__{k}')}, {mangled(f'cos__{k}')} = sincos({text})")
            replaced[call] = sp.Symbol(f"{call.func.__name__}__{self._angles[angle]}", real=True)
        return self._printer.doprint(value.xreplace(replaced))

    def assign(self, target: str, value: sp.Expr) -> None:
        """Append `target = value`."""
        text = self.expression(value)
        self.text.append(f"    {target} = {text}")


def mangled(name: str) -> str:
    """A Python name that cannot collide with a keyword or with the generated code's own."""
    return f"{name}_"


_HEADER = '''"""Generated from the equations of model {name!r}; do not edit."""
import math
from numba import njit
from seatrial.kernels.types import FUNCTION_SIGNATURE, OPTIONS, TANGENT_SIGNATURE
from seatrial.kernels.trigonometry import sincos

'''


def _signature(name: str, kind: str, arguments: str) -> list[str]:
    return [f"@njit({kind}, **OPTIONS)", f"def {name}(t_, x, u, p, {arguments}):"]


def _unpack(model: Model, expressions: Sequence[Binding]) -> list[str]:
    used = {str(s) for b in expressions for s in b.expression.free_symbols}
    sources = (("x", model.states), ("u", model.input_names), ("p", model.parameters.names))
    return [f"    {mangled(n)} = {array}[{i}]" for array, names in sources for i, n in enumerate(names) if n in used]


def _needed(model: Model, wanted: Sequence[Binding]) -> list[Binding]:
    """The bindings that `wanted` rests on, in order."""
    names = {str(s) for b in wanted for s in b.expression.free_symbols} | {b.name for b in wanted}
    kept = []
    for binding in reversed(model.bindings):
        if binding.name in names:
            kept.append(binding)
            names |= {str(s) for s in binding.expression.free_symbols}
    return kept[::-1]


def _function(model: Model, name: str, wanted: Sequence[Binding]) -> list[str]:
    needed = _needed(model, wanted)
    lines = _Lines(_signature(name, "FUNCTION_SIGNATURE", "out") + _unpack(model, [*needed, *wanted]))
    for b in needed:
        lines.assign(mangled(b.name), b.expression)
    bound = {b.name for b in needed}
    for i, b in enumerate(wanted):
        lines.assign(f"out[{i}]", sp.Symbol(b.name) if b.name in bound else b.expression)
    return [*lines.text, "    return", ""]


def _factors(lines: _Lines, binding: Binding) -> dict[str, str]:
    """Append the local partial derivatives of a binding; return the text of each, by symbol."""
    name, texts = binding.name, {}
    for symbol, value in partials(binding.expression).items():
        if value.is_number or value.is_Symbol:
            texts[symbol] = lines.expression(value)
        else:
            texts[symbol] = f"q{len(name)}_{name}_{symbol}"
            lines.assign(texts[symbol], value)
    return texts


def _product(left: str, right: str) -> str:
    return "*".join(text for text in (left, right) if text != "1.0") or "1.0"


def _adjoint_row(
    lines: _Lines, row: int, seed: dict[str, str], needed: Sequence[Binding], local: dict[str, dict[str, str]]
) -> dict[str, str]:
    """Append the derivatives of one output by each binding, last to first; return those by states, inputs, parameters.

    seed: derivatives of the output by the symbols of its own expression; local: those of each binding.
    """
    flow = {symbol: [text] for symbol, text in seed.items()}
    for binding in reversed(needed):
        terms = flow.pop(binding.name, [])
        if not terms:
            continue
        total = terms[0]
        if len(terms) > 1 or not total.isidentifier():
            total = f"a{len(binding.name)}_{binding.name}_{row}"
            lines.text.append(f"    {total} = {' + '.join(terms)}")
        for symbol, text in local[binding.name].items():
            flow.setdefault(symbol, []).append(_product(total, text))
    return {symbol: " + ".join(terms) for symbol, terms in flow.items()}


def _tangent(model: Model, name: str, wanted: Sequence[Binding]) -> tuple[list[str], list[tuple[int, int]]]:
    base = (*model.states, *model.input_names, *model.parameters.names)
    needed = _needed(model, wanted)
    lines = _Lines(_signature(name, "TANGENT_SIGNATURE", "out, jac") + _unpack(model, [*needed, *wanted]))
    local = {}
    for b in needed:
        lines.assign(mangled(b.name), b.expression)
        local[b.name] = _factors(lines, b)
    pattern = []
    for row, b in enumerate(wanted):
        output = Binding(f"out{row}", sp.Symbol(b.name, real=True) if b.name in local else b.expression)
        lines.assign(f"out[{row}]", output.expression)
        slopes = _adjoint_row(lines, row, _factors(lines, output), needed, local)
        for column, z in enumerate(base):
            if z in slopes:
                pattern.append((row, column))
                lines.text.append(f"    jac[{row}, {column}] = {slopes[z]}")
    return [*lines.text, "    return", ""], pattern


def source_text(model: Model) -> str:
    """The generated module as text; the same equations give the same text in every process."""
    outputs = [b for b in model.bindings if b.name in model.outputs]
    outputs.sort(key=lambda b: model.outputs.index(b.name))
    rates_tangent, rates_pattern = _tangent(model, "rates_tangent", model.rates)
    outputs_tangent, outputs_pattern = _tangent(model, "outputs_tangent", outputs)
    lines = [
        *_function(model, "rates", model.rates),
        *rates_tangent,
        *_function(model, "outputs", outputs),
        *outputs_tangent,
        f"RATES_PATTERN = {sorted(rates_pattern)}",
        f"OUTPUTS_PATTERN = {sorted(outputs_pattern)}",
        "",
    ]
    return _HEADER.format(name=model.name) + "\n".join(lines)


def bindings_text(model: Model) -> str:
    """The module of the breakdown of forces as text."""
    return _HEADER.format(name=model.name) + "\n".join(_function(model, "bindings", model.bindings))


def _written(text: str) -> Path:
    folder = cache_folder() / "generated"
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"model_{hashlib.sha256(text.encode()).hexdigest()[:24]}.py"
    if not path.exists():
        handle, temporary = tempfile.mkstemp(dir=folder, suffix=".tmp")
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(temporary).replace(path)
    return path


@lru_cache(maxsize=64)
def _load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def _module(model: Model, kind: str, text: Callable[[Model], str]) -> ModuleType:
    """The generated module; the index from equation hash to module spares generating the text again."""
    folder = cache_folder() / "generated"
    index = folder / f"{kind}_{_GENERATOR}_{model.equation_hash[:24]}.txt"
    if index.exists():
        path = folder / index.read_text(encoding="utf-8").strip()
        if path.exists():
            return _load(path)
    path = _written(text(model))
    temporary = index.with_suffix(f".{os.getpid()}.tmp")
    temporary.write_text(path.name, encoding="utf-8")
    temporary.replace(index)
    return _load(path)


_GENERATOR = hashlib.sha256(
    Path(__file__).read_bytes() + Path(__file__).with_name("differentiate.py").read_bytes()
).hexdigest()[:12]


def compiled(model: Model) -> Compiled:
    """Generate, load and compile the model's functions."""
    module = _module(model, "index", source_text)

    def table(pairs: list[tuple[int, int]]) -> Pattern:
        return np.array(pairs, dtype=np.int64).reshape(-1, 2)

    return Compiled(
        model,
        module.rates,
        module.rates_tangent,
        module.outputs,
        module.outputs_tangent,
        table(module.RATES_PATTERN),
        table(module.OUTPUTS_PATTERN),
    )
