"""Time stamps as seconds, and columns with stamps of their own on one time base."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import cast

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.core.values.record import LATEST_TIME, MAX_SAMPLES
from seatrial.data.read.layout import ColumnSpec, TimeSpec
from seatrial.data.read.log import RawTable

# Time stamps as seconds: numbers, ISO 8601, date and time in two columns, whole seconds and nanoseconds, GNSS weeks,

_DAY_S, _WEEK_S, _NANO = 86400.0, 604800.0, 1e-9  # s, of a day, of a week, of a nanosecond
_GNSS_EPOCH_S = 315964800.0  # 1980-01-06 in s since 1970 (IS-GPS-200); leap seconds are not taken off
_FIRST_DATED_S = 1e8  # s since 1970 from which a stamp has a date; as where logs are grouped into runs
_EXCEL_EPOCH_DAYS = 25569.0  # days from 1899-12-30, where Excel counts from, to 1970-01-01
_HALF_DAYS = r"(\s*[AaPp]\.?[Mm]\.?)?"
_DATE_TIME = re.compile(
    rf"\d{{4}}[-/.]\d{{1,2}}[-/.]\d{{1,2}}([T ]\d{{1,2}}:\d{{2}}(:\d{{2}}([.,]\d*)?)?{_HALF_DAYS})?"
    r"\s*(Z|UTC|[+-]\d{2}:?\d{2})?"
)
_YEAR_LAST = re.compile(r"^(\d{1,2})([-/.])(\d{1,2})\2(\d{4})(?!\d)")
_TWELVE_HOURS = re.compile(r"(?<![\d:])(\d{1,2})(:\d{2}(?::\d{2}(?:[.,]\d*)?)?)\s*([AaPp])\.?[Mm]\.?")
_MONTHS, _NOON = 12, 12  # of a year; h, at which the clock of twelve hours begins anew
_TIME_OF_DAY = re.compile(rf"\d{{1,2}}:\d{{2}}:\d{{2}}([.,]\d*)?{_HALF_DAYS}")
_FRACTION = re.compile(r"(?<=:\d\d)[.,](\d+)")


@dataclass(frozen=True, eq=False)
class Stamps:
    """Time stamps of a table.

    Attributes:
        seconds: shape (n,), NaN where the cell is empty; since 1970, or as the logger counts.
        note: how they were read, for the provenance; empty where there is nothing to say.
    """

    seconds: Array
    note: str = ""


def stamps(table: RawTable, time: ColumnSpec) -> Stamps:
    """Return the time stamps of a table.

    Raises:
        InputError: no such column, a stamp that is neither a number nor a date, or a unit that is no time.
    """
    if isinstance(time, TimeSpec) and (time.date or time.nanoseconds or time.week):
        read = _completed(table, time)
    else:
        read = _column_stamps(table, time)
    offset = time.clock_offset if isinstance(time, TimeSpec) else 0.0
    return Stamps(read.seconds + offset, read.note)


def _completed(table: RawTable, time: TimeSpec) -> Stamps:
    """Stamps of two columns."""
    if time.nanoseconds:
        return Stamps(_numbers(table, time, time.source) + _NANO * _numbers(table, time, time.nanoseconds))
    if time.week:
        return Stamps(_GNSS_EPOCH_S + _WEEK_S * _numbers(table, time, time.week) + _numbers(table, time, time.source))
    days, clock = (table.cells[table.column_index(_other(time, place))] for place in (time.date, time.source))
    joined = [f"{str(day).strip()} {str(moment).strip()}" for day, moment in zip(days, clock, strict=True)]
    return _parsed(joined, table, time)


def _column_stamps(table: RawTable, time: ColumnSpec) -> Stamps:
    cells = table.cells[table.column_index(time)]
    if isinstance(cells, np.ndarray) and cells.dtype.kind == "M":
        return Stamps(np.asarray(cells.astype("datetime64[ns]").astype(np.int64) * _NANO, dtype=np.float64))
    first = next((text for cell in cells if (text := _text(cell))), "") if not _is_numeric(cells) else ""
    if _is_date(first):
        alike = _parsed_alike(cells, first)
        if alike is not None:
            return Stamps(*_with_days(alike))
        return _parsed([_text(cell) for cell in cells], table, time)
    if _TIME_OF_DAY.fullmatch(first):
        return _parsed([f"1970-01-01 {text}" if (text := _text(cell)) else "" for cell in cells], table, time)
    numbers = table.numbers(time)
    match time.unit:
        case "utc":
            raise InputError(
                f"{table.title}: {time.display_name}: '{first or _text(cells[0])}' is no date and time; give the "
                'unit of the number, such as "s" or "ms"'
            )
        case "hhmmss":
            return Stamps(_with_days(_clock_seconds(numbers), is_of_day=True)[0])
        case "excel":
            return Stamps((numbers - _EXCEL_EPOCH_DAYS) * _DAY_S)
        case _:
            return Stamps(numbers * time.si_factor("s"))


def _parsed_alike(cells: Sequence | np.ndarray, first: str) -> Array | None:
    """Seconds since 1970 of dates that are written in one length, fractions as decimals; None where they are not."""
    import pandas as pd

    texts = pd.Series(cells, dtype="str")
    lengths = texts.str.len()
    filled = lengths > 0
    if not bool((lengths[filled] == len(first)).all()):
        return None
    for written, plain in (("/", "-"), (",", "."), ("UTC", "")):
        if written in first:
            texts = texts.str.replace(written, plain, regex=False)
    try:
        parsed = pd.to_datetime(texts.where(filled, None), format="ISO8601", utc=True)
    except (ValueError, TypeError):
        return None
    moments = parsed.dt.tz_localize(None).to_numpy()
    whole = moments.astype("datetime64[s]")
    nanoseconds = (moments - whole).astype("timedelta64[ns]").astype(np.int64)
    seconds = whole.astype(np.int64) + nanoseconds / 1e9  # ns of a second: the nearest number to the decimal fraction
    seconds[np.isnat(moments)] = np.nan
    return seconds


def _parsed(texts: list[str], table: RawTable, time: ColumnSpec) -> Stamps:
    """Dates with their time of day as seconds since 1970, fractions padded as the order of the stamps demands."""
    import pandas as pd

    where = f"{table.title}: {time.display_name}"
    plain = [text.replace("/", "-").replace(",", ".").removesuffix("UTC") for text in _as_iso(texts, where)]
    whole = [_FRACTION.sub("", text) for text in plain]
    try:
        parsed = pd.to_datetime(pd.Series(whole).replace("", None), format="ISO8601", utc=True)
    except (ValueError, TypeError):
        row = next((k for k, text in enumerate(texts) if text and not _is_date(text)), 0)
        where = f"{table.title}: row {table.first_row + row}, {time.display_name}"
        raise InputError(
            f"{where}: '{texts[row][:40]}' is no date and time; write it as 2026-05-14T09:20:00.000Z, or give the unit "
            "of the number"
        ) from None
    seconds = cast("Array", parsed.to_numpy(dtype="datetime64[s]").astype("float64"))
    seconds[parsed.isna().to_numpy()] = np.nan
    digits = [match[1] if (match := _FRACTION.search(text)) else "" for text in plain]
    fractions, note = _fractions(digits, seconds)
    seconds = seconds + fractions
    is_of_day = bool(texts) and _text(texts[0]).startswith("1970-01-01 ")
    seconds, counted = _with_days(seconds, is_of_day=is_of_day)
    return Stamps(seconds, "; ".join(filter(None, (note, counted))))


def _as_iso(texts: Sequence[str], where: str) -> list[str]:
    """Dates with the year first and clocks of 24 hours, whatever order days and months are written in.

    With dots the day comes first. Otherwise a number beyond twelve shows the day; where there is none, the month comes
    first with a clock of twelve hours, and a column of one date is read day first.

    Raises:
        InputError: days and months may stand in either order.
    """
    dates = {match.groups() for text in texts if (match := _YEAR_LAST.match(text))}
    has_halves = any(_TWELVE_HOURS.search(text) for text in texts[:1])
    texts = [_TWELVE_HOURS.sub(_of_24_hours, text) for text in texts] if has_halves else list(texts)
    if not dates:
        return texts
    is_day_first = any(mark == "." or int(first) > _MONTHS for first, mark, _, _ in dates)
    is_month_first = any(mark != "." and int(second) > _MONTHS for _, mark, second, _ in dates) or has_halves
    if is_day_first is is_month_first and any(first != second for first, _, second, _ in dates):
        first, mark, second, year = next(date for date in dates if date[0] != date[2])
        raise InputError(
            f"{where}: '{first}{mark}{second}{mark}{year}' may be either of two days; write it as "
            f"{year}-{second}-{first} or {year}-{first}-{second}"
        )
    order = r"\4-\1-\3" if is_month_first and not is_day_first else r"\4-\3-\1"
    return [_YEAR_LAST.sub(order, text) for text in texts]


def _of_24_hours(clock: re.Match[str]) -> str:
    hour = int(clock[1]) % _NOON + (_NOON if clock[3] in "Pp" else 0)
    return f"{hour:02}{clock[2]}"


def _is_date(text: str) -> bool:
    return _DATE_TIME.fullmatch(_YEAR_LAST.sub(r"\4-\3-\1", text.strip())) is not None


def _fractions(digits: Sequence[str], seconds: Array) -> tuple[Array, str]:
    """Fractions of a second: decimal, or whole nanoseconds (micro-, milliseconds) that the logger did not pad.

    Un-padded are those of varying length of which fewer run backwards when they are read so.
    """
    decimal = np.array([float(f"0.{part}") if part else 0.0 for part in digits])
    lengths = {len(part) for part in digits if part}
    if len(lengths) < 2:
        return decimal, ""
    # digits of milli-, micro- and nanoseconds
    longest = next((size for size in (3, 6, 9) if size >= max(lengths)), max(lengths))
    padded = np.array([int(part) / 10.0**longest if part else 0.0 for part in digits])
    backward, padded_backward = (int(np.sum(np.diff(seconds + part) < 0)) for part in (decimal, padded))
    if padded_backward >= backward:
        return decimal, ""
    return padded, f"fractions of {backward} time stamps that ran backwards read as numbers of {longest} digits"


def _clock_seconds(numbers: Array) -> Array:
    """hhmmss.sss as seconds since midnight."""
    hours, minutes = np.floor(numbers / 1e4), np.floor(numbers / 1e2) % 100.0  # decimal digits of hhmm
    return hours * 3600.0 + minutes * 60.0 + numbers % 100.0  # s, of an hour and of a minute


def _with_days(seconds: Array, *, is_of_day: bool = False) -> tuple[Array, str]:
    """Seconds that go on counting when midnight passes and the logger's date does not, and a note; empty: none passed.

    A stamp of the day before that comes late stays there. is_of_day: they are seconds of a day: whatever goes back by
    more than half a day has passed midnight. Otherwise they are dated, and go back by a day less a step where their
    date was not advanced.
    """
    stamped = np.flatnonzero(np.isfinite(seconds))
    steps = np.diff(seconds[stamped])
    if not np.any(steps < -_DAY_S / 2.0):
        return seconds, ""
    sizes = np.abs(steps)
    usual = float(np.median(sizes[sizes < _DAY_S / 2.0])) if np.any(sizes < _DAY_S / 2.0) else 0.0
    is_jump = sizes > _DAY_S / 2.0 if is_of_day else np.abs(sizes - _DAY_S) <= _GAP_STEPS * usual
    days, counts = 0, np.zeros(stamped.size)
    for place in np.flatnonzero(is_jump).tolist():
        days = days + 1 if steps[place] < 0.0 else max(days - 1, 0)
        counts[place + 1 :] = days
    result = np.array(seconds)
    result[stamped] += _DAY_S * counts
    return result, "" if is_of_day or not counts.any() else "the date was not advanced at midnight: counted on"


def moment_text(seconds: float) -> str:
    """Return a stamp as messages write it: a date where it counts from 1970, else s."""
    if not _FIRST_DATED_S < seconds < LATEST_TIME:
        return f"{seconds:.6g} s"
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%d %H:%M:%S.%f}"[:-3]


def _numbers(table: RawTable, time: TimeSpec, source: str | int) -> Array:
    return table.numbers(_other(time, source))


def _other(time: TimeSpec, source: str | int) -> ColumnSpec:
    """Another column that completes the stamps."""
    return ColumnSpec(time.symbol, source, time.unit)


def _is_numeric(cells: Sequence | np.ndarray) -> bool:
    return isinstance(cells, np.ndarray) and cells.dtype.kind in "fiub"


def _text(cell: object) -> str:
    return "" if cell is None or cell != cell else str(cell).strip()


# Columns with time stamps of their own on one time base: commands held, angles unwrapped, the rest linear.

# steps of a topic over which nothing is interpolated unless a time is stated, ours
_GAP_STEPS = 5.0
# steps of a topic within which a stamp of it counts as equal to one of the base, ours
_ROUNDING_STEPS = 1e-3


@dataclass(frozen=True, eq=False)
class Series:
    """One column in SI units with the stamps of its topic; time [s] and values have shape (n,), in order of time."""

    column: ColumnSpec
    time: Array
    values: Array
    label: str
    topic: str = ""

    @property
    def step(self) -> float:
        """Median time between two samples [s]."""
        steps = np.diff(self.time)
        return float(np.median(steps[steps > 0])) if np.any(steps > 0) else float("inf")


def ordered_series(column: ColumnSpec, time: Array, values: Array, label: str, topic: str = "") -> Series:
    """Return the series of stamped, finite samples in order of time; of equal stamps the last sample counts."""
    known = np.isfinite(time) & np.isfinite(values)
    order = np.argsort(time[known], kind="stable")
    stamps, numbers = time[known][order], values[known][order]
    keep = np.append(np.diff(stamps) > 0, True) if stamps.size else np.zeros(0, dtype=bool)
    return Series(column, stamps[keep], numbers[keep], label, topic)


def common_time(series: Sequence[Series], rate: float | None) -> Array:
    """Return the even time base [s] of several series: from the latest start to the earliest end.

    A held series counts from its first sample on and has no end. rate: Hz; None: of the slowest measured series.

    Raises:
        InputError: a series has fewer than two samples, they do not overlap, or there would be too many samples.
    """
    measured = [one for one in series if not one.column.is_held] or list(series)
    for one in series:
        if one.time.size < (1 if one.column.is_held else 2):
            raise InputError(
                f"channel '{one.column.symbol}' ({one.label}): {one.time.size} samples, which is too few; leave it out"
            )
    slowest = max(measured, key=lambda one: one.step)
    step = 1.0 / rate if rate is not None else slowest.step
    start = max(one.time[0] for one in series)
    if rate is None and start <= slowest.time[-1]:
        start = slowest.time[np.searchsorted(slowest.time, start)]
    stop = min(one.time[-1] for one in measured)
    if not stop - start >= step:
        first, last = max(series, key=lambda one: one.time[0]), min(measured, key=lambda one: one.time[-1])
        raise InputError(
            f"channels '{first.column.symbol}' and '{last.column.symbol}' do not overlap in time: "
            f"{first.label} starts {first.time[0] - last.time[-1]:.6g} s after {last.label} ends; "
            "check their clocks, or set clock_offset"
        )
    if not (stop - start) / step < MAX_SAMPLES:
        raise InputError(
            f"{slowest.label}: {stop - start:.6g} s at {1.0 / step:.6g} Hz are over {MAX_SAMPLES:.0e} samples; set a "
            "lower rate, and check the unit of the time"
        )
    return start + step * np.arange(int((stop - start) / step + _ROUNDING_STEPS) + 1)


def values_at(one: Series, time: Array) -> Array:
    """Return the series at the times [s], shape (n,); NaN between samples further apart than five steps."""
    margin = _ROUNDING_STEPS * min(one.step, 1.0)
    before = np.searchsorted(one.time, time + margin, side="right") - 1
    if one.column.is_held:
        return np.where(before >= 0, one.values[np.maximum(before, 0)], np.nan)
    first, last = one.time[0], one.time[-1]
    near_end = ((time < first) & (time > first - margin)) | ((time > last) & (time < last + margin))
    time = np.where(near_end, np.clip(time, first, last), time)
    after = np.searchsorted(one.time, time - margin, side="left")
    is_angle = one.column.quantity.unit == "rad"
    smooth = np.unwrap(one.values) if is_angle else one.values
    values = np.interp(time, one.time, smooth, left=np.nan, right=np.nan)
    limit = _GAP_STEPS * one.step
    rows = len(one.time) - 1
    distance = one.time[np.clip(after, 0, rows)] - one.time[np.clip(before, 0, rows)]
    values[distance > limit] = np.nan
    return values
