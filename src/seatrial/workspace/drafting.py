"""A trial file drafted from the folder's logs, and again with what a person knows of the craft; corrections stay."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tomlkit.items import AoT, Table

from seatrial import api
from seatrial.core.values import InputError
from seatrial.data.draft.draft_text import ASSUMED
from seatrial.data.trial.plausibility import ESTIMATED
from seatrial.workspace.trial_document import BY_HAND, parsed_document, with_value

_SHIP_KEYS = {
    "length": "L", "beam": "B", "draught": "d", "mass": "m", "rho": "rho", "scale": "scale", "propeller": "D_P",
    "rudder": "A_R", "gm": "GM",
}  # fmt: skip
_GUESSES = (ESTIMATED, ASSUMED, "MISSING")  # marks of numbers that nobody has stated
_RECORDS = "\n[[records]]"
_WAVES = re.compile(r"^\[records\.waves\]\n(?:[^\[\n].*\n?)*", re.MULTILINE)
_OTHER_TABLE = re.compile(r"^\[\[?(?!records\b)", re.MULTILINE)
_TABLES = (("ship",), ("model", "fixed"), ("estimate",))


def drafted_text(
    text: str, folder: Path, logs: Sequence[Path], sizes: Mapping[str, float], columns: Sequence[str], name: str = ""
) -> str:
    """Return the trial file of logs; of a text with records ship, model and settings are drafted again, records stay.

    Args:
        text: of the file so far, empty: none. What a person has set there by hand is kept.
        sizes: by the options of `init`, in their units; columns: as `--column` of `init`.

    Raises:
        InputError: as `draft_trial`.
    """
    stated = [*columns, *_columns_by_hand(text)]
    options: dict[str, Any] = dict(sizes)
    name = name or str(parsed_document(text).get("ship", {}).get("name", ""))
    options |= {"folder": folder, "columns": tuple(dict.fromkeys(stated)), "name": name}
    try:
        draft = api.draft_trial(*logs, **options).text
    except InputError:
        readable = [path for path in logs if _is_log(path)]
        if not 0 < len(readable) < len(logs):
            raise
        draft = api.draft_trial(*readable, **options).text
    if _RECORDS not in text or _RECORDS not in draft:
        return draft
    drafted_head, own_records = draft[: draft.index(_RECORDS)], text[text.index(_RECORDS) :]
    own_records = _with_waves(own_records, draft[draft.index(_RECORDS) :])
    return _with_values_by_hand(drafted_head + own_records, text)


def _with_waves(records: str, drafted: str) -> str:
    """Return records with the tables of waves that a draft of the same blocks has and they lack."""
    blocks, drafted_blocks = records.split(_RECORDS), drafted.split(_RECORDS)
    if len(blocks) == len(drafted_blocks):
        for k, (block, other) in enumerate(zip(blocks, drafted_blocks, strict=True)):
            waves = _WAVES.search(other)
            if waves and not _WAVES.search(block):
                end = _OTHER_TABLE.search(block)
                place = end.start() if end else len(block)
                blocks[k] = f"{block[:place].rstrip()}\n\n{waves[0].strip()}\n{block[place:]}"
    return _RECORDS.join(blocks)


def stated_sizes(text: str) -> dict[str, float]:
    """Return the sizes of the craft that a trial file states, by the options of `init`, but for those of a rule."""
    ship: Mapping[str, Any] = parsed_document(text).get("ship", {})
    numbers = {size: ship[key] for size, key in _SHIP_KEYS.items() if isinstance(ship.get(key), int | float)}
    comments = {size: value.trivia.comment.lstrip("# ") for size, value in numbers.items() if hasattr(value, "trivia")}
    return {size: float(value) for size, value in numbers.items() if not comments[size].startswith(_GUESSES)}


def _is_log(path: Path) -> bool:
    """Whether a file of the folder can be read as a log: a note beside it may have the same ending."""
    try:
        api.survey_log(path)
    except InputError:
        return False
    return True


def _columns_by_hand(text: str) -> list[str]:
    """What the channels that a person has set say of columns that no name explains."""
    document: Mapping[str, Any] = parsed_document(text)
    return [
        f"{channel['column']}={symbol}"
        for block in document.get("records", ())
        for source in (block, *block.get("sources", ()))
        for symbol, channel in source.get("channels", {}).items()
        if _is_by_hand(channel) and isinstance(channel.get("column"), str)
    ]


def _with_values_by_hand(text: str, before: str) -> str:
    """The text with what a person has set in the one before: marked values, and what stands above all tables."""
    document: Mapping[str, Any] = parsed_document(before)
    for key, value in document.items():
        if not isinstance(value, Table | AoT):
            text = with_value(text, (key,), value.unwrap())
    for place in (*_TABLES, *(("thruster", k) for k in range(len(document.get("thruster", ()))))):
        table: Any = document
        for key in place:
            table = table[key] if isinstance(key, int) else table.get(key, {})
        for key, value in table.items():
            if _is_by_hand(value):
                text = with_value(text, (*place, key), value.unwrap())
    return text


def _is_by_hand(value: Any) -> bool:
    trivia = getattr(value, "trivia", None)
    return trivia is not None and trivia.comment.lstrip("# ").startswith(BY_HAND)
