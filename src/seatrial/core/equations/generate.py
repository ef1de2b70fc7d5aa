"""From equations to source text, binding by binding: functions with the project's fixed signatures.

The derivatives of one output are chained from it back to states, inputs and parameters, last binding first (reverse
accumulation): each binding's total is one line, so the text grows with the paper and never with its expansion.
"""

import re
from collections.abc import Sequence

import sympy as sp

from seatrial.core.equations.bindings import Binding, ModelEquations
from seatrial.core.equations.differentiate import partials
from seatrial.core.equations.printer import Assignment, CodeBlock, Dialect, mangled

_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_HEADER = '''"""Generated from the equations of model {name!r}; do not edit."""
import math
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import FUNCTION_SIGNATURE, LEAN, TANGENT_SIGNATURE
from seatrial.numerics.kernels.trigonometry import sincos

'''


def _numba_function(name: str, kind: str, arguments: str, assignments: Sequence[Assignment]) -> list[str]:
    lines = [f"@kernel({kind}, **LEAN)", f"def {name}(t_, x, u, p, {arguments}):"]
    return [*lines, *(f"    {a.target} = {a.text}" for a in assignments), "    return", ""]


def _unpack(block: CodeBlock, equations: ModelEquations, expressions: Sequence[Binding]) -> None:
    """Append the assignments of the states, inputs and parameters that the expressions use."""
    used = {str(s) for b in expressions for s in b.expression.free_symbols}
    sources = (("x", equations.states), ("u", equations.input_names), ("p", equations.parameters))
    block.assignments += [
        Assignment(mangled(n), block.dialect.element(array, i, n))
        for array, names in sources
        for i, n in enumerate(names)
        if n in used
    ]


def _required_bindings(equations: ModelEquations, wanted: Sequence[Binding]) -> list[Binding]:
    """The bindings that `wanted` rests on, in order."""
    names = {str(s) for b in wanted for s in b.expression.free_symbols} | {b.name for b in wanted}
    kept = []
    for binding in reversed(equations.bindings):
        if binding.name in names:
            kept.append(binding)
            names |= {str(s) for s in binding.expression.free_symbols}
    return kept[::-1]


def function_assignments(equations: ModelEquations, wanted: Sequence[Binding], dialect: Dialect) -> list[Assignment]:
    """Return the body of a function whose `out` holds the wanted bindings or rates, in order."""
    needed = _required_bindings(equations, wanted)
    block = CodeBlock(dialect)
    _unpack(block, equations, [*needed, *wanted])
    for b in needed:
        block.assign(mangled(b.name), b.expression)
    bound = {b.name for b in needed}
    for i, b in enumerate(wanted):
        block.assign(dialect.element("out", i, b.name), sp.Symbol(b.name) if b.name in bound else b.expression)
    return block.assignments


def _local_partials(block: CodeBlock, binding: Binding) -> dict[str, str]:
    """Append the local partial derivatives of a binding; return the text of each, by symbol."""
    name, texts = binding.name, {}
    for symbol, value in partials(binding.expression).items():
        if value.is_number or value.is_Symbol:
            texts[symbol] = block.expression(value)
        else:
            texts[symbol] = f"q{len(name)}_{name}_{symbol}"
            block.assign(texts[symbol], value)
    return texts


def _product(first: str, second: str) -> str:
    return "*".join(text for text in (first, second) if text != "1.0") or "1.0"


def _adjoint_row(
    block: CodeBlock, row: int, seed: dict[str, str], needed: Sequence[Binding], local: dict[str, dict[str, str]]
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
            block.assignments.append(Assignment(total, " + ".join(terms)))
        for symbol, text in local[binding.name].items():
            flow.setdefault(symbol, []).append(_product(total, text))
    return {symbol: " + ".join(terms) for symbol, terms in flow.items()}


def tangent_assignments(
    equations: ModelEquations, wanted: Sequence[Binding], dialect: Dialect
) -> tuple[list[Assignment], list[tuple[int, int]]]:
    """Return the body of the function with its Jacobian `jac`, and the entries (row, column) that are not zero."""
    base = (*equations.states, *equations.input_names, *equations.parameters)
    needed = _required_bindings(equations, wanted)
    block = CodeBlock(dialect)
    _unpack(block, equations, [*needed, *wanted])
    local = {}
    for b in needed:
        block.assign(mangled(b.name), b.expression)
        local[b.name] = _local_partials(block, b)
    pattern = []
    for row, b in enumerate(wanted):
        output = Binding.from_expression(f"out{row}", sp.Symbol(b.name, real=True) if b.name in local else b.expression)
        block.assign(dialect.element("out", row, b.name), output.expression)
        slopes = _adjoint_row(block, row, _local_partials(block, output), needed, local)
        for column, z in enumerate(base):
            if z in slopes:
                pattern.append((row, column))
                block.assignments.append(Assignment(dialect.entry(row, column, len(base)), slopes[z]))
    return block.assignments, pattern


def live_assignments(assignments: Sequence[Assignment]) -> list[Assignment]:
    """Return those that an element of an array rests on, in order: compilers of C warn of others."""
    used: set[str] = set()
    kept = []
    for assignment in reversed(assignments):
        if not assignment.target.isidentifier() or assignment.target in used:
            kept.append(assignment)
            used |= set(_IDENTIFIER.findall(assignment.text))
    return kept[::-1]


def _function_lines(equations: ModelEquations, name: str, wanted: Sequence[Binding]) -> list[str]:
    assignments = function_assignments(equations, wanted, Dialect())
    return _numba_function(name, "FUNCTION_SIGNATURE", "out", assignments)


def _tangent_lines(
    equations: ModelEquations, name: str, wanted: Sequence[Binding]
) -> tuple[list[str], list[tuple[int, int]]]:
    assignments, pattern = tangent_assignments(equations, wanted, Dialect())
    return _numba_function(name, "TANGENT_SIGNATURE", "out, jac", assignments), pattern


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
