"""JavaScript of a model's rates, for pages that simulate: the assignments of the C99 export in another dialect."""

from typing import TYPE_CHECKING

from seatrial.core.equations.stored import stored

if TYPE_CHECKING:
    from seatrial.core.equations.model import Model
    from seatrial.core.equations.printer import Assignment


def rates_function(model: "Model") -> str:
    """Return ``(x, u, p, out) => {...}``, which sets `out` to the rates of the states; arrays in the model's order."""
    lines = stored("javascript", (model.equation_hash,), lambda: _lines(model))
    return "\n".join(["(x, u, p, out) => {", *(f"  {line}" for line in lines), "}"])


def _lines(model: "Model") -> list[str]:
    from seatrial.core.equations.generate import function_assignments, live_assignments
    from seatrial.core.equations.printer import JavaScriptDialect

    equations = model.equations
    assignments = function_assignments(equations, equations.rates, JavaScriptDialect())
    return [_statement(a) for a in live_assignments(assignments)]


def _statement(assignment: "Assignment") -> str:
    declared = "const " if assignment.target.isidentifier() else ""
    return f"{declared}{assignment.target} = {assignment.text};"
