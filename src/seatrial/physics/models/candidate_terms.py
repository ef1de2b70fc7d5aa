"""Models with all terms that a choice of structure may take, beyond those that a model has."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType

from seatrial.core.equations import Model
from seatrial.core.values import Parameters
from seatrial.physics.models.registry import model_named

_WIDER: Mapping[str, str] = MappingProxyType({"waterjet": "waterjet_candidates"})


def with_candidate_terms(model: Model) -> Model:
    """Return the model with every candidate term known for it, free and zero; the model itself where none is."""
    if model.name not in _WIDER:
        return model
    wide = model_named(_WIDER[model.name]).with_held(model.held)
    given = {p.name: p for p in model.parameters.items}
    return replace(wide, parameters=Parameters(tuple(given.get(p.name, p) for p in wide.parameters.items)))


def with_terms(model: Model, names: Iterable[str]) -> Model:
    """Return the model if it has all parameters of these names, else with its candidate terms, held where they are."""
    if set(names) <= set(model.parameters.names):
        return model
    wide = with_candidate_terms(model)
    return wide.with_parameters(wide.parameters.fixed(*(n for n in wide.parameters.names if n not in model.parameters)))
