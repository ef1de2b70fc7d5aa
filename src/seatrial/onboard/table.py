"""A snapshot as a table for a terminal, in words and rounded numbers, with the recent course of each coefficient."""

import math
from collections import deque
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.results.online import (
    CoefficientChange,
    EstimatorPhase,
    Proposal,
    SampleCounts,
    SeaEstimate,
    Snapshot,
)
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.text.numbers import DASH, duration, exponent, fixed, percent, raised, significant
from seatrial.core.text.words import counted, enumeration, printable
from seatrial.core.values import Array, Severity, display_unit, worst_first
from seatrial.core.values.notation import channel_unit, unit_text

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.table import Table


# A snapshot in words and rounded numbers: one text for the terminal and for the page.

# quantile of the standard normal distribution for 95 %, two-sided
NORMAL_95 = 1.96
# s: a clock that shows more counts from 1970; chosen: three years later, longer than any stream from its own start
FIRST_UNIX_TIME = 1e8
_PHASE_MEANINGS = {
    EstimatorPhase.WAITING: "too few samples for an estimate yet",
    EstimatorPhase.WINDOW: "fit over all samples, repeated as they grow",
    EstimatorPhase.RECURSIVE: "filter that continues the fit, sample by sample",
}
_NOTHING_FREE = "every coefficient is fixed: nothing to estimate"
_FAULT_NAMES = {
    "late": "late", "repeated": "repeated", "not_finite": "not a number", "missing": "missing", "jumps": "clock jumps",
    "garbled": "garbled", "checksum": "wrong checksum", "dropped": "dropped", "truncated": "file truncated",
}  # fmt: skip


@dataclass(frozen=True)
class EstimateRow:
    """One coefficient as text: value and 95 % interval with the same decimals, in `unit`, which names 10^`power`.

    error_percent: standard error in per cent of the value; is_identified: False where the data do not determine it.
    """

    name: str
    value: str
    half_width: str
    lower: str
    upper: str
    unit: str
    power: int
    error_percent: str
    is_identified: bool


def phase_meaning(snapshot: Snapshot) -> str:
    """Return what the phase means, in words."""
    return _PHASE_MEANINGS[snapshot.phase] if snapshot.names else _NOTHING_FREE


def estimate_rows(snapshot: Snapshot) -> list[EstimateRow]:
    """Return the coefficients in the model's order; angles in degrees."""
    unidentified = set(snapshot.unidentified)
    columns = zip(snapshot.names, snapshot.units, snapshot.value, snapshot.standard_error, strict=True)
    return [
        _estimate_row(name, unit, float(value), float(error), name not in unidentified)
        for name, unit, value, error in columns
    ]


def residual_rms(snapshot: Snapshot) -> list[tuple[str, str, str]]:
    """Return channel, rms of measured minus simulated, unit; angles in degrees."""
    units = {channel: channel_unit(channel) for channel in snapshot.noise}
    return [(printable(channel), significant(display_unit(units[channel])[0] * rms, 3), unit_text(units[channel]))
            for channel, rms in snapshot.noise.items()]  # fmt: skip


def fault_counts(counts: SampleCounts) -> list[tuple[str, int]]:
    """Return each kind of fault in words and its count, always in the same order."""
    return [(words, getattr(counts, key)) for key, words in _FAULT_NAMES.items()]


def faults_text(counts: SampleCounts) -> str:
    """Return the faults that occurred: ``3 late, 1 garbled``; empty for none."""
    return ", ".join(f"{count} {words}" for words, count in fault_counts(counts) if count)


def change_sentence(change: CoefficientChange | None) -> str:
    """Return a change in sentences; empty if there is none."""
    if change is None:
        return ""
    if not change.is_believed:
        return (
            f"The {change_text(change)}, so it seemed; others, or residuals that are not white, followed within a "
            "minute: the model or its inputs are off. Changes are not watched any longer."
        )
    return (
        f"The {change_text(change)}, {printable(change.most_changed)} most clearly. "
        "What is shown comes from later samples alone."
    )


def watch_sentence(snapshot: Snapshot) -> str:
    """Return a change in sentences, else why none is watched; empty where there is nothing to say."""
    return change_sentence(snapshot.change) or snapshot.unwatched


def change_text(change: CoefficientChange) -> str:
    """Return when the coefficients changed: ``coefficients changed between 201.0 s and 203.0 s``."""
    first, last = map(time_text, change.between)
    return f"coefficients changed {f'between {first} and {last}' if first != last else f'at {first}'}"


def time_text(time: float) -> str:
    """Return a time of the stream's clock: seconds, or a date where they count from 1970."""
    if not math.isfinite(time):
        return DASH
    if FIRST_UNIX_TIME <= time < 100 * FIRST_UNIX_TIME:
        return datetime.fromtimestamp(time, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    return f"{fixed(time, 1)} s"


def _estimate_row(name: str, unit: str, value: float, error: float, is_identified: bool) -> EstimateRow:
    factor, si_text = display_unit(unit)[0], printable(unit_text(unit))
    value, error = factor * value, factor * error
    half, is_finite = NORMAL_95 * error, math.isfinite(value) and math.isfinite(error)
    share = percent(error / abs(value) if value != 0.0 and is_finite else math.inf)
    if not is_finite or half <= 0.0:
        return EstimateRow(printable(name), significant(value, 4), DASH, DASH, DASH, si_text, 0, share, is_identified)
    largest = max(abs(value), half)
    # sizes outside this range are written with a power of ten; chosen, as in `significant`
    power = 0 if 1e-2 <= largest < 1e5 else exponent(largest, 2)
    scale = 10.0**power
    # no more than seven digits of the largest: a value known to a millionth is known
    decimals = min(1 - exponent(half / scale, 2), 6 - exponent(largest / scale, 2))
    text, width, *ends = (fixed(x / scale, decimals) for x in (value, half, value - half, value + half))
    unit = f"10{raised(power)} {si_text}".strip() if power else si_text
    return EstimateRow(printable(name), text, width, ends[0], ends[1], unit, power, share, is_identified)


# A proposal of gains in words: one text for the terminal and for the page.

_DIGITS = 3  # of gains and margins; chosen: a regulator's display has as many
_LONGEST = 1000  # letters of the reasons; chosen: longer than any of ours
_MOST_RANGES = 3  # ranges of headings that are named; chosen


def proposal_lines(proposal: Proposal) -> list[tuple[str, str]]:
    """Return label and text of each line: gains, why, margins, sea, craft; none is empty."""
    lines = [
        ("proposed gains", gains_text(proposal)),
        ("why", reasons_text(proposal)),
        ("margins", margins_text(proposal)),
        ("sea", sea_text(proposal.sea)),
        ("craft over model", craft_text(proposal)),
    ]
    return [(label, text) for label, text in lines if text]


def gains_text(proposal: Proposal) -> str:
    """Return the gains with their units, or that there are none."""
    if not proposal.has_gains:
        return "none"
    gains = [
        f"{name} {significant(value, _DIGITS)} {_unit(proposal.gain_units.get(name, ''))}".rstrip()
        for name, value in proposal.gains.items()
    ]
    return ", ".join(map(printable, gains)) + (" (new)" if proposal.is_new else " (as before)")


def reasons_text(proposal: Proposal) -> str:
    """Return the reasons as one text."""
    return printable(" ".join(proposal.reasons), _LONGEST)


def sea_text(sea: SeaEstimate | None) -> str:
    """Return height, peak period and heading with their 95 % intervals; nothing without an estimate."""
    if sea is None:
        return ""
    height, period = _interval(sea.height, "m"), _interval(sea.period, "s")
    ranges = [
        f"{math.degrees(one.lower):.0f} to {math.degrees(one.upper):.0f} deg ({100.0 * one.probability:.0f} %)"
        for one in sea.headings
    ]
    if sea.is_heading_determined:
        heading = _interval(sea.heading, "deg", math.degrees(1.0))
    else:
        heading = f"not determined, {enumeration(ranges, _MOST_RANGES)}"
    return f"height {height}, peak period {period}, heading (0 following) {heading}"


def craft_text(proposal: Proposal) -> str:
    """Return the craft's factors with their 95 % intervals; nothing without an estimate."""
    return ", ".join(f"{one.name} {_interval(one.factor)}" for one in proposal.craft)


def margins_text(proposal: Proposal) -> str:
    """Return the margins with their 95 % intervals over the draws of sea and craft; nothing without gains."""
    m = proposal.margins
    if m is None:
        return ""
    parts = [f"Ms {_interval(m.Ms)}"]
    for name, one, unit, factor in (
        ("gain margin", m.gain_margin, "", 1.0),
        ("phase margin", m.phase_margin, "deg", math.degrees(1.0)),
        ("delay margin", m.delay_margin, "s", 1.0),
        ("reduction", m.reduction, "%", 100.0),
    ):
        parts.append(f"{name} {_interval(one, unit, factor)}")
    return ", ".join(parts) + f"; stable on {m.stable_draws} of {m.draws}"


def _interval(one: IntervalEstimate, unit: str = "", factor: float = 1.0) -> str:
    low, middle, high = (_number(factor * value) for value in (one.lower, one.value, one.upper))
    return f"{middle} [{low}, {high}] {unit}".rstrip()


def _number(value: float) -> str:
    return significant(value, _DIGITS) if math.isfinite(value) else "any"


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


# The estimates since the stream began, thinned so that a week of them fits in memory.


@dataclass(frozen=True, eq=False)
class HistoryPoint:
    """One earlier snapshot.

    Attributes:
        sequence: its number, from 0; elapsed: s of samples until then, breaks of the clock left out.
        value, standard_error: (k,), SI; noise: channel -> residual rms, SI.
    """

    sequence: int
    elapsed: float
    names: tuple[str, ...]
    value: Array
    standard_error: Array
    noise: dict[str, float]


class History:
    """At most `limit` points: every `stride`-th snapshot from the first on, and the newest.

    The stride doubles when there are more, so that the points stay evenly spaced over the whole time.
    """

    def __init__(self, limit: int = 2000) -> None:  # points, chosen: more than a screen has columns
        self.limit = max(4, limit)
        self.stride = 1
        self.generation = 0
        self.names: tuple[str, ...] = ()
        self._count = 0
        self._points: list[HistoryPoint] = []
        self._elapsed = 0.0
        self._last: Snapshot | None = None

    def add(self, snapshot: Snapshot) -> HistoryPoint:
        """Append a snapshot; one of other coefficients begins a new history, of the next generation."""
        if self._last is not None and snapshot.names != self.names:
            self._restart()
        self.names = snapshot.names
        self._elapsed += _time_step(self._last, snapshot)
        self._last = snapshot
        value, error = snapshot.value.copy(), snapshot.standard_error.copy()
        point = HistoryPoint(self._count, self._elapsed, snapshot.names, value, error, dict(snapshot.noise))
        self._count += 1
        if self._points and self._points[-1].sequence % self.stride:
            self._points.pop()
        self._points.append(point)
        while len(self._points) > self.limit:
            self.stride *= 2
            self._points = [p for p in self._points if p is point or p.sequence % self.stride == 0]
        return point

    def since(self, sequence: int) -> list[HistoryPoint]:
        """Return the points after that number, oldest first; all of them for -1."""
        return [p for p in self._points if p.sequence > sequence]

    @property
    def newest(self) -> HistoryPoint | None:
        """The last point; None before the first."""
        return self._points[-1] if self._points else None

    def __len__(self) -> int:
        return len(self._points)

    def _restart(self) -> None:
        self.generation += 1
        self.stride, self._count, self._points, self._elapsed, self._last = 1, 0, [], 0.0, None


class RecentHistory:
    """The last minutes: points of the last `seconds` s, at most `limit` of them."""

    def __init__(self, seconds: float = 180.0, limit: int = 180) -> None:
        self.seconds = seconds
        self._spacing = seconds / limit
        self._points: deque[HistoryPoint] = deque()

    def add(self, point: HistoryPoint) -> None:
        """Append a point; it replaces the newest where that one is closer to its predecessor than the spacing."""
        points = self._points
        if points and points[-1].names != point.names:
            points.clear()
        if len(points) > 1 and points[-1].elapsed - points[-2].elapsed < self._spacing:
            points.pop()
        points.append(point)
        while points[0].elapsed < point.elapsed - self.seconds:
            points.popleft()

    @property
    def value(self) -> Array:
        """(n, k), oldest first."""
        return np.array([p.value for p in self._points])

    @property
    def standard_error(self) -> Array:
        """(n, k), oldest first."""
        return np.array([p.standard_error for p in self._points])


def _time_step(previous: Snapshot | None, current: Snapshot) -> float:
    """s from one snapshot to the next; none where a new run began in between or a clock went back."""
    if previous is None or current.runs != previous.runs:
        return 0.0
    step = current.time - previous.time
    return step if 0.0 < step < float("inf") else 0.0


# A snapshot as a table for a terminal, with the recent course of each coefficient in a few characters.

BARS = "▁▂▃▄▅▆▇█"
# ratios of intervals that count as narrower and wider
NARROWER, WIDER = 0.9, 1.1


def sparkline(values: Array, half_width: float, width: int = 12) -> str:
    """Return the course of a value as bars, newest last; a change that is small against the interval looks flat.

    values: (n,) over the last minutes; half_width: half of the interval now, sets the least height shown.
    """
    finite = values[np.isfinite(values)]
    if len(finite) < 2:
        return ""
    picked = finite[np.linspace(0, len(finite) - 1, min(width, len(finite))).round().astype(int)]
    low, high = float(picked.min()), float(picked.max())
    least = 2.0 * half_width if math.isfinite(half_width) else 0.0
    reach = max(high - low, least)
    if reach <= 0.0:
        return BARS[3] * len(picked)
    bottom = 0.5 * (low + high) - 0.5 * reach
    levels = np.clip((picked - bottom) / reach * len(BARS), 0, len(BARS) - 1).astype(int)
    return "".join(BARS[k] for k in levels)


def trend_arrow(errors: Array) -> str:
    """Return whether the interval became narrower (↘), wider (↗) or stayed (→) over the last minutes.

    errors: (n,) standard errors, newest last.
    """
    finite = errors[np.isfinite(errors) & (errors > 0)]
    if len(finite) < 2:
        return ""
    ratio = float(finite[-1] / finite[0])
    return "↘" if ratio < NARROWER else "↗" if ratio > WIDER else "→"


# findings in the table and coefficients named in a line at most; chosen: the table stays on one screen
MAX_FINDINGS, MAX_NAMES = 3, 8
# characters of a line from which on the trends are shown beside the numbers; s without a sample that are said
MIN_TREND_WIDTH, SILENCE_S = 76, 5.0
# coefficients shown on the lowest screen; lines of it that hold no coefficient
MIN_ROWS, RESERVED_LINES = 3, 4
_STYLES = {EstimatorPhase.WAITING: "yellow", EstimatorPhase.WINDOW: "green", EstimatorPhase.RECURSIVE: "cyan"}


@dataclass(frozen=True, eq=False)
class TableContent:
    """What a table shows; silence: s since the last sample arrived."""

    heading: str
    snapshot: Snapshot
    counts: SampleCounts
    recent: RecentHistory
    silence: float = 0.0


def render_table(console: "Console", content: TableContent, height: int | None) -> "RenderableType":
    """Return head, coefficients and notes; at most as many coefficients as fit in `height` lines, if given."""
    from rich.console import Group
    from rich.text import Text

    head, foot, every = _head(content), _foot(content.snapshot, content.counts), estimate_rows(content.snapshot)
    most = len(every)
    if height is not None:
        free = height - RESERVED_LINES - sum(len(console.render_lines(part)) for part in (head, foot))
        most = most if most <= free else max(MIN_ROWS, free - 1)
    more = [Text(f"and {len(every) - most} more", "dim")] if most < len(every) else []
    return Group(head, _coefficient_table(every[:most], content.recent, console.width), *more, Text(), foot)


def _head(content: TableContent) -> "RenderableType":
    from rich.console import Group
    from rich.text import Text

    snapshot = content.snapshot
    head = Text(no_wrap=True, overflow="ellipsis")
    head.append(snapshot.phase.value, f"bold {_STYLES[snapshot.phase]}")
    time = time_text(snapshot.time)
    head.append(f"  {time}  {counted(snapshot.samples, 'sample')}  {counted(snapshot.runs, 'run')}  ")
    if content.silence > SILENCE_S:
        head.append(f"no samples for {duration(content.silence)}", "yellow")
    else:
        head.append(phase_meaning(snapshot), "dim")
    return Group(*([Text(printable(content.heading), "bold")] if content.heading else []), head, Text())


def _coefficient_table(rows: list[EstimateRow], recent: RecentHistory, width: int) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    is_wide = width >= MIN_TREND_WIDTH
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, expand=False)
    table.add_column("coefficient", no_wrap=True)
    for title in ("value", "95 % from", "to"):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True, style="dim")
    table.add_column("error %", justify="right", no_wrap=True)
    if is_wide:
        table.add_column(f"last {duration(recent.seconds).removesuffix(' 00 s')}", no_wrap=True)
    trends = _trends(recent) if is_wide else []
    for k, row in enumerate(rows):
        cells = [row.name, row.value, row.lower, row.upper, row.unit, row.error_percent]
        cells += [trends[k]] if k < len(trends) else []
        table.add_row(*(Text(cell) for cell in cells), style="" if row.is_identified else "yellow")
    return table


def _trends(recent: RecentHistory) -> list[str]:
    values, errors = recent.value, recent.standard_error
    if values.size == 0:
        return []
    halves = NORMAL_95 * errors[-1]
    return [
        f"{sparkline(values[:, k], float(halves[k]))} {trend_arrow(errors[:, k])}".strip()
        for k in range(values.shape[1])
    ]


def _foot(snapshot: Snapshot, counts: SampleCounts) -> "Table":
    """Residuals, unidentified coefficients, advice, change, faults and findings, where there are any."""
    from rich.table import Table
    from rich.text import Text

    table = Table.grid(padding=(0, 2, 0, 0))
    table.add_column(no_wrap=True, style="dim")
    table.add_column()
    for label, words, style in _foot_lines(snapshot, counts):
        if words:
            table.add_row(Text(label), Text(words, style))
    return table


def _proposal_lines(snapshot: Snapshot) -> list[tuple[str, str]]:
    return [] if snapshot.proposal is None else proposal_lines(snapshot.proposal)


def _foot_lines(snapshot: Snapshot, counts: SampleCounts) -> list[tuple[str, str, str]]:
    """Label, text and style of each line below the table; the text is empty where there is nothing to say."""
    residuals = [f"{name} {rms} {unit}".rstrip() for name, rms, unit in residual_rms(snapshot)]
    more = len(snapshot.findings) - MAX_FINDINGS
    return [
        ("residuals", ", ".join(residuals), ""),
        ("not identified", enumeration([printable(name) for name in snapshot.unidentified], MAX_NAMES), "yellow"),
        ("would help" if snapshot.unidentified else "why not yet", printable(snapshot.advice), ""),
        *((label, text, "") for label, text in _proposal_lines(snapshot)),
        ("change", watch_sentence(snapshot), "bold red"),
        ("samples", faults_text(counts), "yellow"),
        ("last", printable(counts.last_problem), "dim"),
        *((f.severity.value, printable(f.text), "red" if f.severity is Severity.ERROR else "")
          for f in worst_first(snapshot.findings)[:MAX_FINDINGS]),
        ("", f"and {more} more findings" if more > 0 else "", "dim"),
    ]  # fmt: skip
