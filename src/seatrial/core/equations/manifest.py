"""ModelEquations and models read from the compile cache instead of being written again with SymPy.

A manifest holds the names, units, sources and expressions of a set of equations and whether it is affine; that of a
model holds its parameters as well.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from seatrial.core.equations.bindings import Binding, Input, ModelEquations
from seatrial.core.equations.model import Model
from seatrial.core.equations.stored import stored
from seatrial.core.values import Parameter, Parameters


def stored_equations(
    key: Sequence[object], write: Callable[[], ModelEquations], sources: Sequence[Path] = ()
) -> ModelEquations:
    """Return the equations that `write` returns, from their manifest where there is one.

    key: what `write` depends on, with the same `repr` in every process. sources: folders of the code that it runs.
    """
    return _equations(stored("equations", key, lambda: _manifest(write()), sources))


def stored_model(key: Sequence[object], write: Callable[[], Model], sources: Sequence[Path]) -> Model:
    """Return the model that `write` returns, from its manifest where there is one.

    key, sources: as for `stored_equations`.
    """

    def manifest() -> dict[str, Any]:
        model = write()
        return {"equations": _manifest(model.equations), "parameters": [asdict(p) for p in model.parameters]}

    about = stored("model", key, manifest, sources)
    return Model(_equations(about["equations"]), Parameters(tuple(Parameter(**p) for p in about["parameters"])))


def _manifest(equations: ModelEquations) -> dict[str, Any]:
    return {**asdict(equations), "is_affine": equations.is_affine}


def _equations(about: dict[str, Any]) -> ModelEquations:
    equations = ModelEquations(
        about["name"], about["source"], tuple(Input(**i) for i in about["inputs"]),
        tuple(Binding(**b) for b in about["bindings"]), tuple(Binding(**b) for b in about["rates"]),
        tuple(about["outputs"]), tuple(about["parameters"]), about["meaning"], about["layout"], about["sensors"],
    )  # fmt: skip
    vars(equations)["is_affine"] = about["is_affine"]  # of the cached property, which would import SymPy
    return equations
