"""A model's equations for pages: LaTeX, one line for each binding and rate, and JavaScript of its rates."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from seatrial.core.equations.bindings import Binding, stored
from seatrial.core.equations.model import Model
from seatrial.core.values.notation import NOTATION

if TYPE_CHECKING:
    from seatrial.core.equations.generate import Assignment


# JavaScript of a model's rates, for pages that simulate: the assignments of the C99 export in another dialect.


def rates_function(model: "Model") -> str:
    """Return ``(x, u, p, out) => {...}``, which sets `out` to the rates of the states; arrays in the model's order."""
    lines = stored("javascript", (model.equation_hash,), lambda: _lines(model))
    return "\n".join(["(x, u, p, out) => {", *(f"  {line}" for line in lines), "}"])


def _lines(model: "Model") -> list[str]:
    from seatrial.core.equations.generate import JavaScriptDialect, function_assignments, live_assignments

    equations = model.equations
    assignments = function_assignments(equations, equations.rates, JavaScriptDialect())
    return [_statement(a) for a in live_assignments(assignments)]


def _statement(assignment: "Assignment") -> str:
    declared = "const " if assignment.target.isidentifier() else ""
    return f"{declared}{assignment.target} = {assignment.text};"


# A model's equations as LaTeX, one line for each binding and rate, with its source: what a report prints.

_GREEK = {
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda", "mu", "nu", "xi", "rho",
    "sigma", "tau", "phi", "chi", "psi", "omega",
}  # fmt: skip


@dataclass(frozen=True)
class LatexEquation:
    """One line: the name it defines, LaTeX without dollar signs, unit and source; `is_rate` for d/dt of a state."""

    name: str
    latex: str
    source: str
    unit: str
    is_rate: bool


def latex_symbol(name: str) -> str:
    r"""Return LaTeX for a name: ``x_P_prime`` -> ``x'_{P}``, ``gamma_R`` -> ``\gamma_{R}``, ``sin_psi`` -> upright."""
    head, *rest = name.split("_")
    prime = "'" if rest and rest[-1] == "prime" else ""
    rest = rest[:-1] if prime else rest
    if head in _GREEK:
        head = f"\\{head}"
    elif len(head) > 1:
        head = f"\\mathrm{{{head}}}"
    below = " ".join(f"\\{part}" if part in _GREEK else part for part in rest)
    upright = f"\\mathrm{{{below}}}" if any(len(part) > 2 and part not in _GREEK for part in rest) else below
    return f"{head}{prime}_{{{upright}}}" if below else f"{head}{prime}"


def latex_symbols(model: Model) -> dict[str, str]:
    """Return name -> LaTeX for every symbol: the parameter's own, the notation table's, else from the name."""
    names = [*model.states, *model.input_names, *(b.name for b in model.bindings)]
    notated = {n: NOTATION[n].latex if n in NOTATION else latex_symbol(n) for n in names}
    return notated | {p.name: p.latex or latex_symbol(p.name) for p in model.parameters}


def latex_equations(model: Model) -> list[LatexEquation]:
    """Return all bindings in order, then all rates."""
    symbol_texts = latex_symbols(model)
    rates = model.equations.rates
    key = (model.equation_hash, sorted(symbol_texts.items()))
    printed = stored("latex", key, lambda: _printed((*model.bindings, *rates), symbol_texts))
    names = [*(symbol_texts[b.name] for b in model.bindings), *(f"\\dot{{{symbol_texts[b.name]}}}" for b in rates)]
    return [
        LatexEquation(b.name, f"{name} = {right}", b.source, b.unit, i >= len(model.bindings))
        for i, (b, name, right) in enumerate(zip((*model.bindings, *rates), names, printed, strict=True))
    ]


def _printed(bindings: Sequence[Binding], symbol_texts: Mapping[str, str]) -> list[str]:
    """The right-hand sides."""
    import sympy as sp

    names = {sp.Symbol(name, real=True): text for name, text in symbol_texts.items()}
    return [sp.latex(b.expression, symbol_names=names, fold_short_frac=False) for b in bindings]
