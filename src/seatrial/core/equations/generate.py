"""From equations to source text, binding by binding: partials, scalar code in every language, functions."""

# SymPy annotates its printers and `args` too narrowly:
# pyright: reportIncompatibleMethodOverride=false, reportAttributeAccessIssue=false, reportGeneralTypeIssues=false
# pyright: reportArgumentType=false, reportReturnType=false

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import sympy as sp
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.printing.c import C99CodePrinter
from sympy.printing.codeprinter import CodePrinter
from sympy.printing.jscode import JavascriptCodePrinter
from sympy.printing.octave import OctaveCodePrinter
from sympy.printing.pycode import PythonCodePrinter

from seatrial.core.equations.bindings import Binding, ModelEquations

# Differentiation binding by binding: partials of one small expression, never of the whole.

# names that `sympy.srepr` writes: all of SymPy's own, and one that it does not export
_NAMES = {**vars(sp), "ExprCondPair": ExprCondPair}


def parsed(text: str) -> sp.Expr:
    """Return the expression that `sympy.srepr` wrote; the text is executed, so it must come from here."""
    return cast(sp.Expr, eval(text, dict(_NAMES)))


def partial(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """Return d expression / d symbol with d|x| = sign and d sign = 0."""
    derivative = sp.diff(expression, symbol)
    plain = derivative.replace(sp.DiracDelta, lambda *_: sp.Integer(0)).replace(
        lambda e: isinstance(e, sp.Derivative), lambda _: sp.Integer(0)
    )
    return cast(sp.Expr, plain)


def partials(expression: sp.Expr) -> dict[str, sp.Expr]:
    """Return symbol name -> partial derivative, where it is not zero; symbols in the order of their names."""
    symbols = sorted(expression.free_symbols, key=str)
    derivatives = {str(s): partial(expression, s) for s in symbols if isinstance(s, sp.Symbol)}
    return {name: value for name, value in derivatives.items() if value != 0}


def is_affine(equations: "ModelEquations") -> bool:
    """Return whether all rates and bindings are affine in states and inputs."""
    moving = {*equations.states, *equations.input_names}
    for binding in (*equations.bindings, *equations.rates):
        slopes = {name: slope for name, slope in partials(binding.expression).items() if name in moving}
        if any({str(s) for s in slope.free_symbols} & moving for slope in slopes.values()):
            return False
        if slopes and binding.name not in equations.states:
            moving.add(binding.name)
    return True


# SymPy expressions as assignments of scalar code: one family of printers, and a dialect for each language.


def mangled(name: str) -> str:
    """Return a name that cannot collide with a keyword or with the generated code's own."""
    return f"{name}_"


class _ScalarRules(CodePrinter):
    """Rules of every language: integer powers as products, sign by its copy, Piecewise as conditionals."""

    square_root, absolute, sign = "sqrt({})", "fabs({})", "copysign(1.0, {})"
    power, conditional = "pow({}, {})", "({condition} ? {value} : {otherwise})"

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        return mangled(expr.name)

    def _print_Pow(self, expr: sp.Pow, **_: object) -> str:
        base, exponent = expr.as_base_exp()
        text = self._print(base)
        if exponent == sp.Rational(1, 2):
            return self.square_root.format(text)
        if exponent == -sp.Rational(1, 2):
            return f"(1.0/{self.square_root.format(text)})"
        if exponent.is_Integer and 1 <= abs(int(exponent)) <= 8:  # powers written as products, up to the eighth; chosen
            product = "*".join([f"({text})"] * abs(int(exponent)))
            return f"({product})" if exponent > 0 else f"(1.0/({product}))"
        return self.power.format(text, self._print(exponent))

    def _print_Mul(self, expr: sp.Mul) -> str:
        # reciprocals as factors: 1/(m + m_x) waits for nothing, a quotient would wait for its numerator
        return "*".join(f"({self._print(factor)})" for factor in expr.args)

    def _print_Integer(self, expr: sp.Integer) -> str:
        return f"{int(expr)}.0"

    def _print_number(self, expr: sp.Expr) -> str:
        return repr(float(expr))

    _print_Rational = _print_Half = _print_Float = _print_number

    def _print_Abs(self, expr: sp.Abs) -> str:
        return self.absolute.format(self._print(expr.args[0]))

    def _print_sign(self, expr: sp.sign) -> str:
        return self.sign.format(self._print(expr.args[0]))

    def _print_Piecewise(self, expr: sp.Piecewise) -> str:
        text = self._print(expr.args[-1].expr)
        for value, condition in reversed(expr.args[:-1]):
            text = self.conditional.format(
                condition=self._print(condition), value=self._print(value), otherwise=text
            )  # fmt: skip
        return text


class _NumbaPrinter(_ScalarRules, PythonCodePrinter):
    square_root, absolute, sign = "math.sqrt({})", "abs({})", "math.copysign(1.0, {})"
    power, conditional = "({})**({})", "({value} if {condition} else {otherwise})"


class _CPrinter(_ScalarRules, C99CodePrinter):
    # C99 without extensions has no M_PI
    _print_Pi = _print_Exp1 = _ScalarRules._print_number


class _JavaScriptPrinter(_ScalarRules, JavascriptCodePrinter):
    square_root, absolute, sign = "Math.sqrt({})", "Math.abs({})", "({} < 0.0 ? -1.0 : 1.0)"
    power = "Math.pow({}, {})"


class _MatlabPrinter(_ScalarRules, OctaveCodePrinter):
    absolute, sign = "abs({})", "sign_of({})"
    power, conditional = "({})^({})", "choose({condition}, {value}, {otherwise})"


class _CasadiPrinter(_ScalarRules, PythonCodePrinter):
    square_root, absolute, sign = "ca.sqrt({})", "ca.fabs({})", "ca.if_else({} >= 0.0, 1.0, -1.0)"
    power, conditional = "({})**({})", "ca.if_else({condition}, {value}, {otherwise})"
    _print_Pi = _print_Exp1 = _ScalarRules._print_number

    def _print_Function(self, expr: sp.Function) -> str:
        return f"ca.{expr.func.__name__}({', '.join(self._print(a) for a in expr.args)})"

    _print_exp = _print_log = _print_sin = _print_cos = _print_tan = _print_tanh = _print_atan = _print_Function
    _print_asin = _print_acos = _print_sinh = _print_cosh = _print_atan2 = _print_Function

    def _print_And(self, expr: sp.And) -> str:
        return "ca.logic_and({}, {})".format(*map(self._print, expr.args))

    def _print_Or(self, expr: sp.Or) -> str:
        return "ca.logic_or({}, {})".format(*map(self._print, expr.args))


@dataclass(frozen=True)
class Assignment:
    """One line of generated code: `target` = `text`.

    is_pair: the target is an array of sine and cosine of the angle `text`.
    """

    target: str
    text: str
    is_pair: bool = False


class Dialect:
    """How a language writes the elements of a generated function; this one is scalar Python for Numba.

    Arrays are x (states), u (inputs), p (parameters), out and jac, columns of jac being [x | u | p].
    """

    def __init__(self) -> None:
        self.printer: CodePrinter = _NumbaPrinter({"fully_qualified_modules": True})

    def element(self, array: str, index: int, name: str) -> str:  # noqa: ARG002
        """Return the text of an element of x, u, p or out; `name` is that of its symbol."""
        return f"{array}[{index}]"

    def entry(self, row: int, column: int, width: int) -> str:  # noqa: ARG002
        """Return the text of an entry of the Jacobian, which has `width` columns."""
        return f"jac[{row}, {column}]"

    def sine_and_cosine(self, sine: str, cosine: str, angle: str) -> list[Assignment]:
        """Return the assignments of both functions of one angle."""
        return [Assignment(f"{sine}, {cosine}", f"sincos({angle})")]


class CDialect(Dialect):
    """C99: parameters are the fields of a struct, the Jacobian is stored row by row."""

    def __init__(self) -> None:
        self.printer = _CPrinter()

    def element(self, array: str, index: int, name: str) -> str:
        """Return a field of the parameters, or an element of an array."""
        return f"p->{name}" if array == "p" else f"{array}[{index}]"

    def entry(self, row: int, column: int, width: int) -> str:
        """Return the text of an entry of the Jacobian."""
        return f"jac[{row * width + column}]"

    def sine_and_cosine(self, sine: str, cosine: str, angle: str) -> list[Assignment]:
        """Return one call of `sincos_of`, which fills an array of both."""
        pair = sine.replace("sin", "sincos", 1)
        return [
            Assignment(pair, angle, is_pair=True), Assignment(sine, f"{pair}[0]"), Assignment(cosine, f"{pair}[1]")
        ]  # fmt: skip


class JavaScriptDialect(Dialect):
    """JavaScript: arrays as in scalar Python, the functions of `Math`."""

    def __init__(self) -> None:
        self.printer = _JavaScriptPrinter()

    def sine_and_cosine(self, sine: str, cosine: str, angle: str) -> list[Assignment]:
        """Return two calls."""
        return [Assignment(sine, f"Math.sin({angle})"), Assignment(cosine, f"Math.cos({angle})")]


class MatlabDialect(Dialect):
    """MATLAB and Octave: indices from 1, parameters are fields of a struct; needs `choose` and `sign_of`."""

    def __init__(self) -> None:
        self.printer = _MatlabPrinter()

    def element(self, array: str, index: int, name: str) -> str:
        """Return a field of the parameters, or an element of an array."""
        return f"p.{name}" if array == "p" else f"{array}({index + 1})"

    def sine_and_cosine(self, sine: str, cosine: str, angle: str) -> list[Assignment]:
        """Return two calls."""
        return [Assignment(sine, f"sin({angle})"), Assignment(cosine, f"cos({angle})")]


class CasadiDialect(Dialect):
    """Python for CasADi's symbols, its module imported as `ca`."""

    def __init__(self) -> None:
        self.printer = _CasadiPrinter({"fully_qualified_modules": False})

    def sine_and_cosine(self, sine: str, cosine: str, angle: str) -> list[Assignment]:
        """Return two calls."""
        return [Assignment(sine, f"ca.sin({angle})"), Assignment(cosine, f"ca.cos({angle})")]


class CodeBlock:
    """Assignments in order; every angle's sine and cosine are computed once, before their first use."""

    def __init__(self, dialect: Dialect) -> None:
        self.dialect = dialect
        self.assignments: list[Assignment] = []
        self._angles: dict[sp.Expr, int] = {}

    def expression(self, value: sp.Expr) -> str:
        """Return the text of an expression, after the sines and cosines it needs."""
        replaced = {}
        for call in sorted(value.atoms(sp.sin, sp.cos), key=sp.default_sort_key):
            angle = call.args[0]
            if angle not in self._angles:
                text = self.expression(angle)
                k = self._angles[angle] = len(self._angles)
                self.assignments += self.dialect.sine_and_cosine(mangled(f"sin__{k}"), mangled(f"cos__{k}"), text)
            replaced[call] = sp.Symbol(f"{call.func.__name__}__{self._angles[angle]}", real=True)
        return self.dialect.printer.doprint(value.xreplace(replaced))

    def assign(self, target: str, value: sp.Expr) -> None:
        """Append `target = value`."""
        text = self.expression(value)
        self.assignments.append(Assignment(target, text))


# From equations to source text, binding by binding: functions with the project's fixed signatures.

_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_HEADER = '''"""Generated from the equations of model {name!r}; do not edit."""
import math
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.kernel import FUNCTION_SIGNATURE, LEAN, TANGENT_SIGNATURE
from seatrial.numerics.kernels.integrate import sincos

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
