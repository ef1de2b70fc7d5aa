"""One snapshot as one line of plain text, for log files and for terminals that can draw nothing."""

from seatrial.core.results.online import Counts, Snapshot
from seatrial.onboard.digits import MINUS
from seatrial.onboard.shown import change as change_words
from seatrial.onboard.shown import clean, counted, listed, moment, rows, troubles

_ASCII = str.maketrans({MINUS: "-", "–": "-", "²": "^2", "³": "^3", "×": "x", "…": "...", "·": "?"})
_POWERS = dict(zip("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789", strict=True))


def line(snapshot: Snapshot, counts: Counts) -> str:
    """Moment, phase, coefficients with half of their 95 % intervals, what is not told, trouble so far."""
    seen = f"{counted(snapshot.samples, 'sample')} {counted(snapshot.runs, 'run')}"
    parts = [f"{moment(snapshot.time)} {snapshot.phase.value} {seen}"]
    parts += [", ".join(f"{row.name} {row.value} +- {row.half} {row.unit}".rstrip() for row in rows(snapshot))]
    parts += [f"not told: {listed([clean(name) for name in snapshot.untold])}"] if snapshot.untold else []
    wrong = [f"{count} {words}" for words, count in troubles(counts) if count]
    parts += [", ".join(wrong)] if wrong else []
    parts += [change_words(snapshot.change)]
    return plain(" | ".join(part for part in parts if part))


def plain(text: str) -> str:
    """The text without typographic signs: - for a minus, 10^5 for a power of ten."""
    shown = []
    for before, letter in zip(" " + text, text, strict=False):
        is_first = letter in _POWERS and before not in _POWERS
        shown.append(("^" if is_first else "") + _POWERS.get(letter, letter))
    return "".join(shown).translate(_ASCII)
