"""One channel of a record, and where a record comes from."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from seatrial.core.values.arrays import Array, Mask, frozen
from seatrial.core.values.between import Between, Kind
from seatrial.core.values.notation import quantity


@dataclass(frozen=True, eq=False)
class Channel:
    """Values of one quantity in SI units.

    Attributes:
        values: shape (n,), read-only.
        unit: SI unit.
        frame: ``body``, ``earth`` or ``none``.
        positive: positive direction, e.g. ``starboard`` or ``port``.
        reference_point: metres forward of midship to which the channel refers.
        label: the name in the file it came from.
        is_measured: shape (n,), False where nothing was measured and `values` only run on from sample to sample, as in
            lost rows or between the readings of a slower sensor; None: every finite value was measured.
        kind: who set it: an order (``command``, never corrected), a sensor (``measured``), or nobody says.
        between: how it runs between samples: ``held`` or ``straight``; empty: a command is held, of another one its
            steps decide.
        sample_s: s between the samples of its source; 0: as in the record.
    """

    values: Array
    unit: str
    frame: str
    positive: str
    reference_point: float = 0.0
    label: str = ""
    is_measured: Mask | None = None
    kind: Kind = ""
    between: Between = ""
    sample_s: float = 0.0

    @classmethod
    def from_notation(cls, symbol: str, values: Array) -> Self:
        """Return a channel in the notation table's own unit, frame and sign."""
        q = quantity(symbol)
        return cls(frozen(values), q.unit, q.frame, q.positive)

    @property
    def is_command(self) -> bool:
        """Whether it holds orders."""
        return self.kind == "command"

    @property
    def is_held(self) -> bool:
        """Whether it is declared to stay until the next sample; where nothing is declared, whether it is a command."""
        return self.between == "held" if self.between else self.is_command

    @property
    def metadata(self) -> dict[str, str | float]:
        """Everything but the values: ``Channel(values, **channel.metadata)`` is the channel again."""
        keys = ("unit", "frame", "positive", "reference_point", "label")
        more = {key: getattr(self, key) for key in ("kind", "between", "sample_s") if getattr(self, key)}
        return {key: getattr(self, key) for key in keys} | more

    @property
    def measured(self) -> Array:
        """The values, NaN where nothing was measured."""
        return self.values if self.is_measured is None else np.where(self.is_measured, self.values, np.nan)

    @property
    def readings(self) -> Array:
        """The values that were measured, in order."""
        return self.values if self.is_measured is None else self.values[self.is_measured]

    def with_values(self, values: Array) -> Self:
        """Return the channel with other values; of another number of samples all count as measured."""
        is_same_base = self.is_measured is not None and len(values) == len(self.is_measured)
        return replace(self, values=frozen(values), is_measured=self.is_measured if is_same_base else None)

    def with_measured(self, is_measured: Mask) -> Self:
        """Return the channel with what of it was measured, shape (n,)."""
        return replace(self, is_measured=None if bool(np.all(is_measured)) else np.array(is_measured, dtype=np.bool_))

    def rows(self, index: slice) -> Self:
        """Return the samples of a slice."""
        is_measured = None if self.is_measured is None else self.is_measured[index]
        return replace(self, values=self.values[index], is_measured=is_measured)


@dataclass(frozen=True)
class Provenance:
    """States the file a record comes from, its digest, and every step since."""

    source: str = ""
    sha256: str = ""
    steps: tuple[str, ...] = ()

    @classmethod
    def from_metadata(cls, metadata: Mapping[str, Any]) -> Self:
        """Restore what `dataclasses.asdict` gives, also after JSON."""
        return cls(metadata["source"], metadata["sha256"], tuple(metadata["steps"]))

    def with_step(self, step: str) -> Self:
        """Return the provenance with one more step."""
        return replace(self, steps=(*self.steps, step))
