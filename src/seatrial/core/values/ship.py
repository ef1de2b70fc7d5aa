"""A ship: its name and particulars, by the symbols that models use."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from seatrial.core.values.errors import InputError
from seatrial.core.values.pickled import PickledByConstructor


@dataclass(frozen=True)
class Ship(PickledByConstructor):
    """Particulars in SI units, keyed by symbol (``L``, ``B``, ``d``, ``m``, ``x_G``, ``D_P``, ``A_R``, …).

    Attributes:
        name: for reports.
        particulars: symbol -> value; a model takes those it knows by name.
        source: where the particulars come from.
        scale: model scale 1:scale; 1 for full scale.

    Raises:
        InputError: the scale is not positive.
    """

    name: str
    particulars: Mapping[str, float] = field(default_factory=dict)
    source: str = ""
    scale: float = 1.0

    def __post_init__(self) -> None:
        if not self.scale > 0.0:
            raise InputError(
                f"ship: scale = {self.scale:g} is not positive; give 1 for full scale, 40 for a model 1:40"
            )
        object.__setattr__(self, "particulars", MappingProxyType(dict(self.particulars)))

    @property
    def length(self) -> float:
        """Length between perpendiculars [m], symbol ``L``."""
        return self.particulars["L"]
