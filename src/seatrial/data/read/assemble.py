"""From the cells of logs to a record in SI units, conventions as declared."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, Channel, InputError, Provenance, Record, frozen
from seatrial.core.values.arrays import unwrapped
from seatrial.core.values.files import plain_name
from seatrial.core.values.froude import froude_scaled
from seatrial.data.held_readings import between_readings, held_text, slower_channels
from seatrial.data.read.clock import stamps
from seatrial.data.read.derive import Measured, derived_channels
from seatrial.data.read.join import Series, common_time, ordered_series, values_at
from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.data.read.log import Log
from seatrial.data.read.no_reading import without_fixes_at_zero, without_sentinel
from seatrial.data.read.raw_table import RawTable


@dataclass(frozen=True, eq=False)
class LogSource:
    """A log with the layout of what is wanted of it, and its digest."""

    log: Log
    layout: Layout
    sha256: str = ""


def assemble_record(log: Log, layout: Layout, sha256: str) -> Record:
    """The record of one log; empty cells stay NaN, frames and signs stay as declared.

    Columns of one topic keep its time stamps; those of several are joined as in `record_of_sources`.

    Raises:
        InputError: time runs backwards, fewer than two samples, a channel without any number, wrong unit.
    """
    tables = [log.table_of(column) for column in layout.columns or (layout.time,)]
    if any(table is not tables[0] for table in tables):
        return record_of_sources(record_name(log.file), [LogSource(log, layout, sha256)])
    table = tables[0]
    read = stamps(table, _time_column(layout, table))
    _require_increasing_time(read.seconds, table, layout)
    measured = {column.symbol: _measured(column, table) for column in layout.columns}
    measured, emptied = without_fixes_at_zero(measured, read.seconds)
    measured, held = _once_each(measured, read.seconds)
    channels = derived_channels(measured, layout.geometry, log.file)
    provenance = Provenance(plain_name(log.file), sha256, _notes(f"read as {layout.format}", read.note, emptied, held))
    return _record(record_name(log.file), read.seconds, channels, layout.scale, provenance)


def record_of_sources(name: str, sources: Sequence[LogSource]) -> Record:
    """The record of several logs or topics, each with its own clock and rate, on one even time base.

    Commands are held, angles unwrapped, the rest is interpolated linearly; what lies in a gap longer than the layout's
    `longest_gap` stays NaN. Rate, gaps, geometry and scale are those of the first source.

    Raises:
        InputError: as `assemble_record`; a channel is given twice, or the sources do not overlap in time.
    """
    read = [_series(source) for source in sources]
    series = [one for part in read for one in part.series]
    symbols = [one.column.symbol for one in series]
    for symbol in symbols:
        if symbols.count(symbol) > 1:
            raise InputError(f"run '{name}': channel '{symbol}' is given by two sources; keep one")
    layout = sources[0].layout
    time = common_time(series, layout.rate)
    measured = {
        one.column.symbol: Measured(one.column, values_at(one, time, layout.longest_gap), one.label) for one in series
    }
    channels = derived_channels(measured, layout.geometry, name)
    files = ", ".join(dict.fromkeys(plain_name(source.log.file) for source in sources))
    topics = len({one.topic for one in series})
    step = f"{topics} topics of {len(files.split(', '))} files joined every {time[1] - time[0]:.6g} s"
    digest = sources[0].sha256 if len(sources) == 1 else " ".join(source.sha256 for source in sources)
    emptied = [text for part in read for text in part.emptied]
    record = _record(name, time, channels, 1.0, Provenance(files, digest, (*emptied, step)))
    return froude_scaled(_with_source_steps(record, series), layout.scale)


def _with_source_steps(record: Record, series: Sequence[Series]) -> Record:
    """Return the record with the sample interval of its own source in each channel that is one column."""
    steps = {one.column.symbol: one.step for one in series if np.isfinite(one.step) and one.column.symbol in record}
    timed = {symbol: replace(record.channel(symbol), sample_s=step) for symbol, step in steps.items()}
    return replace(record, channels={**record.channels, **timed})


@dataclass(frozen=True, eq=False)
class _SourceSeries:
    """The columns of a source, each with the stamps of its topic, and what was emptied in them."""

    series: list[Series]
    emptied: tuple[str, ...]


def _series(source: LogSource) -> _SourceSeries:
    """Readings that stand for none are emptied here: interpolated with their neighbours nothing would show them."""
    log, layout = source.log, source.layout
    series, emptied = [], []
    tables = {id(table): table for table in (log.table_of(column) for column in layout.columns)}
    for table in tables.values():
        time = stamps(table, _time_column(layout, table)).seconds
        columns = [column for column in layout.columns if log.table_of(column) is table]
        measured, fixes = without_fixes_at_zero({c.symbol: _measured(c, table) for c in columns}, time)
        emptied.append(fixes)
        for symbol, one in measured.items():
            measured[symbol], text = without_sentinel(one, time)
            emptied.append(text)
        measured, held = _once_each(measured, time)
        emptied.append(held)
        topic = f"{log.file} {table.topic}"
        series += [ordered_series(one.column, time, _readings(one), one.label, topic) for one in measured.values()]
    order = [column.symbol for column in layout.columns]
    return _SourceSeries(sorted(series, key=lambda one: order.index(one.column.symbol)), _notes(*emptied))


def _time_column(layout: Layout, table: RawTable) -> ColumnSpec:
    """The layout's time column; where it names the one of another topic, that of the table itself."""
    source = layout.time.source
    if isinstance(source, str) and table.time_name and source not in table.names:
        topic, _, name = source.rpartition("/")
        if topic != table.topic and (not topic or name == table.time_name):
            return ColumnSpec("time", "", "s")
    return layout.time


def _measured(column: ColumnSpec, table: RawTable) -> Measured:
    values = column.in_si(table.numbers(column))
    if np.isnan(values[:1]).all() and np.isnan(values).all():
        raise InputError(
            f"{table.title}: {column.display_name} (channel '{column.symbol}') holds no number at all; leave it out"
        )
    return Measured(column, values, table.label(column))


def _once_each(measured: dict[str, Measured], time: Array) -> tuple[dict[str, Measured], str]:
    """The columns of a table with what slower ones repeat marked, and straight between their readings; a sentence."""
    cells = {
        symbol: (unwrapped(one.values) if one.column.quantity.unit == "rad" else one.values)
        / one.column.si_factor(one.column.quantity.unit)
        for symbol, one in measured.items()
        if not one.column.is_held and one.column.span == 1.0
    }
    masks = slower_channels(cells, time)
    slower = {
        symbol: replace(
            measured[symbol],
            values=between_readings(
                measured[symbol].values, mask, is_angle=measured[symbol].column.quantity.unit == "rad"
            ),
            is_measured=mask,
        )
        for symbol, mask in masks.items()
    }
    return measured | slower, held_text(masks, time)


def _readings(one: Measured) -> Array:
    """The values of a column, NaN where it repeats an earlier reading."""
    return one.values if one.is_measured is None else np.where(one.is_measured, one.values, np.nan)


def _notes(*notes: str) -> tuple[str, ...]:
    return tuple(note for note in notes if note)


def _record(name: str, time: Array, measured: dict[str, Measured], scale: float, provenance: Provenance) -> Record:
    channels = {symbol: _channel(one.column, _readings(one), one.label) for symbol, one in measured.items()}
    return froude_scaled(Record(name, time, channels, provenance=provenance), scale)


def _channel(column: ColumnSpec, values: Array, label: str) -> Channel:
    return Channel(
        frozen(values),
        column.quantity.unit,
        column.declared_frame,
        column.declared_positive,
        column.reference_point,
        label,
        kind=column.kind,
        between=column.between,
    )


def record_from_values(
    name: str,
    layout: Layout,
    time: Array,
    values: Array,
    labels: tuple[str, ...] = (),
    provenance: Provenance | None = None,
) -> Record:
    """The record of rows that are numbers already: time (n,) [s], the layout's columns (n, k) [SI], as declared."""
    named = labels or tuple(column.label or column.display_name for column in layout.columns)
    measured = {column.symbol: Measured(column, values[:, k], named[k]) for k, column in enumerate(layout.columns)}
    return _record(name, time, measured, layout.scale, provenance or Provenance(name))


def record_name(file: str) -> str:
    """The record's name: the file's without its ending, ``.gz`` included."""
    return plain_name(Path(file.removesuffix(".gz")).stem)


def _require_increasing_time(time: Array, table: RawTable, layout: Layout) -> None:
    if len(time) > 1 and np.all(time[1:] >= time[:-1]):  # the usual case at a tenth of the cost
        return
    stamped = np.flatnonzero(np.isfinite(time))
    if stamped.size < 2:
        count = "no time stamp" if stamped.size == 0 else "one sample"
        raise InputError(f"{table.title} has {count} in {layout.time.display_name}; a record needs at least two")
    back = np.flatnonzero(np.diff(time[stamped]) < 0)
    if back.size:
        row = stamped[back[0] + 1]
        raise InputError(
            f"{table.title}: row {table.first_row + row}: time runs backwards from {time[stamped[back[0]]]:g} s "
            f"to {time[row]:g} s{_more(back.size)}; sort or split the file"
        )


def _more(count: int) -> str:
    return f", and {count - 1} times more" if count > 1 else ""
