"""Values of one model's parameters under a name, with their source and the ship they belong to."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from seatrial.core.equations import Model
from seatrial.core.values import Ship


@dataclass(frozen=True)
class ParameterSet:
    """Values of one model's parameters, their source, and the ship they belong to.

    Attributes:
        model: name of the model in the registry.
        values: parameter -> value in the model's units and signs.
        note: what was converted, chosen or doubtful.
    """

    name: str
    model: str
    ship: Ship
    values: Mapping[str, float] = field(default_factory=dict)
    source: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    def applied_to(self, model: Model) -> Model:
        """Return `model` with the ship's particulars and these values.

        Raises:
            InputError: the model lacks one of the parameters, or still misses a value.
        """
        return model.with_values(self.values, source=self.source).with_ship(self.ship)
