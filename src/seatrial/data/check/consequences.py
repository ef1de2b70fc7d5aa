"""What findings of a run say in their final form: times from its start, exact edits, most harmful first."""

import re
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from seatrial.core.values import Finding, Record, TrialEdit, worst_first
from seatrial.core.values.notation import OPPOSITE

# Times in findings: seconds from the start of the run, with the logger's own clock in brackets where it differs.

_MOMENT = re.compile(r"\bt = (-?[\d.e+-]+)(?: to (-?[\d.e+-]+))? s\b")
_DIGITS, _DECIMALS = 12, 3  # of a stamp on its way into the text; of a time in it: a logger's clock is no finer


def moment(*times: float) -> str:
    """Return a time, or the ends of a stretch, of the logger's clock [s] as `on_run_clock` looks for them."""
    return f"t = {' to '.join(f'{float(time):.{_DIGITS}g}' for time in times)} s"


def on_run_clock(finding: Finding, start: float) -> Finding:
    """Return a finding whose times count from `start` [s on the logger's clock], the first stamp of the run."""

    def counted_from_start(match: re.Match[str]) -> str:
        stamps = [float(group) for group in match.groups() if group is not None]
        text = f"t = {_seconds([stamp - start for stamp in stamps])} s"
        return text if start == 0.0 else f"{text} [clock {_seconds(stamps)} s]"

    texts = (_MOMENT.sub(counted_from_start, text) for text in (finding.message, finding.evidence))
    return replace(finding, **dict(zip(("message", "evidence"), texts, strict=True)))


def _seconds(times: list[float]) -> str:
    return " to ".join(f"{round(time, _DECIMALS) + 0.0:.{_DIGITS}g}" for time in times)


# Edits of findings in their final form.

REVERSED = '"reversed"'
"""Value of an edit of ``positive`` that stands for the opposite of what is declared."""


def completed(findings: Iterable[Finding], record: Record) -> list[Finding]:
    """Return findings with exact edits and times from the start of the run, most harmful first.

    record: as it was read, with the declared directions that edits of ``positive`` reverse.
    """
    start = float(np.nanmin(record.time))
    return worst_first(on_run_clock(_with_edits(finding, record), start) for finding in findings)


def _with_edits(finding: Finding, record: Record) -> Finding:
    if not finding.edits:
        return finding
    edits = tuple(_resolved(edit, record) for edit in finding.edits)
    advice = f"set {'; '.join(map(str, edits))}" if not edits[0].exchanged_with else "; ".join(map(str, edits))
    return replace(finding, edits=edits, advice=f"{advice} in the trial file")


def _resolved(edit: TrialEdit, record: Record) -> TrialEdit:
    """The edit with the opposite of the declared direction; numbers in the sense in which the file counts."""
    symbol = edit.key.split(".")[1]
    if edit.value == REVERSED:
        return replace(edit, value=f'"{OPPOSITE[record.channel(symbol).positive]}"')
    return edit
