"""A snapshot as a table for a terminal, with the recent course of each coefficient in a few characters."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.results.online import EstimatorPhase, SampleCounts, Snapshot
from seatrial.core.text.numbers import duration
from seatrial.core.text.words import counted, enumeration, printable
from seatrial.core.values import Array, Severity, worst_first
from seatrial.onboard import snapshot_text
from seatrial.onboard.history import RecentHistory
from seatrial.onboard.proposal_text import proposal_lines
from seatrial.onboard.snapshot_text import NORMAL_95, EstimateRow, estimate_rows

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.table import Table

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
    time = snapshot_text.time_text(snapshot.time)
    head.append(f"  {time}  {counted(snapshot.samples, 'sample')}  {counted(snapshot.runs, 'run')}  ")
    if content.silence > SILENCE_S:
        head.append(f"no samples for {duration(content.silence)}", "yellow")
    else:
        head.append(snapshot_text.phase_meaning(snapshot), "dim")
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
    residuals = [f"{name} {rms} {unit}".rstrip() for name, rms, unit in snapshot_text.residual_rms(snapshot)]
    more = len(snapshot.findings) - MAX_FINDINGS
    return [
        ("residuals", ", ".join(residuals), ""),
        ("not identified", enumeration([printable(name) for name in snapshot.unidentified], MAX_NAMES), "yellow"),
        ("would help" if snapshot.unidentified else "why not yet", printable(snapshot.advice), ""),
        *((label, text, "") for label, text in _proposal_lines(snapshot)),
        ("change", snapshot_text.change_sentence(snapshot.change), "bold red"),
        ("samples", snapshot_text.faults_text(counts), "yellow"),
        ("last", printable(counts.last_problem), "dim"),
        *((f.severity.value, printable(f.text), "red" if f.severity is Severity.ERROR else "")
          for f in worst_first(snapshot.findings)[:MAX_FINDINGS]),
        ("", f"and {more} more findings" if more > 0 else "", "dim"),
    ]  # fmt: skip
