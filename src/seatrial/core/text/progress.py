"""Reports of progress as people read them: the phase, and how far it is."""

import re
from dataclasses import dataclass

_COUNT = re.compile(r"\b(\d+) of (\d+)\b")


@dataclass(frozen=True)
class ProgressReport:
    """One report: the phase, what it says of itself, and how many of how many parts are done (0 of 0: not counted)."""

    phase: str
    detail: str
    done: int
    total: int


def read_report(text: str) -> ProgressReport:
    """Return the parts of a line that was reported."""
    phase, _, detail = text.partition(": ")
    count = _COUNT.search(detail)
    return ProgressReport(phase, detail, int(count[1]) if count else 0, int(count[2]) if count else 0)
