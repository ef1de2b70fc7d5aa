"""Differentiation binding by binding: partials of one small expression, never of the whole.

The generated code chains them from each output back to states, inputs and parameters (reverse accumulation, Griewank &
Walther 2008, section 3.2): with few outputs and many parameters half the operations of the forward order, measured.
"""

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.functions.elementary.piecewise import ExprCondPair

if TYPE_CHECKING:
    from seatrial.core.equations.bindings import ModelEquations

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
