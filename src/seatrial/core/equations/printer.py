"""SymPy expressions as assignments of scalar code: one family of printers, and a dialect for each language."""

# SymPy annotates its printers and `args` too narrowly:
# pyright: reportIncompatibleMethodOverride=false, reportAttributeAccessIssue=false, reportGeneralTypeIssues=false
# pyright: reportArgumentType=false, reportReturnType=false

from dataclasses import dataclass

import sympy as sp
from sympy.printing.c import C99CodePrinter
from sympy.printing.codeprinter import CodePrinter
from sympy.printing.jscode import JavascriptCodePrinter
from sympy.printing.octave import OctaveCodePrinter
from sympy.printing.pycode import PythonCodePrinter


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
