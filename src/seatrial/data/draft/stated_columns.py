"""Columns whose meaning is stated: the name of each, as the log has it, and what it is."""

from collections.abc import Iterable, Mapping

from seatrial.core.values import InputError, spelling_hint
from seatrial.data.draft.naming import guess_by_name

StatedColumns = Mapping[str, str]
"""Heading of a column -> ``time``, or a channel or name that a draft knows, such as ``psi`` or ``heading``."""
TIME = "time"
CHANNELS = "lat, lon, sog, cog, psi, r, u, v, delta, n, phi, theta, z, zeta, command_1"
"""Channels that logs hold most often."""
NOTHING_STATED: StatedColumns = {}


def stated_columns(texts: Iterable[str]) -> dict[str, str]:
    """Return what texts such as ``Klokke=time`` state, the heading before the last equals sign.

    Raises:
        InputError: a text without an equals sign, a heading stated twice, or a meaning that a draft does not know.
    """
    stated = dict[str, str]()
    for text in texts:
        heading, equals, meaning = (part.strip() for part in text.rpartition("="))
        if not equals or not heading or not meaning:
            raise InputError(f"--column '{text}': write HEADING=CHANNEL, as in --column 'Klokke=time'")
        if heading in stated:
            raise InputError(f"--column '{text}': the column '{heading}' is stated twice; state it once")
        if meaning != TIME and guess_by_name("", meaning, "") is None:
            raise InputError(
                f"--column '{text}': '{meaning}' is no channel that a log can hold; known are {TIME}, {CHANNELS}"
            )
        stated[heading] = meaning
    return stated


def refuse_absent(stated: StatedColumns, headings: Iterable[str]) -> None:
    """Refuse a stated column that no log has.

    Raises:
        InputError: there is one; the heading most like it is named.
    """
    known = list(dict.fromkeys(headings))
    for heading in stated:
        if heading not in known:
            raise InputError(f"--column '{heading}=...': no log has this column{spelling_hint(heading, known)}")
