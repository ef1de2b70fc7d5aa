"""Models with all terms that a regression may choose from, beyond those that a model has."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from seatrial.core.equations import Model
from seatrial.core.values import Parameters


def _waterjet_candidates() -> Model:
    from seatrial.physics.models.waterjet import waterjet_candidates  # here, as it imports SymPy

    return waterjet_candidates()


_WIDER: Mapping[str, Callable[[], Model]] = MappingProxyType({"waterjet": _waterjet_candidates})


def with_candidate_terms(model: Model) -> Model:
    """Return the model with every candidate term known for it, free and zero; the model itself where none is."""
    if model.name not in _WIDER:
        return model
    wide = _WIDER[model.name]()
    given = {p.name: p for p in model.parameters.items}
    return replace(wide, parameters=Parameters(tuple(given.get(p.name, p) for p in wide.parameters.items)))
