"""From equations to source text, binding by binding: functions with the project's fixed signatures.

The derivatives of one output are chained from it back to states, inputs and parameters, last binding first (reverse
accumulation): each binding's total is one line, so the text grows with the paper and never with its expansion.
"""

from collections.abc import Sequence

import sympy as sp

from seatrial.core.equations.bindings import Binding, ModelEquations
from seatrial.core.equations.differentiate import partials
from seatrial.core.equations.printer import CodeLines, mangled

_HEADER = '''"""Generated from the equations of model {name!r}; do not edit."""
import math
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import FUNCTION_SIGNATURE, LEAN, TANGENT_SIGNATURE
from seatrial.numerics.kernels.trigonometry import sincos

'''


def _signature(name: str, kind: str, arguments: str) -> list[str]:
    return [f"@kernel({kind}, **LEAN)", f"def {name}(t_, x, u, p, {arguments}):"]


def _unpack(equations: ModelEquations, expressions: Sequence[Binding]) -> list[str]:
    used = {str(s) for b in expressions for s in b.expression.free_symbols}
    sources = (("x", equations.states), ("u", equations.input_names), ("p", equations.parameters))
    return [f"    {mangled(n)} = {array}[{i}]" for array, names in sources for i, n in enumerate(names) if n in used]


def _required_bindings(equations: ModelEquations, wanted: Sequence[Binding]) -> list[Binding]:
    """The bindings that `wanted` rests on, in order."""
    names = {str(s) for b in wanted for s in b.expression.free_symbols} | {b.name for b in wanted}
    kept = []
    for binding in reversed(equations.bindings):
        if binding.name in names:
            kept.append(binding)
            names |= {str(s) for s in binding.expression.free_symbols}
    return kept[::-1]


def _function_lines(equations: ModelEquations, name: str, wanted: Sequence[Binding]) -> list[str]:
    needed = _required_bindings(equations, wanted)
    lines = CodeLines(_signature(name, "FUNCTION_SIGNATURE", "out") + _unpack(equations, [*needed, *wanted]))
    for b in needed:
        lines.assign(mangled(b.name), b.expression)
    bound = {b.name for b in needed}
    for i, b in enumerate(wanted):
        lines.assign(f"out[{i}]", sp.Symbol(b.name) if b.name in bound else b.expression)
    return [*lines.text, "    return", ""]


def _local_partials(lines: CodeLines, binding: Binding) -> dict[str, str]:
    """Append the local partial derivatives of a binding; return the text of each, by symbol."""
    name, texts = binding.name, {}
    for symbol, value in partials(binding.expression).items():
        if value.is_number or value.is_Symbol:
            texts[symbol] = lines.expression(value)
        else:
            texts[symbol] = f"q{len(name)}_{name}_{symbol}"
            lines.assign(texts[symbol], value)
    return texts


def _product(first: str, second: str) -> str:
    return "*".join(text for text in (first, second) if text != "1.0") or "1.0"


def _adjoint_row(
    lines: CodeLines, row: int, seed: dict[str, str], needed: Sequence[Binding], local: dict[str, dict[str, str]]
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


def _tangent_lines(
    equations: ModelEquations, name: str, wanted: Sequence[Binding]
) -> tuple[list[str], list[tuple[int, int]]]:
    base = (*equations.states, *equations.input_names, *equations.parameters)
    needed = _required_bindings(equations, wanted)
    lines = CodeLines(_signature(name, "TANGENT_SIGNATURE", "out, jac") + _unpack(equations, [*needed, *wanted]))
    local = {}
    for b in needed:
        lines.assign(mangled(b.name), b.expression)
        local[b.name] = _local_partials(lines, b)
    pattern = []
    for row, b in enumerate(wanted):
        output = Binding.from_expression(f"out{row}", sp.Symbol(b.name, real=True) if b.name in local else b.expression)
        lines.assign(f"out[{row}]", output.expression)
        slopes = _adjoint_row(lines, row, _local_partials(lines, output), needed, local)
        for column, z in enumerate(base):
            if z in slopes:
                pattern.append((row, column))
                lines.text.append(f"    jac[{row}, {column}] = {slopes[z]}")
    return [*lines.text, "    return", ""], pattern


def source_text(equations: ModelEquations) -> str:
    """Return the generated module as text; the same equations give the same text in every process."""
    rates_tangent, rates_pattern = _tangent_lines(equations, "rates_tangent", equations.rates)
    outputs_tangent, outputs_pattern = _tangent_lines(equations, "outputs_tangent", equations.output_bindings)
    lines = [
        *_function_lines(equations, "rates", equations.rates),
        *rates_tangent,
        *_function_lines(equations, "outputs", equations.output_bindings),
        *outputs_tangent,
        f"RATES_PATTERN = {sorted(rates_pattern)}",
        f"OUTPUTS_PATTERN = {sorted(outputs_pattern)}",
        "",
    ]
    return _HEADER.format(name=equations.name) + "\n".join(lines)


def bindings_text(equations: ModelEquations) -> str:
    """Return the module of the breakdown of forces as text."""
    return _HEADER.format(name=equations.name) + "\n".join(_function_lines(equations, "bindings", equations.bindings))


def tangent_text(equations: ModelEquations, names: Sequence[str]) -> str:
    """Return the module of some bindings with their exact Jacobians as text."""
    wanted = [b for name in names for b in equations.bindings if b.name == name]
    return _HEADER.format(name=equations.name) + "\n".join(_tangent_lines(equations, "tangent", wanted)[0])
