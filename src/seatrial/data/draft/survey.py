"""What is in a log: topics, columns, rates, ranges, share missing."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from seatrial.data.draft.stated_columns import NOTHING_STATED, TIME, StatedColumns
from seatrial.data.draft.text_layout import text_layout
from seatrial.data.draft.time_columns import column_values, date_fault, is_date_column, time_column
from seatrial.data.read import ColumnSpec, Layout, Log, RawTable, format_of, read_log
from seatrial.data.read.clock import stamps
from seatrial.data.read.layout import TimeSpec

_WORKBOOK = "excel"  # the format whose sheets are often runs
_LONGEST_CELL = 20  # characters of a cell that a message quotes; ours


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
    """One log, what was read of it, a summary of each topic, and what was stated of its columns."""

    path: Path
    layout: Layout
    log: Log
    topics: tuple[TopicSummary, ...]
    stated: StatedColumns = field(default_factory=dict)

    @property
    def duration(self) -> float:
        """s of the longest topic."""
        return max((topic.duration for topic in self.topics if np.isfinite(topic.duration)), default=float("nan"))

    @property
    def kind(self) -> tuple:
        """What files of one kind share: format, and names of the columns of each topic."""
        return (self.layout.format, *(table.names for table in self.log.tables))


def survey_log(path: Path, stated: StatedColumns = NOTHING_STATED) -> LogSurvey:
    """Read a log of any format and summarise its topics; stated: what a person says of its columns.

    Raises:
        InputError: as `read_log`; a text file without rows of numbers.
    """
    from seatrial.data.read.record_file import require_file

    require_file(path)
    kind = format_of(path)
    layout = text_layout(path) if kind == "text" else Layout(kind, ColumnSpec("time", "", "s"), ())
    log = read_log(path, layout)
    time = next((heading for heading, meaning in stated.items() if meaning == TIME), "")
    return LogSurvey(path, layout, log, tuple(_topic_summary(table, layout, time) for table in log.tables), stated)


def apart_by_sheet(surveys: Sequence[LogSurvey]) -> list[LogSurvey]:
    """Return logs in which each sheet of a workbook whose sheets have the same columns is a log by itself."""
    return [one for survey in surveys for one in (_sheets(survey) or [survey])]


def _sheets(survey: LogSurvey) -> list[LogSurvey]:
    """The sheets with the most common columns, each alone; empty where no two are alike, and of other logs."""
    if survey.layout.format != _WORKBOOK:
        return []
    timed = [topic for topic in survey.topics if topic.time is not None]
    layouts = [tuple(column.name for column in one.columns) for one in timed]
    usual = max(layouts, key=layouts.count, default=())
    alike = [one for one, names in zip(timed, layouts, strict=True) if names == usual]
    tables = {table.topic: table for table in survey.log.tables}
    return [
        replace(survey, topics=(one,), log=replace(survey.log, tables=(tables[one.topic],))) for one in alike
    ] if len(alike) > 1 else []  # fmt: skip


def with_common_ranges(surveys: Sequence[LogSurvey]) -> list[LogSurvey]:
    """Return logs in which a column has the range of all logs with the same columns: of one craft they hold one."""
    ends: dict[tuple, tuple[float, float]] = {}
    for survey, topic, column in ((s, t, c) for s in surveys for t in s.topics for c in t.columns):
        low, high = ends.get(key := (survey.kind, topic.topic, column.number), (column.low, column.high))
        ends[key] = min(low, column.low), max(high, column.high)
    return [
        replace(
            survey,
            topics=tuple(
                replace(
                    topic,
                    columns=tuple(_ranged(one, ends[survey.kind, topic.topic, one.number]) for one in topic.columns),
                )
                for topic in survey.topics
            ),
        )
        for survey in surveys
    ]


def _ranged(column: ColumnSummary, ends: tuple[float, float]) -> ColumnSummary:
    return replace(column, low=ends[0], high=ends[1])


def _topic_summary(table: RawTable, layout: Layout, stated_time: str) -> TopicSummary:
    time, note = time_column(table, layout, stated_time)
    seconds = np.full(len(table), np.nan)
    if time is not None:
        seconds = stamps(table, time).seconds
    known = seconds[np.isfinite(seconds)]
    steps = np.diff(known)
    step = float(np.median(steps[steps > 0])) if np.any(steps > 0) else np.nan
    own = set() if time is None else {time.source, "time" if not time.source else time.source}
    own |= {time.nanoseconds, time.date, time.week} - {""} if isinstance(time, TimeSpec) else set()
    columns = [
        summary
        for index in range(len(table.names))
        if table.names[index] not in own and (summary := _column_summary(table, index)) is not None
    ]
    textual = [k for k, name in enumerate(table.names) if name not in own and column_values(table, k) is None]
    dates = [k for k in textual if is_date_column(table, k)]
    texts = tuple(table.names[k] or f"{k + 1}" for k in textual if k not in dates)
    faults = tuple(fault for k in textual if (fault := date_fault(table, k) if k in dates else _fault(table, k)))
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
