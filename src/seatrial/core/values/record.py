"""A record: one run on one time base, named channels with unit, frame, sign and reference point."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from seatrial.core.values.arrays import Array, frozen
from seatrial.core.values.errors import InputError, spelling_hint
from seatrial.core.values.notation import quantity

if TYPE_CHECKING:
    import pandas
    import xarray


class RecordKind(StrEnum):
    """Where a record comes from; a planned one has inputs only."""

    MEASURED = "measured"
    SIMULATED = "simulated"
    PLANNED = "planned"


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
    """

    values: Array
    unit: str
    frame: str
    positive: str
    reference_point: float = 0.0
    label: str = ""

    @classmethod
    def from_notation(cls, symbol: str, values: Array) -> Self:
        """A channel in the notation table's own unit, frame and sign."""
        q = quantity(symbol)
        return cls(frozen(values), q.unit, q.frame, q.positive)

    @property
    def metadata(self) -> dict[str, str | float]:
        """Everything but the values: ``Channel(values, **channel.metadata)`` is the channel again."""
        keys = ("unit", "frame", "positive", "reference_point", "label")
        return {key: getattr(self, key) for key in keys}

    def with_values(self, values: Array) -> Self:
        """The same channel with other values."""
        return replace(self, values=frozen(values))


@dataclass(frozen=True)
class Provenance:
    """Where a record came from and what has been done to it."""

    source: str = ""
    sha256: str = ""
    steps: tuple[str, ...] = ()

    @classmethod
    def from_metadata(cls, metadata: Mapping[str, Any]) -> Self:
        """The inverse of `dataclasses.asdict`, by way of JSON."""
        return cls(metadata["source"], metadata["sha256"], tuple(metadata["steps"]))

    def with_step(self, step: str) -> Self:
        """The same with one more step."""
        return replace(self, steps=(*self.steps, step))


@dataclass(frozen=True, eq=False)
class Record:
    """One run: times in s, shape (n,), never running backwards; channels of the same length.

    `record["u"]` gives the values. The stamps of a record as it was read may be uneven, repeated or empty (NaN), which
    `check.timebase` mends; `dt` demands that they increase evenly.

    Raises:
        InputError: no sample, lengths differ, or time runs backwards.
    """

    name: str
    time: Array
    channels: Mapping[str, Channel]
    kind: RecordKind = RecordKind.MEASURED
    provenance: Provenance = field(default_factory=Provenance)

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", frozen(self.time))
        object.__setattr__(self, "channels", MappingProxyType(dict(self.channels)))
        if len(self.time) == 0:
            raise InputError(f"record '{self.name}' is empty")
        for symbol, channel in self.channels.items():
            if channel.values.shape != self.time.shape:
                raise InputError(
                    f"record '{self.name}': channel '{symbol}' has {len(channel.values)} samples, time {len(self.time)}"
                )
        _check_time_order(self.name, self.time)

    @classmethod
    def from_arrays(
        cls, name: str, time: Array, values: Mapping[str, Array], kind: RecordKind = RecordKind.MEASURED
    ) -> Self:
        """A record of channels in the notation table's own units, frames and signs."""
        return cls(name, time, {symbol: Channel.from_notation(symbol, array) for symbol, array in values.items()}, kind)

    @property
    def metadata(self) -> dict[str, Any]:
        """Everything but the numbers, ready for JSON."""
        return {
            "name": self.name,
            "kind": self.kind.value,
            "provenance": asdict(self.provenance),
            "channels": {symbol: channel.metadata for symbol, channel in self.channels.items()},
        }

    def __len__(self) -> int:
        return len(self.time)

    def __contains__(self, symbol: str) -> bool:
        return symbol in self.channels

    def __getitem__(self, symbol: str) -> Array:
        return self.channel(symbol).values

    def channel(self, symbol: str) -> Channel:
        """The channel of that name.

        Raises:
            InputError: the record has no such channel.
        """
        if symbol not in self.channels:
            raise InputError(
                f"record '{self.name}' has no channel '{symbol}'{spelling_hint(symbol, list(self.channels))}"
            )
        return self.channels[symbol]

    @property
    def duration(self) -> float:
        """Seconds from first to last sample."""
        return float(self.time[-1] - self.time[0])

    @property
    def is_uniform(self) -> bool:
        """Whether time increases in steps that agree within a thousandth."""
        steps = np.diff(self.time)
        return len(steps) > 0 and bool(np.ptp(steps) <= 1e-3 * np.mean(steps)) and self.duration > 0.0

    @property
    def dt(self) -> float:
        """The time step in s.

        Raises:
            InputError: fewer than two samples, or an uneven time base.
        """
        if len(self.time) < 2:
            raise InputError(f"record '{self.name}' has one sample; at least two are needed")
        if not self.is_uniform:
            raise InputError(f"record '{self.name}' has an uneven time base; rebuild it first (check.timebase)")
        return self.duration / (len(self.time) - 1)

    def matrix(self, symbols: tuple[str, ...]) -> Array:
        """Columns of the named channels, shape (n, len(symbols)), C order."""
        return (
            np.ascontiguousarray(np.stack([self[s] for s in symbols], axis=1)) if symbols else np.empty((len(self), 0))
        )

    def with_channel(self, symbol: str, channel: Channel, step: str = "") -> Self:
        """The same record with one channel added or replaced."""
        provenance = self.provenance.with_step(step) if step else self.provenance
        return replace(self, channels={**self.channels, symbol: channel}, provenance=provenance)

    def without(self, *symbols: str) -> Self:
        """The same record without the named channels."""
        return replace(self, channels={s: c for s, c in self.channels.items() if s not in symbols})

    def renamed(self, name: str) -> Self:
        """The same record under another name."""
        return replace(self, name=name)

    def rows(self, index: slice) -> Self:
        """The samples of a slice."""
        cut = {s: replace(c, values=c.values[index]) for s, c in self.channels.items()}
        return replace(self, time=self.time[index], channels=cut)

    def between(self, start: float, stop: float) -> Self:
        """Samples with start <= t <= stop (half a step of tolerance).

        Raises:
            InputError: nothing lies between.
        """
        margin = 1e-9 * max(1.0, abs(stop))
        first = int(np.searchsorted(self.time, start - margin))
        last = int(np.searchsorted(self.time, stop + margin, side="right"))
        if first >= last:
            raise InputError(f"record '{self.name}' has no samples between {start:g} and {stop:g} s")
        return self.rows(slice(first, last))

    def resampled(self, rate: float) -> Self:
        """Every k-th sample where `rate` [Hz] divides the record's own; otherwise linear interpolation.

        No filter is applied: estimators compare point samples with point samples.
        """
        ratio = 1.0 / (self.dt * rate)
        if ratio >= 1 and abs(ratio - round(ratio)) < 1e-3:
            return self.rows(slice(None, None, round(ratio)))
        count = int(np.floor(self.duration * rate * (1 + 1e-12))) + 1
        time = self.time[0] + np.arange(count) / rate
        made = {s: c.with_values(np.interp(time, self.time, c.values)) for s, c in self.channels.items()}
        return replace(
            self, time=frozen(time), channels=made, provenance=self.provenance.with_step(f"resampled to {rate:g} Hz")
        )

    def to_pandas(self) -> "pandas.DataFrame":
        """Time as index, a column for each channel; `metadata` in `attrs`."""
        import pandas as pd

        frame = pd.DataFrame({s: c.values for s, c in self.channels.items()}, index=pd.Index(self.time, name="time"))
        frame.attrs = {**self.metadata}
        return frame

    @classmethod
    def from_pandas(cls, frame: "pandas.DataFrame", name: str = "record") -> Self:
        """The inverse of `to_pandas`; without metadata the notation table's conventions are taken."""
        about = frame.attrs
        known = about.get("channels", {})
        channels = {
            str(s): _channel_from_metadata(str(s), frame[s].to_numpy(float), known.get(s)) for s in frame.columns
        }
        provenance = Provenance.from_metadata(about["provenance"]) if "provenance" in about else Provenance()
        kind = RecordKind(about.get("kind", RecordKind.MEASURED))
        return cls(about.get("name", name), frame.index.to_numpy(float), channels, kind, provenance)

    def to_xarray(self) -> "xarray.Dataset":
        """A dataset over `time`, channel metadata as attributes (needs the extra `formats`)."""
        import xarray as xr

        variables = {s: ("time", np.array(c.values), c.metadata) for s, c in self.channels.items()}
        return xr.Dataset(variables, {"time": ("time", np.array(self.time), {"units": "s"})}, {"name": self.name})

    @classmethod
    def from_xarray(cls, dataset: "xarray.Dataset") -> Self:
        """The inverse of `to_xarray`, but for kind and provenance, which a dataset does not keep."""
        channels = {
            str(s): _channel_from_metadata(str(s), a.to_numpy().astype(float), dict(a.attrs))
            for s, a in dataset.items()
        }
        return cls(str(dataset.attrs.get("name", "record")), dataset["time"].to_numpy().astype(float), channels)


def _check_time_order(name: str, time: Array) -> None:
    known = np.flatnonzero(np.isfinite(time))
    back = np.flatnonzero(np.diff(time[known]) < 0)
    if back.size:
        row = known[back[0] + 1]
        raise InputError(
            f"record '{name}': time runs backwards at sample {row + 1} "
            f"({time[known[back[0]]]:g} s to {time[row]:g} s); sort or split the file"
        )


def _channel_from_metadata(symbol: str, values: Array, metadata: dict | None) -> Channel:
    return Channel(frozen(values), **metadata) if metadata else Channel.from_notation(symbol, values)
