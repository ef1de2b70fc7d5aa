"""Text for terminals and log files: no typographic signs, columns that line up."""

import re
import textwrap
from collections.abc import Sequence

from seatrial.core.text.numbers import MINUS, SUPERSCRIPTS, THIN_SPACE

_RAISED = {raised: sign for sign, raised in SUPERSCRIPTS.items()}
_PLAIN = str.maketrans({MINUS: "-", THIN_SPACE: "", "–": "-", "×": "x", "…": "...", "·": "?", "°": " deg", "∞": "inf",
    "‘": "'", "’": "'", "“": '"', "”": '"', "→": "->", "≤": "<=", "≥": ">=", "χ": "chi",
})  # fmt: skip
# what steers a terminal or cannot be encoded: control characters but tab and line feed, directions of writing, halves
# of characters (Unicode 15, categories Cc, Cf, Cs)
_UNSAFE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
_POWER = re.compile(f"{THIN_SPACE}×{THIN_SPACE}10([{''.join(_RAISED)}]+)")
_INDEX = re.compile(f"[{''.join(_RAISED)}]+")
# spaces between columns; letters below which a column of words is not read with ease; both chosen
GAP, MIN_WORDS = 2, 16


def safe_text(text: str) -> str:
    """Return the text with a question mark for what would steer a terminal or cannot be written to one."""
    return _UNSAFE.sub("?", text)


def ascii_text(text: str) -> str:
    """Return the text without typographic signs: ``-`` for a minus, ``1.2e-5``, ``kg m^2``; safe as by `safe_text`."""

    def digits(raised: str) -> str:
        return "".join(_RAISED[letter] for letter in raised)

    plain = _POWER.sub(lambda match: f"e{digits(match[1])}", safe_text(text))
    return _INDEX.sub(lambda match: f"^{digits(match[0])}", plain).translate(_PLAIN)


def aligned(rows: Sequence[Sequence[str]], flush_left: Sequence[int] = (0,), width: int | None = None) -> list[str]:
    """Return rows of equal length as lines whose columns line up.

    Args:
        flush_left: columns that are flush left, the others are flush right.
        width: letters of a line; where the columns need more, the widest column of words goes on over further lines;
            if that is not enough, names of columns (the first row) do, too; else the columns stand in several tables
            below one another. None: lines as long as they are.
    """
    if not rows:
        return []
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    if width is None or _excess(widths, width) <= 0:
        return [_line(row, widths, flush_left) for row in rows]
    widest = max(flush_left, key=lambda k: widths[k], default=0)
    if not _can_be_narrowed(widths, flush_left, widest, width):
        rows, widths = _with_wrapped_names(rows, widths, width)
    if _can_be_narrowed(widths, flush_left, widest, width):
        widths[widest] -= max(0, _excess(widths, width))
        return _with_wrapped_words(rows, widths, flush_left, widest)
    if _excess(widths, width) <= 0:
        return [_line(row, widths, flush_left) for row in rows]
    return _split_tables(rows, widths, flush_left, width)


def wrapped(text: str, width: int | None, indent: str = "") -> list[str]:
    """Return a sentence as lines of at most `width` letters (None: one line), later ones further in."""
    if width is None:
        return [indent + text]
    own_indent = indent + text[: len(text) - len(text.lstrip())]
    lines = textwrap.wrap(
        text.strip(), max(width, MIN_WORDS), initial_indent=own_indent, subsequent_indent=f"{own_indent}{' ' * GAP}",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip
    return lines or [""]


def _line(row: Sequence[str], widths: Sequence[int], flush_left: Sequence[int]) -> str:
    cells = zip(row, widths, strict=True)
    return (
        (" " * GAP)
        .join(f"{cell:<{width}}" if k in flush_left else f"{cell:>{width}}" for k, (cell, width) in enumerate(cells))
        .rstrip()
    )


def _can_be_narrowed(widths: Sequence[int], flush_left: Sequence[int], column: int, width: int) -> bool:
    """Whether columns fit into a line where one of words is narrowed."""
    return column in flush_left and widths[column] - _excess(widths, width) >= MIN_WORDS


def _excess(widths: Sequence[int], width: int) -> int:
    """Letters by which columns are wider than a line."""
    return sum(widths) + GAP * (len(widths) - 1) - width


def _with_wrapped_names(
    rows: Sequence[Sequence[str]], widths: Sequence[int], width: int
) -> tuple[Sequence[Sequence[str]], list[int]]:
    """The rows, their first one over several lines where that saves letters, and the widths of the columns."""
    head, *body = rows
    if not body:
        return rows, list(widths)
    least = [max([*(len(row[k]) for row in body), *map(len, name.split())])
             for k, name in enumerate(head)]  # fmt: skip
    narrow = list(widths)
    for k in sorted(range(len(widths)), key=lambda k: least[k] - widths[k]):
        narrow[k] = max(least[k], widths[k] - max(0, _excess(narrow, width)))
    parts = [textwrap.wrap(name, max(room, 1), break_long_words=False) for name, room in zip(head, narrow, strict=True)]
    height = max(map(len, parts), default=0)
    lines = [[""] * (height - len(part)) + part for part in parts]
    return [*map(list, zip(*lines, strict=True)), *body], narrow


def _with_wrapped_words(
    rows: Sequence[Sequence[str]], widths: Sequence[int], flush_left: Sequence[int], column: int
) -> list[str]:
    """One column within its width, over several lines where it must; the numbers stand in the first of them."""
    lines = []
    for row in rows:
        for k, part in enumerate(wrapped(row[column], widths[column])):
            cells = [part if i == column else cell if k == 0 else "" for i, cell in enumerate(row)]
            lines.append(_line(cells, widths, flush_left))
    return lines


def _split_tables(rows: Sequence[Sequence[str]], widths: list[int], flush_left: Sequence[int], width: int) -> list[str]:
    """The first column with as many others as fit, then with the next ones, until all have been shown."""
    lines, column = [], 1
    while column < len(widths):
        chosen, used = [0], widths[0]
        while column < len(widths) and (len(chosen) == 1 or used + GAP + widths[column] <= width):
            used += GAP + widths[column]
            chosen.append(column)
            column += 1
        flush = [i for i, k in enumerate(chosen) if k in flush_left]
        lines += [_line([row[k] for k in chosen], [widths[k] for k in chosen], flush) for row in rows]
    return lines or [row[0] for row in rows]
