"""A record: one run on one time base, named channels with unit, frame, sign and reference point; at any scale."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from enum import StrEnum
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self, TypeVar

import numpy as np

from seatrial.core.text.words import NAMES_SHOWN, enumeration
from seatrial.core.values.arrays import Array, PickledByConstructor, frozen, held_rows
from seatrial.core.values.channel import Channel, ColumnDeclarations, Provenance, channel_columns, column_numbers
from seatrial.core.values.errors import InputError
from seatrial.core.values.notation import channel_hint

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure


# A record: one run on one time base, named channels with unit, frame, sign and reference point.

T = TypeVar("T")

# dimensionless, ours: how far steps of an even time base may differ, in mean steps; how far a ratio of rates may be
# from a whole number; rounding of a duration times a rate
_EVEN_STEPS, _WHOLE_RATIO, _ROUNDING = 1e-3, 1e-3, 1e-12
# samples of a record that is simulated or resampled, at most: 2.7 h at 10 kHz, 0.8 GB a channel; chosen
MAX_SAMPLES = 10**8
LATEST_TIME = datetime.max.replace(tzinfo=UTC).timestamp()
"""s since 1970, at the end of the year 9999: the last time that has a date."""
_SAME_TIME = 1e-9  # s, relative beyond 1 s from the first; ours: time stamps that near are one
_SAME_FLOATS = 4.0  # steps between floats by which a time is rounded at most, as of clocks from 1970; chosen


class RecordKind(StrEnum):
    """States where a record comes from; a planned one has inputs only."""

    MEASURED = "measured"
    SIMULATED = "simulated"
    PLANNED = "planned"


@dataclass(frozen=True, eq=False)
class Record(PickledByConstructor):
    """One run: times in s, shape (n,), never running backwards; channels of the same length.

    `record["u"]` gives the values. The stamps of a record as it was read may be uneven, repeated or empty (NaN), which
    checking repairs; `dt` demands that they increase evenly.

    Raises:
        InputError: no sample, lengths differ, or time runs backwards or beyond the year 9999.
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
        _check_time(self.name, self.time)

    @classmethod
    def from_arrays(
        cls, name: str, time: Array, values: Mapping[str, Array], kind: RecordKind = RecordKind.MEASURED
    ) -> Self:
        """Return a record of channels in the notation table's own units, frames and signs."""
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

    def __repr__(self) -> str:
        channels = enumeration([f"{symbol} [{channel.unit}]" for symbol, channel in self.channels.items()], NAMES_SHOWN)
        return f"<Record '{self.name}', {self.kind}: {len(self)} samples over {self.duration:g} s of {channels}>"

    def __contains__(self, symbol: str) -> bool:
        return symbol in self.channels

    def __getitem__(self, symbol: str) -> Array:
        return self.channel(symbol).values

    def measured(self, symbol: str) -> Array:
        """Return the values of a channel, (n,), NaN where nothing was measured."""
        return self.channel(symbol).measured

    def channel(self, symbol: str) -> Channel:
        """Return the channel of a symbol.

        Raises:
            InputError: the record has no such channel.
        """
        if symbol not in self.channels:
            raise InputError(
                f"record '{self.name}' has no channel '{symbol}'{channel_hint(symbol, list(self.channels))}"
            )
        return self.channels[symbol]

    @cached_property
    def _computed(self) -> dict[Callable[["Record"], Any], Any]:
        """What functions gave of this record."""
        return {}

    def computed(self, function: Callable[["Record"], T]) -> T:
        """Return what a function gives of the record, worked out once: neither the record nor that changes.

        Raises:
            InputError: what the function raises.
        """
        if function not in self._computed:
            self._computed[function] = function(self)
        return self._computed[function]

    @property
    def duration(self) -> float:
        """Seconds from first to last sample."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def is_uniform(self) -> bool:
        """Whether time increases in steps that agree within a thousandth."""
        steps = np.diff(self.time)
        return len(steps) > 0 and bool(np.ptp(steps) <= _EVEN_STEPS * np.mean(steps)) and self.duration > 0.0

    @property
    def dt(self) -> float:
        """The time step in s.

        Raises:
            InputError: fewer than two samples, or an uneven time base.
        """
        if len(self.time) < 2:
            raise InputError(f"record '{self.name}' has one sample; at least two are needed")
        if not self.is_uniform:
            raise InputError(
                f"record '{self.name}' has an uneven time base; rebuild it first, as checking a trial does"
            )
        return self.duration / (len(self.time) - 1)

    def matrix(self, symbols: tuple[str, ...]) -> Array:
        """Return the columns of the named channels, shape (n, len(symbols)), C order."""
        return (
            np.ascontiguousarray(np.stack([self[s] for s in symbols], axis=1)) if symbols else np.empty((len(self), 0))
        )

    def with_channel(self, symbol: str, channel: Channel, step: str = "") -> Self:
        """Return the record with one channel added or replaced, and the step in its provenance."""
        changed = replace(self, channels={**self.channels, symbol: channel})
        return changed.with_step(step) if step else changed

    def with_step(self, step: str) -> Self:
        """Return the record with one more step in its provenance."""
        return replace(self, provenance=self.provenance.with_step(step))

    def without(self, *symbols: str) -> Self:
        """Return the record without the named channels."""
        return replace(self, channels={s: c for s, c in self.channels.items() if s not in symbols})

    def renamed(self, name: str) -> Self:
        """Return the record under another name."""
        return replace(self, name=name)

    def rows(self, index: slice) -> Self:
        """Return the samples of a slice."""
        return replace(self, time=self.time[index], channels={s: c.rows(index) for s, c in self.channels.items()})

    def between(self, start: float, stop: float) -> Self:
        """Return the samples with start <= t <= stop, in s.

        Raises:
            InputError: no sample lies between.
        """
        near = _SAME_TIME * max(1.0, abs(stop - float(self.time[0])))
        margin = max(near, _SAME_FLOATS * float(np.spacing(abs(stop))))
        first = int(np.searchsorted(self.time, start - margin))
        last = int(np.searchsorted(self.time, stop + margin, side="right"))
        if first >= last:
            raise InputError(f"record '{self.name}' has no samples between {start:g} and {stop:g} s")
        return self.rows(slice(first, last))

    def resampled(self, rate: float) -> Self:
        """Return every k-th sample where `rate` [Hz] divides the record's own; otherwise linear interpolation.

        No filter is applied: estimators compare point samples with point samples. Of a channel that is declared to be
        held the mean until the next sample remains, or the value that holds there. What was measured within half a new
        step of a new sample counts as measured there.

        Raises:
            InputError: an uneven time base, or more than `MAX_SAMPLES` samples.
        """
        if not self.duration * rate < MAX_SAMPLES:
            raise InputError(
                f"record '{self.name}' of {self.duration:g} s at {rate:g} Hz has over {MAX_SAMPLES:.0e} samples; "
                "give a lower rate"
            )
        ratio = 1.0 / (self.dt * rate)
        if ratio >= 1 and abs(ratio - round(ratio)) < _WHOLE_RATIO:
            thinned = self._every(round(ratio))
        else:
            count = int(np.floor(self.duration * rate * (1 + _ROUNDING))) + 1
            time = self.time[0] + np.arange(count) / rate
            before = np.searchsorted(self.time, time + _SAME_TIME, side="right") - 1
            channels = {
                s: c.with_values(c.values[before] if c.is_held else np.interp(time, self.time, c.values))
                for s, c in self.channels.items()
            }
            thinned = replace(self, time=frozen(time), channels=channels)._timed_by(self.dt)
            thinned = thinned.with_step(f"resampled to {rate:g} Hz")
        nearest = np.clip(np.round((self.time - self.time[0]) * rate).astype(int), 0, len(thinned) - 1)
        for symbol, channel in self.channels.items():
            if channel.is_measured is not None:
                count = np.bincount(nearest, channel.is_measured, len(thinned))
                thinned = thinned.with_channel(symbol, thinned.channel(symbol).with_measured(count > 0.0))
        return thinned

    def _every(self, ratio: int) -> Self:
        """Return every `ratio`-th sample."""
        kept = self.rows(slice(None, None, ratio))
        if ratio == 1:
            return kept
        means = {s: c.with_values(held_rows(c.values, ratio)) for s, c in self.channels.items() if c.is_held}
        return replace(kept, channels={**kept.channels, **means})._timed_by(self.dt)

    def _timed_by(self, step: float) -> Self:
        """Return the record with the time step [s] of its source in channels that do not know theirs."""
        channels = {s: c if c.sample_s else replace(c, sample_s=step) for s, c in self.channels.items()}
        return replace(self, channels=channels)

    def plot(self, length: float = 0.0) -> "Figure":
        """Draw the track and every channel over time as a Matplotlib figure.

        Args:
            length: of the ship [m], for hulls along the track; 0: none.
        """
        from seatrial.core.figures.matplotlib_axes import matplotlib_figure
        from seatrial.core.values.record_chart import record_chart

        return matplotlib_figure(record_chart(self, length))

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return a data frame: time [s] as index, a column in SI units for each channel, `metadata` in ``attrs``."""
        import pandas as pd

        frame = pd.DataFrame({s: c.values for s, c in self.channels.items()}, index=pd.Index(self.time, name="time"))
        frame.attrs = {**self.metadata}
        return frame

    @classmethod
    def from_dataframe(
        cls,
        frame: "pandas.DataFrame",
        name: str = "",
        *,
        time: str | None = None,
        columns: Mapping[str, str] | None = None,
        units: Mapping[str, str] | None = None,
        frames: Mapping[str, str] | None = None,
        positive: Mapping[str, str] | None = None,
        reference_points: Mapping[str, float] | None = None,
        kind: Mapping[str, str] | None = None,
        between: Mapping[str, str] | None = None,
    ) -> Self:
        """Make a record of a data frame; a frame of `to_dataframe` is restored, its metadata included.

        Args:
            frame: one row a sample.
            name: of the record; without it the frame's own, or ``record``.
            time: the column of time stamps; None: the index. Numbers in s, dates, or durations.
            columns: channel symbol -> column; None: every column whose name is a symbol of the notation table.
            units: channel symbol (or ``time``) -> unit of the numbers; SI where absent.
            frames: channel symbol -> ``body``, ``earth`` or ``none``.
            positive: channel symbol -> positive direction, e.g. ``port``.
            reference_points: channel symbol -> metres forward of midship.
            kind: channel symbol -> ``command`` (an order) or ``measured``.
            between: channel symbol -> ``held`` or ``straight`` between samples; a command is held unless this says
                otherwise, of other inputs their steps decide.

        Raises:
            InputError: a column is missing or holds text, or a symbol, unit, frame or direction is unknown.
        """
        declared = ColumnDeclarations(
            units or {}, frames or {}, positive or {}, reference_points or {}, kind or {}, between or {}
        )
        chosen = channel_columns(frame, time, columns)
        declared.require_symbols(list(chosen))
        metadata = frame.attrs.get("channels", {})
        channels = {
            symbol: declared.channel(symbol, column_numbers(frame, column), column, metadata.get(symbol))
            for symbol, column in chosen.items()
        }
        provenance = frame.attrs.get("provenance")
        return cls(
            name or frame.attrs.get("name", "record"),
            declared.seconds(frame.index if time is None else frame[time]),
            channels,
            RecordKind(frame.attrs.get("kind", RecordKind.MEASURED)),
            Provenance() if provenance is None else Provenance.from_metadata(provenance),
        )

    def to_xarray(self) -> "xarray.Dataset":
        """Return a dataset over `time`, channel metadata as attributes (needs the extra `formats`)."""
        import xarray as xr

        variables = {s: ("time", np.array(c.values), c.metadata) for s, c in self.channels.items()}
        return xr.Dataset(variables, {"time": ("time", np.array(self.time), {"units": "s"})}, {"name": self.name})

    @classmethod
    def from_xarray(cls, dataset: "xarray.Dataset") -> Self:
        """Restore a record from `to_xarray`, except kind and provenance, which a dataset does not keep."""
        channels = {
            str(s): _channel_from_metadata(str(s), a.to_numpy().astype(float), dict(a.attrs))
            for s, a in dataset.items()
        }
        return cls(str(dataset.attrs.get("name", "record")), dataset["time"].to_numpy().astype(float), channels)


def _check_time(name: str, time: Array) -> None:
    latest = float(np.nanmax(np.abs(time))) if not np.isnan(time).all() else 0.0
    if latest > LATEST_TIME:
        raise InputError(f"record '{name}': {latest:.3g} s is no time; correct the unit of the time column")
    if np.all(time[1:] >= time[:-1]):  # the usual case at a tenth of the cost
        return
    stamped = np.flatnonzero(np.isfinite(time))
    back = np.flatnonzero(np.diff(time[stamped]) < 0)
    if back.size:
        row = stamped[back[0] + 1]
        raise InputError(
            f"record '{name}': time runs backwards at sample {row + 1} "
            f"({time[stamped[back[0]]]:g} s to {time[row]:g} s); sort or split the file"
        )


def _channel_from_metadata(symbol: str, values: Array, metadata: dict | None) -> Channel:
    return Channel(frozen(values), **metadata) if metadata else Channel.from_notation(symbol, values)


# Froude similarity: a record of one scale, expressed at another.

# exponent of the length ratio by base unit, equal gravity and density (ITTC 2021, 7.5-02-06-01, Froude scaling)
_EXPONENTS = {"1": 0.0, "rad": 0.0, "m": 1.0, "s": 0.5, "rps": -0.5, "N": 3.0, "kg": 3.0}


def froude_factor(unit: str, ratio: float) -> float:
    """Return the factor from model to ship for a quantity of SI `unit` at length ratio `ratio` = L_ship / L_model.

    Raises:
        InputError: the ratio is not positive, or the unit has no known exponent.
    """
    if not (np.isfinite(ratio) and ratio > 0):
        raise InputError(f"scale must be a positive number, not {ratio:g}; give 45.7 for a model 1:45.7")
    return float(ratio ** _exponent(unit))


def _exponent(unit: str) -> float:
    """Return the exponent of a product of powers over another, such as ``kg m^2/s``."""
    total, sign = 0.0, 1.0
    for side in unit.split("/"):
        for factor in side.split():
            base, _, power = factor.partition("^")
            if base not in _EXPONENTS or not (power or "1").isdecimal():
                raise InputError(
                    f"no Froude exponent is known for unit '{unit}'; convert the channel to an SI unit first"
                )
            total += sign * _EXPONENTS[base] * int(power or "1")
        sign = -1.0
    return total


def froude_scaled(record: Record, ratio: float) -> Record:
    """Return the record at `ratio` times its scale (ratio > 1: model to ship; the inverse is `1 / ratio`).

    Lengths and reference points x ratio, time and velocities x ratio^1/2, rates x ratio^-1/2, forces x ratio^3,
    moments x ratio^4; equal water density at both scales.

    Raises:
        InputError: as `froude_factor`.
    """
    if ratio == 1.0:
        return record
    length, seconds = froude_factor("m", ratio), froude_factor("s", ratio)
    channels = {}
    for symbol, channel in record.channels.items():
        scaled = channel.with_values(channel.values * froude_factor(channel.unit, ratio))
        channels[symbol] = replace(
            scaled, reference_point=channel.reference_point * length, sample_s=channel.sample_s * seconds
        )
    time = record.time * seconds
    return replace(record, time=time, channels=channels).with_step(f"Froude-scaled by {ratio:g}")
