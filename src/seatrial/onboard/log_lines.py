"""One snapshot as one line of plain text, for log files and for terminals that cannot draw."""

from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.core.text.plain import ascii_text
from seatrial.core.text.words import counted, enumeration, printable
from seatrial.onboard.snapshot_text import change_sentence as change_words
from seatrial.onboard.snapshot_text import estimate_rows, fault_counts, time_text

# coefficients named in a line at most
MAX_NAMES = 8


def log_line(snapshot: Snapshot, counts: SampleCounts) -> str:
    """Moment, phase, coefficients with half of their 95 % intervals, what is not identified, faults so far."""
    seen = f"{counted(snapshot.samples, 'sample')} {counted(snapshot.runs, 'run')}"
    parts = [f"{time_text(snapshot.time)} {snapshot.phase.value} {seen}"]
    parts += [
        ", ".join(f"{row.name} {row.value} +- {row.half_width} {row.unit}".rstrip() for row in estimate_rows(snapshot))
    ]
    names = [printable(name) for name in snapshot.unidentified]
    parts += [f"not identified: {enumeration(names, MAX_NAMES)}"] if names else []
    wrong = [f"{count} {words}" for words, count in fault_counts(counts) if count]
    parts += [", ".join(wrong)] if wrong else []
    parts += [change_words(snapshot.change)]
    return ascii_text(" | ".join(part for part in parts if part))
