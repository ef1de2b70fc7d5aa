"""Differentiation binding by binding: partials of one small expression, never of the whole.

The generated code chains them from each output back to states, inputs and parameters (reverse accumulation, Griewank &
Walther 2008, section 3.2): with few outputs and many parameters half the operations of the forward order, measured.
"""

from typing import cast

import sympy as sp


def partial(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """d expression / d symbol with d|x| = sign and d sign = 0."""
    derivative = sp.diff(expression, symbol)
    plain = derivative.replace(sp.DiracDelta, lambda *_: sp.Integer(0)).replace(
        lambda e: isinstance(e, sp.Derivative), lambda _: sp.Integer(0)
    )
    return cast(sp.Expr, plain)


def partials(expression: sp.Expr) -> dict[str, sp.Expr]:
    """Symbol name -> partial derivative, where it is not zero; symbols in the order of their names."""
    symbols = sorted(expression.free_symbols, key=str)
    made = {str(s): partial(expression, s) for s in symbols if isinstance(s, sp.Symbol)}
    return {name: value for name, value in made.items() if value != 0}
