"""Text of other languages: a MATLAB function with a .mat of its parameters, and a Python module for CasADi."""

from io import BytesIO
from typing import Any

import numpy as np

from seatrial.core.equations.bindings import Binding
from seatrial.core.equations.generate import (
    CasadiDialect,
    Dialect,
    MatlabDialect,
    function_assignments,
    live_assignments,
)
from seatrial.data.folder.gains_file import HEADER
from seatrial.exporting.source import (
    Export,
    ExportSource,
    input_variables,
    output_variables,
    parameter_variables,
    plain,
    provenance_lines,
    range_text,
    rendered,
    require_identifiers,
    require_values,
    state_variables,
    stored_text,
)


def export_matlab(source: ExportSource, name: str) -> Export:
    """Return ``name.m``, called as the functions of MSS are, and ``name.mat`` with parameters and covariance.

    Raises:
        InputError: a name is no identifier, or a parameter has no value.
    """
    values = _template_values(source, name, MatlabDialect())
    names = source.model.states
    squares = [f"x({names.index(n) + 1})^2" for n in ("u", "v") if n in names]
    values |= {"has_speed": "u" in names, "speed": f"sqrt({' + '.join(squares)})"}
    return Export({f"{name}.m": rendered("model.m", **values), f"{name}.mat": _parameter_file(source)})


def export_casadi(source: ExportSource, name: str) -> Export:
    """Return ``name.py``, which builds CasADi functions and imports CasADi alone.

    Raises:
        InputError: a name is no identifier, or a parameter has no value.
    """
    return Export({f"{name}.py": rendered("casadi_model.txt", **_template_values(source, name, CasadiDialect()))})


def _template_values(source: ExportSource, name: str, dialect: Dialect) -> dict[str, Any]:
    require_values(source)
    require_identifiers(source, name)
    model = source.model
    bodies = stored_text((type(dialect).__name__, model.equation_hash), lambda: _bodies(source, dialect))
    return {
        **bodies,
        "name": name,
        "meaning": plain(model.equations.meaning or model.name),
        "head": [*provenance_lines(source), range_text(source)],
        "states": state_variables(model),
        "inputs": input_variables(model),
        "outputs": output_variables(model),
        "parameters": [(v, repr(p.value)) for v, p in zip(parameter_variables(model), model.parameters, strict=True)],
    }


def _bodies(source: ExportSource, dialect: Dialect) -> dict[str, list[str]]:
    """The lines of each generated function."""
    equations = source.model.equations
    wanted = {"rates": equations.rates, "outputs_body": equations.output_bindings}
    return {name: _lines(source, bindings, dialect) for name, bindings in wanted.items()}


def _lines(source: ExportSource, wanted: tuple[Binding, ...], dialect: Dialect) -> list[str]:
    assignments = live_assignments(function_assignments(source.model.equations, wanted, dialect))
    return [f"{a.target} = {a.text}" for a in assignments]


def _parameter_file(source: ExportSource) -> bytes:
    """A MAT-file: struct ``p`` of the values, units, names of the estimated ones and their covariance."""
    from scipy.io import savemat

    parameters = source.model.parameters
    content: dict[str, Any] = {
        "p": {p.name: p.value for p in parameters},
        "units": {p.name: p.unit for p in parameters},
        "estimated": np.array(parameters.free_names, dtype=object),
        "covariance": np.asarray(source.file.covariance),
        "provenance": "\n".join([*provenance_lines(source), range_text(source)]),
    }
    buffer = BytesIO()
    savemat(buffer, content, format="5", long_field_names=True, oned_as="row")  # type: ignore[arg-type]
    return HEADER + buffer.getvalue()[len(HEADER) :]
