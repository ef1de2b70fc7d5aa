"""SymPy expressions as lines of scalar Python for Numba."""

# SymPy annotates its printers and `args` too narrowly:
# pyright: reportIncompatibleMethodOverride=false, reportAttributeAccessIssue=false, reportGeneralTypeIssues=false
# pyright: reportArgumentType=false, reportReturnType=false

from collections.abc import Sequence

import sympy as sp
from sympy.printing.pycode import PythonCodePrinter


def mangled(name: str) -> str:
    """Return a Python name that cannot collide with a keyword or with the generated code's own."""
    return f"{name}_"


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
        if exponent.is_Integer and 1 <= abs(int(exponent)) <= 8:  # powers written as products, up to the eighth; chosen
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


class CodeLines:
    """Lines of one generated function; every angle's sine and cosine are computed once, before their first use."""

    def __init__(self, header: Sequence[str]) -> None:
        self.text = list(header)
        self._angles: dict[sp.Expr, int] = {}
        self._printer = _Printer({"fully_qualified_modules": True})

    def expression(self, value: sp.Expr) -> str:
        """Return the text of an expression, after the sines and cosines it needs."""
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
