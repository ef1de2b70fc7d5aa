"""Forward-mode differentiation, binding by binding: partials of one small expression, chained by name."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from seatrial.equations.model import Binding


@dataclass(frozen=True)
class Row:
    """Total derivatives of one binding: local partials, then for each base variable the sum of products.

    Attributes:
        binding: what is differentiated.
        partials: symbol name -> partial derivative, an expression of bindings and base variables.
        chain: base variable -> terms; each term is (partial's symbol, whether it is itself a binding).
    """

    binding: Binding
    partials: dict[str, sp.Expr]
    chain: dict[str, tuple[tuple[str, bool], ...]]


def partial(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """d expression / d symbol with d|x| = sign and d sign = 0."""
    derivative = sp.diff(expression, symbol)
    return derivative.replace(sp.DiracDelta, lambda *_: sp.Integer(0)).replace(
        lambda e: isinstance(e, sp.Derivative), lambda _: sp.Integer(0)
    )


def rows(bindings: Sequence[Binding], base: Sequence[str]) -> list[Row]:
    """Differentiate bindings in order with respect to the base variables (states, inputs, parameters)."""
    support: dict[str, list[str]] = {}
    made = []
    for binding in bindings:
        symbols = sorted(binding.expression.free_symbols, key=str)
        partials = {str(s): partial(binding.expression, s) for s in symbols}
        partials = {name: value for name, value in partials.items() if value != 0}
        chain: dict[str, list[tuple[str, bool]]] = {}
        for name in partials:
            if name in support:
                for z in support[name]:
                    chain.setdefault(z, []).append((name, True))
            else:
                chain.setdefault(name, []).append((name, False))
        ordered = {z: tuple(chain[z]) for z in base if z in chain}
        support[binding.name] = list(ordered)
        made.append(Row(binding, partials, ordered))
    return made
