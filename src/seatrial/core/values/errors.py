"""Errors that a user can meet, and reports of progress."""

from collections.abc import Callable, Sequence

# Errors that a user can meet: bad input, in one sentence.

_GAP = " … "
_LONGEST_MESSAGE = 600  # letters: chosen, eight lines of a terminal; those of the package itself have 400 at most


class InputError(ValueError):
    """States what is wrong, where, and what to do; the command line prints it and exits with code 2.

    A message that quotes a long text of a file is cut in its middle, and what would steer a terminal is escaped.
    """

    def __init__(self, message: object = "") -> None:
        text = "".join(c if c.isprintable() or c == "\n" else repr(c)[1:-1] for c in str(message))
        part = _LONGEST_MESSAGE // 2 - len(_GAP)
        super().__init__(text if len(text) <= _LONGEST_MESSAGE else text[:part] + _GAP + text[-part:])


class DivergedError(InputError):
    """States where and when a simulation left all bounds."""


MAX_LISTED = 160
"""Letters of a list of names in a message; ours, a third of the longest message."""


def listed(names: Sequence[str]) -> str:
    """Return names with commas between them; of many the first, and how many more there are."""
    texts = list[str]()
    for name in names:
        if sum(map(len, texts)) + 2 * len(texts) + len(name) > MAX_LISTED and texts:
            return f"{', '.join(texts)} and {len(names) - len(texts)} more"
        texts.append(name)
    return ", ".join(texts)


def spelling_hint(name: str, valid_names: list[str]) -> str:
    """Return the end of a sentence that names the valid name most like `name`, or all of them where none is alike."""
    import difflib

    close = difflib.get_close_matches(name, valid_names, n=1, cutoff=0.5)
    return f"; did you mean '{close[0]}'?" if close else f"; known are {listed(valid_names)}"


# The callback by which a long computation reports its progress.

ProgressReporter = Callable[[str], None]
"""Takes one line: the phase, and after a colon how far it is, ``prediction: 3 of 12, zigzag_20``."""
