"""C99: a header and a source without allocation, one struct of parameters, everything re-entrant."""

import math
import re

from seatrial.core.equations.bindings import Binding
from seatrial.core.equations.generate import (
    Assignment,
    CDialect,
    function_assignments,
    live_assignments,
    tangent_assignments,
)
from seatrial.exporting.source import (
    Export,
    ExportSource,
    identified_range,
    input_variables,
    output_variables,
    parameter_variables,
    plain,
    provenance_lines,
    range_text,
    range_use,
    rendered,
    require_identifiers,
    require_values,
    state_variables,
    stored_text,
)
from seatrial.numerics.kernels.integrate import COSINE_SERIES, HALF_PI, SINE_SERIES


def export_c(source: ExportSource, name: str) -> Export:
    """Return ``name.h`` and ``name.c``.

    Raises:
        InputError: a name is no C identifier, or a parameter has no value.
    """
    require_values(source)
    require_identifiers(source, name)
    values = _template_values(source, name)
    return Export({f"{name}.h": rendered("model.h", **values), f"{name}.c": rendered("model.c", **values)})


def _template_values(source: ExportSource, name: str) -> dict[str, object]:
    model, equations = source.model, source.model.equations
    limits = identified_range(source)
    bodies = stored_text(("c99", model.equation_hash, sorted(limits.items())), lambda: _bodies(source))
    return {
        **bodies,
        "has_angles": any("sincos_of(" in line for lines in bodies.values() for line in lines),
        "sine_series": ", ".join(map(repr, SINE_SERIES)),
        "cosine_series": ", ".join(map(repr, COSINE_SERIES)),
        "half_pi": [repr(part) for part in HALF_PI],
        "two_over_pi": repr(2.0 / math.pi),
        "name": name,
        "NAME": name.upper(),
        "head": [*provenance_lines(source), range_text(source)],
        "states": state_variables(model),
        "inputs": input_variables(model),
        "outputs": output_variables(model),
        "parameters": [(v, repr(p.value)) for v, p in zip(parameter_variables(model), model.parameters, strict=True)],
        "is_affine": model.is_affine,
        "is_held": [i.is_held for i in model.inputs],
        "has_range": bool(limits),
        "bindings": [(b.name, b.unit, plain(b.source)) for b in equations.bindings],
    }  # fmt: skip


def _bodies(source: ExportSource) -> dict[str, list[str]]:
    """The lines of each generated function."""
    equations, use = source.model.equations, range_use(source)
    return {
        "rates": _lines(source, equations.rates),
        "outputs_body": _lines(source, equations.output_bindings),
        "rates_jacobian": _jacobian_lines(source, equations.rates),
        "outputs_jacobian": _jacobian_lines(source, equations.output_bindings),
        "range_body": [] if use is None else _lines(source, (use,)),
    }


def _lines(source: ExportSource, wanted: tuple[Binding, ...]) -> list[str]:
    return _statements(function_assignments(source.model.equations, wanted, CDialect()))


def _jacobian_lines(source: ExportSource, wanted: tuple[Binding, ...]) -> list[str]:
    return _statements(tangent_assignments(source.model.equations, wanted, CDialect())[0])


def _statements(assignments: list[Assignment]) -> list[str]:
    return [_statement(a) for a in _loaded_late(live_assignments(assignments))]


def _loaded_late(assignments: list[Assignment]) -> list[Assignment]:
    """Return the assignments with each parameter read just before its first use.

    A square root is a call for the sake of errno, over which whatever was read before has to be stored again (a third
    of the time of a step, measured).
    """
    waiting = {a.target: a for a in assignments if a.text.startswith("p->")}
    ordered = []
    for assignment in assignments:
        if assignment.target not in waiting:
            used = dict.fromkeys(re.findall(r"\w+", assignment.text))
            ordered += [waiting[name] for name in used if name in waiting]
            ordered.append(assignment)
            waiting = {name: load for name, load in waiting.items() if name not in used}
    return ordered


def _statement(assignment: Assignment) -> str:
    target, text = assignment.target, assignment.text
    if assignment.is_pair:
        return f"double {target}[2]; sincos_of({text}, &{target}[0], &{target}[1]);"
    return f"const double {target} = {text};" if target.isidentifier() else f"{target} = {text};"
