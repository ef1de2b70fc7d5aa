"""Text for terminals and log files: no typographic signs, columns that line up."""

import re
from collections.abc import Sequence

from seatrial.core.text.numbers import MINUS, SUPERSCRIPTS, THIN_SPACE

_RAISED = {raised: sign for sign, raised in SUPERSCRIPTS.items()}
_PLAIN = str.maketrans({MINUS: "-", THIN_SPACE: "", "–": "-", "×": "x", "…": "...", "·": "?", "°": " deg", "∞": "inf"})
_POWER = re.compile(f"{THIN_SPACE}×{THIN_SPACE}10([{''.join(_RAISED)}]+)")
_INDEX = re.compile(f"[{''.join(_RAISED)}]+")


def ascii_text(text: str) -> str:
    """Return the text without typographic signs: ``-`` for a minus, ``1.2e-5``, ``kg m^2``."""

    def digits(raised: str) -> str:
        return "".join(_RAISED[letter] for letter in raised)

    plain = _POWER.sub(lambda match: f"e{digits(match[1])}", text)
    return _INDEX.sub(lambda match: f"^{digits(match[0])}", plain).translate(_PLAIN)


def aligned(rows: Sequence[Sequence[str]], flush_left: Sequence[int] = (0,)) -> list[str]:
    """Return rows of equal length as lines whose columns line up.

    Args:
        flush_left: columns that are flush left, the others are flush right.
    """
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))] if rows else []
    return [
        "  ".join(f"{cell:<{width}}" if k in flush_left else f"{cell:>{width}}"
                  for k, (cell, width) in enumerate(zip(row, widths, strict=True))).rstrip()
        for row in rows
    ]  # fmt: skip
