"""Words for counts and lists, sentences from fragments, text that is safe to show."""

import re
import unicodedata
from collections.abc import Sequence

# characters of a text from elsewhere that are shown at most
MAX_TEXT_LENGTH = 300
NAMES_SHOWN = 12
"""Names of a list that a one-line description gives before it counts the rest, so that it stays a line or two."""


def ordinal(number: int) -> str:
    """Return 1st, 2nd, 3rd, 4th, … 11th, 21st."""
    # English: the teens end in th
    ending = "th" if number % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


def enumeration(items: Sequence[str], max_items: int = 6) -> str:  # items that a sentence holds, chosen
    """Return a, b and c; beyond `max_items`: a, b, c and 5 more."""
    if len(items) > max_items:
        return f"{', '.join(items[: max_items - 1])} and {len(items) - max_items + 1} more"
    return " and ".join([", ".join(items[:-1]), items[-1]]) if len(items) > 1 else "".join(items)


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: 1 run, 2 runs, no runs."""
    return f"{number or 'no'} {noun}{'' if number == 1 else 's'}"


def sentence(text: str, names: Sequence[str] = ()) -> str:
    """Return the text with a capital and a full stop; one that begins with one of the `names` keeps its letter."""
    first = re.split(r"[\s,;:]", text, maxsplit=1)[0]
    is_word = first.isalpha() and len(first) > 1 and first not in names
    capitalised = text[:1].upper() + text[1:] if is_word or first in ("a", "A") else text
    return capitalised if not capitalised or capitalised.endswith((".", "!", "?")) else f"{capitalised}."


def common_prefix(names: Sequence[str]) -> str:
    """Return the beginning that all names share, up to a separator; empty where it is short."""
    if len(names) < 2:
        return ""
    low, high = min(names), max(names)
    same = next((i for i, (a, b) in enumerate(zip(low, high, strict=False)) if a != b), min(len(low), len(high)))
    cut = max(low[:same].rfind(c) for c in "_- /") + 1
    return low[:cut] if cut >= 5 else ""  # fewer than five letters are not worth a note


def printable(text: str, longest: int = MAX_TEXT_LENGTH) -> str:
    """Return text without control characters (a sentence from a socket may contain some), cut where it is long."""
    letters = "".join("·" if unicodedata.category(c).startswith("C") else c for c in text[: longest + 1])
    return letters if len(letters) <= longest else letters[: longest - 1] + "…"
