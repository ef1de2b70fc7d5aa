"""What is in a log: topics, columns, rates, ranges, share missing."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.data.draft.text_layout import text_layout
from seatrial.data.read import ColumnSpec, Layout, Log, RawTable, format_of, read_log
from seatrial.data.read.clock import stamps

# names of time columns in the order of preference; ours, from the logs of a dozen programs
_TIME_NAMES = (
    "time", "t", "timestamp", "utc", "time_utc", "utc_time", "timestamp_utc", "utc_timestamp", "datetime", "date_time",
    "original_timestamp", "time_s", "time_ms", "timeus", "seconds", "sec", "clock", "zeit", "header_stamp_secs",
)  # fmt: skip
_LONGEST_CELL = 20  # characters of a cell that a message quotes; ours
_DAY_S = 86400.0  # s of a day
_MILLISECOND_STEP, _MICROSECOND_STEP = (
    5.0,
    5e3,
)  # units: a median step beyond is in ms, in us (a log has 0.2 Hz or more)


@dataclass(frozen=True)
class ColumnSummary:
    """One column: its range over the finite numbers, the share of samples without one, and the most common number.

    number: its place in the table, from 1. is_repeated: whether another column has the same name.
    """

    name: str
    unit: str
    low: float
    high: float
    missing: float
    is_constant: bool
    common: float
    number: int = 0
    is_repeated: bool = False


@dataclass(frozen=True, eq=False)
class TopicSummary:
    """One topic of a log.

    Attributes:
        topic: its name, empty for a plain table.
        time: the column of its stamps; None where there is none.
        rows, rate: number of samples, median rate [Hz].
        start, duration: first stamp on the log's clock, time from it to the last [s]; NaN without stamps.
        columns, text_columns: those that hold numbers, and the names of those that hold text.
        time_note: how the time column was recognised, or what is wrong with the one that is called so.
        faults: of columns that begin with numbers and hold something else further down.
    """

    topic: str
    time: ColumnSpec | None
    rows: int
    rate: float
    start: float
    duration: float
    columns: tuple[ColumnSummary, ...]
    time_note: str
    text_columns: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class LogSurvey:
    """One log, what was read of it, and a summary of each topic."""

    path: Path
    layout: Layout
    log: Log
    topics: tuple[TopicSummary, ...]

    @property
    def duration(self) -> float:
        """s of the longest topic."""
        return max((one.duration for one in self.topics if np.isfinite(one.duration)), default=float("nan"))


def survey_log(path: Path) -> LogSurvey:
    """Read a log of any format and summarise its topics.

    Raises:
        InputError: as `read_log`; a text file without rows of numbers.
    """
    from seatrial.data.read.record_file import require_file

    require_file(path)
    kind = format_of(path)
    layout = text_layout(path) if kind == "text" else Layout(kind, ColumnSpec("time", "", "s"), ())
    log = read_log(path, layout)
    return LogSurvey(path, layout, log, tuple(_topic_summary(table, layout) for table in log.tables))


def _topic_summary(table: RawTable, layout: Layout) -> TopicSummary:
    time, note = time_column(table, layout)
    seconds = np.full(len(table), np.nan)
    if time is not None:
        seconds = stamps(table, time).seconds
    known = seconds[np.isfinite(seconds)]
    steps = np.diff(known)
    step = float(np.median(steps[steps > 0])) if np.any(steps > 0) else np.nan
    own = {} if time is None else {time.source, "time" if not time.source else time.source}
    columns = [
        summary
        for index in range(len(table.names))
        if table.names[index] not in own and (summary := _column_summary(table, index)) is not None
    ]
    textual = [k for k, name in enumerate(table.names) if name not in own and column_values(table, k) is None]
    texts = tuple(table.names[k] or f"{k + 1}" for k in textual)
    faults = tuple(fault for k in textual if (fault := _fault(table, k)))
    duration = float(known[-1] - known[0]) if known.size > 1 else float("nan")
    start = float(known[0]) if known.size else float("nan")
    return TopicSummary(table.topic, time, len(table), 1.0 / step, start, duration, tuple(columns), note, texts, faults)


def _column_summary(table: RawTable, index: int) -> ColumnSummary | None:
    """None where the column holds text, or nothing."""
    values = column_values(table, index)
    if values is None:
        return None
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return None
    unit = table.units[index] if table.units else ""
    low, high = float(np.min(finite)), float(np.max(finite))
    missing = 1.0 - finite.size / values.size
    numbers, counts = np.unique(finite, return_counts=True)
    common = float(numbers[np.argmax(counts)])
    name, is_repeated = table.names[index] or f"{index + 1}", table.names.count(table.names[index]) > 1
    return ColumnSummary(
        name, unit, low, high, missing, low == high, common, index + 1, is_repeated and bool(table.names[index])
    )


def _fault(table: RawTable, index: int) -> str:
    """Where a column that begins with numbers holds none; empty for one of text."""
    row = table.first_text_row(index)
    if row is None or row == 0:
        return ""
    name, cell = table.names[index] or f"{index + 1}", str(table.cells[index][row])[:_LONGEST_CELL]
    return f"'{name}': row {table.first_row + row} holds '{cell}', no number"


def column_values(table: RawTable, index: int) -> Array | None:
    """Return a column as numbers; None where it holds text."""
    try:
        return table.numbers(ColumnSpec("column", index + 1, ""))
    except InputError:
        return None


def time_column(table: RawTable, layout: Layout) -> tuple[ColumnSpec | None, str]:
    """Return the column of time stamps and how it was recognised: the format's own, by name, cells, or behaviour.

    By its cells it is the only column of dates with times that increase; by behaviour the first column of numbers that
    increases throughout in nearly equal steps.
    """
    from seatrial.data.read.layout import TimeSpec

    if table.time_name:
        return ColumnSpec("time", "", "s"), f"time of the {layout.format} log"
    plain = {_plain_name(name): name for name in reversed(table.names) if name}
    if {"header_stamp_secs", "header_stamp_nsecs"} <= set(plain):
        spec = TimeSpec("time", "header_stamp_secs", "s", nanoseconds="header_stamp_nsecs")
        return spec, "stamp of the message's header, seconds and nanoseconds"
    fault = ""
    for wanted in _TIME_NAMES:
        if wanted in plain:
            spec = _with_unit(table, plain[wanted])
            fault = fault or _backwards(table, plain[wanted])
            if spec is not None:
                return (
                    spec,
                    f"named '{plain[wanted]}', {'dates and times' if spec.unit == 'utc' else 'unit by its step'}",
                )
    dated = [index for index in range(len(table.names)) if _has_increasing_dates(table, index)]
    if len(dated) == 1:
        source = table.names[dated[0]] or dated[0] + 1
        return ColumnSpec("time", source, "utc"), "the only column of dates and times"
    for index in range(len(table.names)):
        values = column_values(table, index)
        if values is not None and _is_clock(values):
            source = table.names[index] or index + 1
            return ColumnSpec("time", source, "s"), "the only column that increases evenly"
    return None, fault


def _backwards(table: RawTable, name: str) -> str:
    """Where a clock of numbers runs backwards; empty where it does not."""
    values = column_values(table, table.names.index(name))
    known = np.flatnonzero(np.isfinite(values)) if values is not None else np.empty(0, dtype=np.intp)
    back = np.flatnonzero(np.diff(values[known]) < 0.0) if values is not None else known
    if values is None or not back.size:
        return ""
    row = int(known[back[0] + 1])
    return f"'{name}' runs backwards from {values[known[back[0]]]:g} to {values[row]:g} in row {table.first_row + row}"


def _plain_name(name: str) -> str:
    """A column's name in small letters without what stands in brackets."""
    return name.partition("[")[0].partition("(")[0].strip().lower().replace(" ", "_").replace("/", "_")


def _with_unit(table: RawTable, name: str) -> ColumnSpec | None:
    """The time column with the unit of its numbers: s, ms or us by the median step; text is read by itself."""
    values = column_values(table, table.names.index(name))
    if values is None:
        return ColumnSpec("time", name, "utc")
    steps = np.diff(values[np.isfinite(values)])
    if not steps.size or np.any(steps < 0) or not np.any(steps > 0):
        return None
    step = float(np.median(steps[steps > 0]))
    return ColumnSpec("time", name, "us" if step > _MICROSECOND_STEP else "ms" if step > _MILLISECOND_STEP else "s")


def _has_increasing_dates(table: RawTable, index: int) -> bool:
    """Whether a column of text holds dates with their time of day that do not go back; a day alone is no stamp."""
    if column_values(table, index) is not None:
        return False
    try:
        seconds = stamps(table, ColumnSpec("time", index + 1, "utc")).seconds
    except InputError:
        return False
    dated = seconds[np.isfinite(seconds) & (seconds >= _DAY_S)]  # before: a time of day without a date
    has_times = bool(np.any(dated % _DAY_S > 0.0))
    return has_times and bool(np.all(np.diff(dated) >= 0.0)) and dated[0] < dated[-1]


def _is_clock(values: Array) -> bool:
    steps = np.diff(values)
    if steps.size < 2 or not np.all(np.isfinite(steps)) or not np.all(steps > 0):
        return False
    return float(np.ptp(steps)) < 0.5 * float(np.median(steps))  # steps that differ by less than half of one: a clock
