"""Times in findings: seconds from the start of the run, with the logger's own clock in brackets where it differs."""

import re
from dataclasses import replace

from seatrial.core.values import Finding

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
