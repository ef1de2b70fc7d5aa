"""The built-in and the installed models in a table."""

from dataclasses import dataclass

from seatrial._plugins import installed
from seatrial.core.values import InputError
from seatrial.physics.models.registry import ENTRY_POINT_GROUP, MODELS, model_named


@dataclass(frozen=True)
class ModelSummary:
    """One model by the name under which trial files and model files know it.

    Attributes:
        name: as in ``[model] name``.
        states, inputs: symbols in order; empty where the model cannot be loaded.
        source: citation of the equations.
        package: the package that installs it; empty for a built-in model.
        problem: why an installed model cannot be loaded; empty where it can.
    """

    name: str
    states: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()
    source: str = ""
    package: str = ""
    problem: str = ""


def model_summaries() -> tuple[ModelSummary, ...]:
    """Return the built-in models, then the installed ones, each in alphabetical order."""
    packages = {
        name: point.dist.name if point.dist is not None else "unknown"
        for name, point in installed(ENTRY_POINT_GROUP).items()
        if name not in MODELS
    }
    return (*(_summary(name, "") for name in sorted(MODELS)), *(_summary(*item) for item in packages.items()))


def _summary(name: str, package: str) -> ModelSummary:
    try:
        model = model_named(name)
    except InputError as error:
        return ModelSummary(name, package=package, problem=str(error))
    return ModelSummary(name, model.states, model.input_names, model.equations.source, package)
