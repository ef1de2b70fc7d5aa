"""A ship: its name and particulars; and static forces on it from captive tests or CFD."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType

import numpy as np

from seatrial.core.values.arrays import Array, PickledByConstructor, frozen
from seatrial.core.values.errors import InputError, spelling_hint

# A ship: its name and particulars, by the symbols that models use.


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


# Static force points: forces on a ship held in steady motion, from captive model tests or CFD.

FORCES = ("X", "Y", "N")


class ForceContent(StrEnum):
    """What the forces of a table hold; at zero yaw rate the last three are the same.

    Attributes:
        HULL: the bare hull, without propeller, rudder and any inertia.
        HYDRODYNAMIC: hull, propeller and rudder as the model sums them, without any inertia.
        PRESSURE: everything the water does (CFD): with the centripetal terms of the added masses.
        BALANCE: what a balance measures on which the model is mounted: with those of the mass as well.
    """

    HULL = "hull"
    HYDRODYNAMIC = "hydrodynamic"
    PRESSURE = "pressure"
    BALANCE = "balance"


@dataclass(frozen=True, eq=False)
class ForcePoints(PickledByConstructor):
    """A table of forces, SI; axes x forward, y starboard, moments positive to starboard.

    Attributes:
        motion: u, v, r and inputs by symbol, each (n,); signs as in the notation table; at the model's origin.
        forces: X, Y [N], N [N m about the model's origin] or some of them, each (n,); NaN where not measured.
        sd: standard deviation of each force, SI.
        columns: symbol -> name of its column in the file, for messages.
    """

    name: str
    motion: Mapping[str, Array]
    forces: Mapping[str, Array]
    sd: Mapping[str, float]
    includes: ForceContent = ForceContent.HYDRODYNAMIC
    source: str = ""
    columns: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        motion = {symbol: frozen(values) for symbol, values in self.motion.items()}
        forces = {symbol: frozen(values) for symbol, values in self.forces.items()}
        for name, value in (("motion", motion), ("forces", forces), ("sd", dict(self.sd))):
            object.__setattr__(self, name, MappingProxyType(value))
        self._validate()

    def _validate(self) -> None:
        where = f"force points '{self.name}'"
        for symbol in ("u", "v", "r"):
            if symbol not in self.motion:
                raise InputError(f"{where} lack '{symbol}'; give it, a constant if need be")
        for symbol in self.forces:
            if symbol not in FORCES:
                raise InputError(f"{where}: unknown force '{symbol}'{spelling_hint(symbol, list(FORCES))}")
            if not np.isfinite(self.sd.get(symbol, np.nan)) or self.sd[symbol] <= 0:
                raise InputError(f"{where}: '{symbol}' has no positive standard deviation; give sd or sd_percent")
        if not self.forces or not any(np.isfinite(values).any() for values in self.forces.values()):
            raise InputError(f"{where} hold no force; name columns for X, Y or N")
        if len({len(values) for values in (*self.motion.values(), *self.forces.values())}) != 1:
            raise InputError(f"{where}: columns differ in length; give every one a value in each row")
        for symbol, values in self.motion.items():
            if not np.all(np.isfinite(values)):
                row = int(np.flatnonzero(~np.isfinite(values))[0]) + 1
                raise InputError(f"{where}: '{symbol}' is not a number in point {row}; fill it in, or drop the row")

    def __len__(self) -> int:
        return len(self.motion["u"])

    @property
    def count(self) -> int:
        """Number of measured values."""
        return int(sum(np.isfinite(values).sum() for values in self.forces.values()))

    def label(self, symbol: str) -> str:
        """Return how messages name a quantity."""
        return f"column '{self.columns[symbol]}' ({symbol})" if symbol in self.columns else f"'{symbol}'"
