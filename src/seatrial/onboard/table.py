"""A snapshot as a table for a terminal."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from seatrial.core.results.online import Counts, Phase, Snapshot
from seatrial.core.values import Severity
from seatrial.onboard.history import Recent
from seatrial.onboard.shown import (
    NORMAL_95,
    Row,
    change,
    clean,
    counted,
    duration,
    listed,
    moment,
    noises,
    phase,
    rows,
    troubles,
)
from seatrial.onboard.trend import arrow, sparkline

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.table import Table

FINDINGS = 3
NARROW = 76
QUIET = 5.0
LEAST_ROWS, TAKEN = 3, 4
_SEVERITIES = list(Severity)[::-1]
_STYLES = {Phase.WAITING: "yellow", Phase.WINDOW: "green", Phase.RECURSIVE: "cyan"}


@dataclass(frozen=True, eq=False)
class Shown:
    """What a picture shows: the newest of everything; silence: s since something new came."""

    heading: str
    snapshot: Snapshot
    counts: Counts
    recent: Recent
    silence: float = 0.0


def picture(console: "Console", shown: Shown, height: int | None) -> "RenderableType":
    """Head, coefficients, what else there is to say; so many coefficients that all fits in `height` lines, if given."""
    from rich.console import Group
    from rich.text import Text

    head, foot, every = _head(shown), _foot(shown.snapshot, shown.counts), rows(shown.snapshot)
    most = len(every)
    if height is not None:
        free = height - TAKEN - sum(len(console.render_lines(part)) for part in (head, foot))
        most = most if most <= free else max(LEAST_ROWS, free - 1)
    more = [Text(f"and {len(every) - most} more", "dim")] if most < len(every) else []
    return Group(head, _coefficients(every[:most], shown.recent, console.width), *more, Text(), foot)


def _head(shown: Shown) -> "RenderableType":
    from rich.console import Group
    from rich.text import Text

    snapshot = shown.snapshot
    head = Text(no_wrap=True, overflow="ellipsis")
    head.append(snapshot.phase.value, f"bold {_STYLES[snapshot.phase]}")
    head.append(f"  {moment(snapshot.time)}  {counted(snapshot.samples, 'sample')}  {counted(snapshot.runs, 'run')}  ")
    if shown.silence > QUIET:
        head.append(f"no news for {duration(shown.silence)}", "yellow")
    else:
        head.append(phase(snapshot.phase), "dim")
    return Group(*([Text(clean(shown.heading), "bold")] if shown.heading else []), head, Text())


def _coefficients(some: list[Row], recent: Recent, width: int) -> "Table":
    from rich import box
    from rich.table import Table
    from rich.text import Text

    is_wide = width >= NARROW
    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, expand=False)
    made.add_column("coefficient", no_wrap=True)
    for title in ("value", "95 % from", "to"):
        made.add_column(title, justify="right", no_wrap=True)
    made.add_column("unit", no_wrap=True, style="dim")
    made.add_column("error %", justify="right", no_wrap=True)
    if is_wide:
        made.add_column(f"last {duration(recent.seconds).removesuffix(' 00 s')}", no_wrap=True)
    trends = _trends(recent) if is_wide else []
    for k, row in enumerate(some):
        cells = [row.name, row.value, row.lower, row.upper, row.unit, row.share]
        cells += [trends[k]] if k < len(trends) else []
        made.add_row(*(Text(cell) for cell in cells), style="" if row.is_told else "yellow")
    return made


def _trends(recent: Recent) -> list[str]:
    values, errors = recent.value, recent.standard_error
    if values.size == 0:
        return []
    halves = NORMAL_95 * errors[-1]
    return [
        f"{sparkline(values[:, k], float(halves[k]))} {arrow(errors[:, k])}".strip() for k in range(values.shape[1])
    ]


def _foot(snapshot: Snapshot, counts: Counts) -> "Table":
    """Noise, what is not told, what would help, change, trouble, findings; only what there is."""
    from rich.table import Table
    from rich.text import Text

    made = Table.grid(padding=(0, 2, 0, 0))
    made.add_column(no_wrap=True, style="dim")
    made.add_column()
    for what, words, style in _said(snapshot, counts):
        if words:
            made.add_row(Text(what), Text(words, style))
    return made


def _said(snapshot: Snapshot, counts: Counts) -> list[tuple[str, str, str]]:
    """(what, words, style) of each line below the table; empty words where there is nothing to say."""
    wrong = ", ".join(f"{count} {words}" for words, count in troubles(counts) if count)
    worst_first = sorted(snapshot.findings, key=lambda f: _SEVERITIES.index(f.severity))
    more = len(worst_first) - FINDINGS
    return [
        ("residuals", ", ".join(f"{name} {rms} {unit}".rstrip() for name, rms, unit in noises(snapshot)), ""),
        ("not told", listed([clean(name) for name in snapshot.untold]), "yellow"),
        ("would help" if snapshot.untold else "why not yet", clean(snapshot.advice), ""),
        ("change", change(snapshot.change), "bold red"),
        ("samples", wrong, "yellow"),
        ("last", clean(counts.last), "dim"),
        *((f.severity.value, clean(f.text), "red" if f.severity is Severity.ERROR else "")
          for f in worst_first[:FINDINGS]),
        ("", f"and {more} more findings" if more > 0 else "", "dim"),
    ]  # fmt: skip
