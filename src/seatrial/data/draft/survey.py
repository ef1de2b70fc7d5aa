"""What is in a log, or in a folder of logs: layout, topics, columns, time stamps, rates, ranges."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.core.values.files import is_folder
from seatrial.data.draft.naming import NOTHING_STATED, TIME, StatedColumns, in_english, refuse_absent, without_accents
from seatrial.data.read import FORMATS, ColumnSpec, Layout, Log, format_of, read_log
from seatrial.data.read.clock import stamps
from seatrial.data.read.formats.text import text_layout
from seatrial.data.read.layout import TimeSpec
from seatrial.data.read.log import RawTable

# Which column of a table holds the time stamps, and in what unit: by name, size, step and cells.

# names of time columns in the order of preference, without a unit behind; ours, from the logs of a dozen programs
_TIME_NAMES = (
    "time", "t", "timestamp", "utc", "time_utc", "utc_time", "timestamp_utc", "utc_timestamp", "datetime", "date_time",
    "original_timestamp", "timeus", "seconds", "sec", "clock", "epoch", "unix", "unix_time", "epoch_time",
    "time_of_day", "header_stamp_secs", "header_stamp", "stamp",
)  # fmt: skip
_DATE_NAMES = ("date", "day", "utc_date", "date_utc")
_DATE_LIKE = re.compile(r"\d{1,4}[-/. ]\w{1,3}[-/. ]\d{1,4}")
_LONGEST_DATE = 20  # characters of a cell that a message quotes; chosen
_WEEK_NAMES, _WEEK_SECONDS = ("gps_week", "gnss_week", "week"), ("tow", "gps_tow", "time_of_week", "seconds_of_week")
_WHOLE_SECONDS = re.compile(r"(.*_)?(secs?|seconds)")
_NANOSECONDS = ("nsecs", "nsec", "nanosecs", "nanosec", "nanoseconds")
_UNITS = {
    "s": "s", "sec": "s", "secs": "s", "seconds": "s", "ms": "ms", "us": "us", "ns": "ns", "min": "min", "h": "h",
    "hhmmss": "hhmmss", "excel": "excel",
}  # fmt: skip
"""What a name of a time column ends with -> unit."""
_DAY_S = 86400.0  # s of a day
# stamps since 1970 that lie between 1979 and 2096 [s], with steps between these [s]; chosen: what logs have
_SINCE_1970, _STEPS_S = (3e8, 4e9), (1e-4, 60.0)
# a clock of six digits, hhmmss: 24 h, where seconds and minutes end, two digits each; by definition
_MIDNIGHT, _SIXTY, _TWO_DIGITS = 240000.0, 60.0, 100.0
# stamps that show a clock, and share of the steps' range that is left when they are read so; chosen
_FEWEST_STAMPS, _EVENED = 3, 0.5
_EXCEL_DAYS, _LARGEST_EXCEL_STEP = (2e4, 8e4), 2e-4  # days, of the years 1954 to 2119; days, of 17 s
# unit -> units of it beyond which a median step is in the next smaller unit (a log has 0.2 Hz or more)
_STEP_LIMITS = {"ns": 5e6, "us": 5e3, "ms": 5.0}


def time_column(table: RawTable, layout: Layout, stated: str = "") -> tuple[ColumnSpec | None, str]:
    """Return the column of time stamps and how it was recognised: the format's own, by name, cells, or behaviour.

    stated: the name of the column that a person says is the time; empty: none.
    By its cells it is the only column of dates with times, or else of times of day, that increase; by behaviour the
    first column of numbers that increases throughout in nearly equal steps.
    """
    if table.time_name:
        return ColumnSpec("time", "", "s"), f"time of the {layout.format} log"
    if stated in _headings(table):
        return _with_unit(table, stated, "")[0], "as stated"
    plain = {_plain_name(name): name for name in reversed(table.names) if name}
    completed = _of_two_columns(plain)
    if completed is not None:
        return completed
    fault = ""
    for name, unit in _named_as_time(plain, dict(zip(table.names, table.units, strict=False))):
        fault = fault or _backwards(table, name)
        spec, note = _with_unit(table, name, unit)
        if spec is not None:
            return _with_date(table, spec, plain), f"named '{name}', {note}"
    daily = [index for index in range(len(table.names)) if _has_increasing_times_of_day(table, index)]
    dated = [k for k in range(len(table.names)) if k not in daily and _has_increasing_dates(table, k)]
    if len(dated) == 1:
        source = table.names[dated[0]] or dated[0] + 1
        return ColumnSpec("time", source, "utc"), "the only column of dates and times"
    if len(daily) == 1 and not dated:
        source = table.names[daily[0]] or daily[0] + 1
        return _with_date(table, ColumnSpec("time", source, "utc"), plain), "the only column of times of day"
    for index in range(len(table.names)):
        values = column_values(table, index)
        if values is not None and _is_clock(values):
            spec, note = _with_unit(table, table.names[index] or index + 1, "")
            return spec, f"the only column that increases evenly, {note}"
    return None, fault


def _headings(table: RawTable) -> tuple[str, ...]:
    """The names of the columns; of one without a name its number."""
    return tuple(name or f"{k}" for k, name in enumerate(table.names, start=1))


def _of_two_columns(plain: dict[str, str]) -> tuple[TimeSpec, str] | None:
    """Whole seconds and nanoseconds, or GNSS weeks and seconds of the week."""
    for name, source in plain.items():
        match = _WHOLE_SECONDS.fullmatch(name)
        prefix = (match[1] or "") if match else ""
        rest = next((plain[prefix + word] for word in _NANOSECONDS if match and prefix + word in plain), None)
        if rest is not None:
            spec = TimeSpec("time", source, "s", nanoseconds=rest)
            return spec, "stamp of the message's header, seconds and nanoseconds"
    week = next((plain[name] for name in _WEEK_NAMES if name in plain), None)
    tow = next((plain[name] for name in _WEEK_SECONDS if name in plain), None)
    if week is None or tow is None:
        return None
    return TimeSpec("time", tow, "s", week=week), "GNSS week and seconds of the week"


def _named_as_time(plain: dict[str, str], units: dict[str, str]) -> Iterator[tuple[str, str]]:
    """Columns that are called as time is, in the order of preference, with the unit that the name or its bracket ends
    with, or that the line of units gives.
    """
    for wanted in _TIME_NAMES:
        for name, source in plain.items():
            head, _, last = name.rpartition("_")
            if name == wanted:
                bracket = re.search(r"[\[(](\w+)[\])]", source)
                yield source, _UNITS.get((bracket[1] if bracket else units.get(source, "")).strip().lower(), "")
            elif head == wanted and last in _UNITS:
                yield source, _UNITS[last]


def _with_date(table: RawTable, spec: ColumnSpec, plain: dict[str, str]) -> ColumnSpec:
    """The time of day with the column of its date, where there is one."""
    date = next((plain[name] for name in _DATE_NAMES if name in plain), None)
    if date is None or date == spec.source or spec.unit != "utc":
        return spec
    dated = TimeSpec(spec.symbol, spec.source, spec.unit, date=date)
    try:
        seconds = stamps(table, dated).seconds
    except InputError:
        return spec
    known = seconds[np.isfinite(seconds)]
    return dated if known.size and np.all(np.diff(known) >= 0.0) else spec


def is_date_column(table: RawTable, index: int) -> bool:
    """Return whether a column of text is called as dates are, in any language, and holds what looks like one."""
    is_called = _plain_name(table.names[index]) in _DATE_NAMES
    return is_called and len(table) > 0 and _DATE_LIKE.match(str(table.cells[index][0]).strip()) is not None


def date_fault(table: RawTable, index: int) -> str:
    """Return why the dates of a column of them cannot be read; empty where they can."""
    try:
        stamps(table, ColumnSpec("time", index + 1, "utc"))
    except InputError:
        cell = str(table.cells[index][0]).strip()[:_LONGEST_DATE]
        return f"'{table.names[index]}': '{cell}' is no date that is read; as 2026-10-08 or 8.10.2026 it would be"
    return ""


def _backwards(table: RawTable, name: str) -> str:
    """Where a clock of numbers runs backwards; empty where it does not."""
    values = column_values(table, table.names.index(name))
    known = np.flatnonzero(np.isfinite(values)) if values is not None else np.empty(0, dtype=np.intp)
    back = np.flatnonzero(np.diff(values[known]) < 0.0) if values is not None else known
    if values is None or not back.size:
        return ""
    before, row = int(known[back[0]]), int(known[back[0] + 1])
    ends = f"from {values[before]:.10g} to {values[row]:.10g}"
    return f"'{name}' runs backwards {ends} in row {table.first_row + row}"


def _plain_name(name: str) -> str:
    """A column's name in small letters without what stands in brackets, in English where it is in a known language."""
    plain = re.sub(r"[ /.]", "_", without_accents(name.partition("[")[0].partition("(")[0].strip()))
    return in_english(plain)


def _with_unit(table: RawTable, source: str | int, stated: str) -> tuple[ColumnSpec | None, str]:
    """The time column with the unit of its numbers, stated or by size and step; text is read by itself."""
    spec = ColumnSpec("time", source, stated or "s")
    values = column_values(table, table.column_index(spec))
    if values is None:
        return replace(spec, unit="utc"), "dates and times"
    known = values[np.isfinite(values)]
    if stated in ("", "hhmmss") and _is_hhmmss(table, replace(spec, unit="hhmmss"), known):
        return replace(spec, unit="hhmmss"), "hours, minutes and seconds in one number"
    steps = np.diff(known)
    if not steps.size or np.any(steps < 0) or not np.any(steps > 0):
        return None, ""
    if stated:
        return spec, "with its unit"
    step, size = float(np.median(steps[steps > 0])), float(np.median(known))
    if _EXCEL_DAYS[0] < size < _EXCEL_DAYS[1] and step < _LARGEST_EXCEL_STEP:
        return replace(spec, unit="excel"), "days since 1899-12-30 by their size and step"
    for unit in ("s", "ms", "us", "ns"):
        factor = replace(spec, unit=unit).si_factor("s")
        if _SINCE_1970[0] < factor * size < _SINCE_1970[1] and _STEPS_S[0] < factor * step < _STEPS_S[1]:
            return replace(spec, unit=unit), f"{unit} since 1970 by their size"
    unit = next((unit for unit, limit in _STEP_LIMITS.items() if step > limit), "s")
    return replace(spec, unit=unit), "unit by its step"


def _is_hhmmss(table: RawTable, spec: ColumnSpec, numbers: Array) -> bool:
    """Whether numbers are hours, minutes and seconds in digits, none beyond 59, whose steps even out when read so."""
    if numbers.size < _FEWEST_STAMPS or np.min(numbers) < 0.0 or np.max(numbers) >= _MIDNIGHT:
        return False
    digits = numbers % _TWO_DIGITS, numbers // _TWO_DIGITS % _TWO_DIGITS
    if np.ptp(numbers) < _SIXTY or np.any(np.maximum(*digits) >= _SIXTY):
        return False
    seconds = stamps(table, spec).seconds
    evened = float(np.ptp(np.diff(seconds[np.isfinite(seconds)])))
    return evened < _EVENED * float(np.ptp(np.diff(numbers)))


def column_values(table: RawTable, index: int) -> Array | None:
    """Return a column as numbers; None where it holds text."""
    try:
        return table.numbers(ColumnSpec("column", index + 1, ""))
    except InputError:
        return None


def _has_increasing_dates(table: RawTable, index: int) -> bool:
    """Whether a column of text holds dates with their time of day that do not go back; a day alone is no stamp."""
    seconds = _text_stamps(table, index)
    dated = seconds[np.isfinite(seconds) & (seconds >= _DAY_S)]  # before: a time of day without a date
    has_times = bool(np.any(dated % _DAY_S > 0.0))
    return has_times and bool(np.all(np.diff(dated) >= 0.0)) and dated[0] < dated[-1]


def _has_increasing_times_of_day(table: RawTable, index: int) -> bool:
    """Whether a column of text holds times of day, none missing, that do not go back."""
    seconds = _text_stamps(table, index)
    if seconds.size < _FEWEST_STAMPS or not np.all(np.isfinite(seconds)):
        return False
    return bool(seconds[0] < _DAY_S and seconds[0] < seconds[-1] and np.all(np.diff(seconds) >= 0.0))


def _text_stamps(table: RawTable, index: int) -> Array:
    """The cells of a column of text as stamps [s]; none where it holds numbers, or something else."""
    if column_values(table, index) is not None:
        return np.empty(0)
    try:
        return stamps(table, ColumnSpec("time", index + 1, "utc")).seconds
    except InputError:
        return np.empty(0)


def _is_clock(values: Array) -> bool:
    steps = np.diff(values)
    if steps.size < 2 or not np.all(np.isfinite(steps)) or not np.all(steps > 0):
        return False
    return float(np.ptp(steps)) < 0.5 * float(np.median(steps))  # steps that differ by less than half of one: a clock


# What is in a log: topics, columns, rates, ranges, share missing.

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
        clock_note: how stamps were read that run back or in odd steps; empty: there is nothing to say.
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
    clock_note: str = ""


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
    def notes(self) -> tuple[str, ...]:
        """What is to be known of how it was read, and of what of it is not read."""
        return tuple(dict.fromkeys((*self.log.notes, *(topic.clock_note for topic in self.topics if topic.clock_note))))

    @property
    def headings(self) -> tuple[str, ...]:
        """The headings of its columns, those of text before those of numbers."""
        columns = [column.name for topic in self.topics for column in topic.columns]
        return (*(name for topic in self.topics for name in topic.text_columns), *columns)

    @property
    def kind(self) -> tuple:
        """What files of one kind share: format, and names of the columns of each topic."""
        return (self.layout.format, *(table.names for table in self.log.tables))


def columns_by_source(survey: LogSurvey) -> dict[str | int, tuple[TopicSummary, ColumnSummary]]:
    """Return source as a guess has it -> topic and column, of topics with a time."""
    columns = dict[str | int, tuple[TopicSummary, ColumnSummary]]()
    for topic in survey.topics:
        for column in topic.columns if topic.time is not None else ():
            columns[f"{topic.topic}/{column.name}" if topic.topic else column.name] = topic, column
            columns |= {} if topic.topic else {column.number: (topic, column)}
    return columns


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
    """Return logs in which a column has the range of all logs with the same columns: of one craft they hold one.

    The only topic of each may have any name, as sheets have.
    """
    ends: dict[tuple, tuple[float, float]] = {}
    for survey, topic, column in ((s, t, c) for s in surveys for t in s.topics for c in t.columns):
        low, high = ends.get(key := _place(survey, topic, column), (column.low, column.high))
        ends[key] = min(low, column.low), max(high, column.high)
    return [
        replace(
            survey,
            topics=tuple(
                replace(
                    topic,
                    columns=tuple(_ranged(one, ends[_place(survey, topic, one)]) for one in topic.columns),
                )
                for topic in survey.topics
            ),
        )
        for survey in surveys
    ]


def _place(survey: LogSurvey, topic: TopicSummary, column: ColumnSummary) -> tuple:
    return survey.kind, topic.topic if len(survey.topics) > 1 else "", column.number


def _ranged(column: ColumnSummary, ends: tuple[float, float]) -> ColumnSummary:
    return replace(column, low=ends[0], high=ends[1], is_constant=ends[0] == ends[1])


def _topic_summary(table: RawTable, layout: Layout, stated_time: str) -> TopicSummary:
    time, note = time_column(table, layout, stated_time)
    seconds = np.full(len(table), np.nan)
    clock_note = ""
    if time is not None:
        clock = stamps(table, time)
        seconds, clock_note = clock.seconds, clock.note
    known = seconds[np.isfinite(seconds)]
    steps = np.diff(known)
    step = float(np.median(steps[steps > 0])) if np.any(steps > 0) else np.nan
    own = set() if time is None else {time.source, "time" if not time.source else time.source}
    own |= {time.nanoseconds, time.date, time.week} - {""} if isinstance(time, TimeSpec) else set()
    places = [k for k, heading in enumerate(_headings(table)) if heading not in own and k + 1 not in own]
    repeated = {name for name, count in Counter(table.names).items() if name and count > 1}
    columns = [summary for k in places if (summary := _column_summary(table, k, repeated)) is not None]
    textual = [k for k in places if column_values(table, k) is None]
    dates = [k for k in textual if is_date_column(table, k)]
    texts = tuple(table.names[k] or f"{k + 1}" for k in textual if k not in dates)
    faults = tuple(fault for k in textual if (fault := date_fault(table, k) if k in dates else _fault(table, k)))
    duration = float(known[-1] - known[0]) if known.size > 1 else float("nan")
    start = float(known[0]) if known.size else float("nan")
    return TopicSummary(
        table.topic, time, len(table), 1.0 / step, start, duration, tuple(columns), note, texts, faults, clock_note
    )


def _column_summary(table: RawTable, index: int, repeated: Set[str]) -> ColumnSummary | None:
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
    name, is_repeated = table.names[index] or f"{index + 1}", table.names[index] in repeated
    return ColumnSummary(name, unit, low, high, missing, low == high, common, index + 1, is_repeated)


def _fault(table: RawTable, index: int) -> str:
    """Where a column that begins with numbers holds none; empty for one of text."""
    row = table.first_text_row(index)
    if row is None or row == 0:
        return ""
    name, cell = table.names[index] or f"{index + 1}", str(table.cells[index][row])[:_LONGEST_CELL]
    return f"'{name}': row {table.first_row + row} holds '{cell}', no number"


# The logs among files and folders: each surveyed, and what is none with the reason.


@dataclass(frozen=True, eq=False)
class SurveyedLogs:
    """The logs among files and folders, in order, and the files of folders that are none: path -> reason."""

    logs: tuple[LogSurvey, ...]
    left_out: Mapping[Path, str]


def survey_logs(paths: Sequence[Path], stated: StatedColumns = NOTHING_STATED) -> SurveyedLogs:
    """Survey the files, and those of known endings in the folders; a file that is named must be a log.

    Raises:
        InputError: there is none, one that is named cannot be read, or no log has a stated column.
    """
    named = {path for path in paths if not is_folder(path)}
    surveys, reasons = list[LogSurvey](), dict[Path, str]()
    for path in _log_files(paths):
        try:
            survey = survey_log(path, stated)
        except InputError as error:
            if path in named:
                raise
            reasons[path] = str(error)
            continue
        if path in named or any(topic.time is not None for topic in survey.topics):
            surveys.append(survey)
        else:
            reasons[path] = f"no column is a time{_how_to_state(survey, TIME)}"
    if not surveys:
        first = next(iter(reasons.items()))
        raise InputError(f"there is no log to draft a trial of: {first[0]}: {first[1]}")
    refuse_absent(stated, (name for survey in surveys for table in survey.log.tables for name in _headings(table)))
    return SurveyedLogs(tuple(surveys), reasons)


def _how_to_state(survey: LogSurvey, meaning: str) -> str:
    """The end of a sentence that says how a column is named: with the first one of text, or else of all."""
    headings = survey.headings[:1]
    return "".join(f"; if it is '{heading}', add --column '{heading}={meaning}'" for heading in headings)


def _log_files(paths: Sequence[Path]) -> list[Path]:
    """The files, and those of known endings in the folders."""
    known = {suffix for one in FORMATS.values() for suffix in one.suffixes}
    files = []
    for one in paths:
        if is_folder(one):
            inside = sorted(path for path in one.rglob("*") if path.is_file())
            files += [path for path in inside if Path(path.name.removesuffix(".gz")).suffix.lower() in known]
        else:
            files.append(one)
    if not files:
        raise InputError("there is no log to draft a trial of; name files, or a folder with logs")
    return files
