"""Which column of a table holds the time stamps, and in what unit: by name, size, step and cells."""

import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.data.draft.languages import in_english, without_accents
from seatrial.data.read.clock import stamps
from seatrial.data.read.layout import ColumnSpec, Layout, TimeSpec
from seatrial.data.read.raw_table import RawTable

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
    if stated in table.names and stated:
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
    row = int(known[back[0] + 1])
    return f"'{name}' runs backwards from {values[known[back[0]]]:g} to {values[row]:g} in row {table.first_row + row}"


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
