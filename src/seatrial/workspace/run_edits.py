"""Edits of runs: cut out of logs, named, held out or left out; text in, text out, comments kept."""

from collections.abc import Mapping, Sequence
from typing import Any

import tomlkit
from tomlkit.items import Array

from seatrial.core.values import InputError
from seatrial.data.trial import Role, Run
from seatrial.data.trial.run_data import seconds_in
from seatrial.workspace.trial_document import item_of, parsed_document, set_comment, toml_text

SHORTEST_S = 1.0
"""s of a piece below which a cut leaves nothing of it; chosen: no manoeuvre is as short."""
_DIGITS = 6  # of the ends of a part, as drafts have them
_CUT = "cut by hand"
_KEYS = {Role.VALIDATE: "validate", Role.LEAVE_OUT: "leave_out", Role.TRAIN: "train"}


def with_part(text: str, block: int, file: str, ends: tuple[float, float], name: str, duration: float) -> str:
    """Return the text with a stretch of a log as a run of its own; what other runs had of it is theirs no longer.

    Of a log that was one run what lies before and after becomes runs as well.

    Args:
        block: place of its [[records]], from 0; file: the log, named without its ending.
        ends: s after the first sample; name: of the run; duration: of the log [s].

    Raises:
        InputError: ends out of order, a name that another part has, or parts that are cut out of every file alike.
    """
    start, stop = max(0.0, min(ends)), min(duration, max(ends))
    if not stop - start >= SHORTEST_S:
        raise InputError(f"a run from {start:.4g} to {stop:.4g} s is shorter than {SHORTEST_S:g} s; drag over more")
    if not name.strip():
        raise InputError("the run needs a name; give one, such as zigzag_2")
    document = parsed_document(text)
    table = _block(document, block)
    parts = _parts(table)
    if len(_files(table)) > 1 and any(not part.get("file") for part in parts):
        raise InputError("its parts are cut out of every file alike; name the file of each in the view 'File'")
    mine = [part for part in parts if part.get("file", file) == file]
    pieces = mine or [_new_part(table, file, file, 0.0, duration)]
    if any(part["name"] == name for part in parts if part not in mine or not _is_inside(part, start, stop, duration)):
        raise InputError(f"another run is called '{name}'; give another name")
    for piece in pieces:
        _cut(table, piece, (start, stop), duration, is_new=not mine)
    _append(table, _new_part(table, file, name, start, stop))
    return toml_text(document, text)


def without_part(text: str, block: int, name: str) -> str:
    """Return the text without a part; what it held is not used.

    Raises:
        InputError: there is no such part, or it is the last one, without which the whole log would be a run again.
    """
    document = parsed_document(text)
    table = _block(document, block)
    parts = _parts(table)
    place = next((k for k, part in enumerate(parts) if part["name"] == name), None)
    if place is None:
        raise InputError(f"'{name}' is a whole log, no part of one; leave it out instead")
    if len(parts) == 1:
        raise InputError(f"'{name}' is the only part of its log, which would be one run again; undo the cut instead")
    del table["parts"][place]
    _forget_role(table, name)
    return toml_text(document, text)


def with_run_name(text: str, block: int, name: str, new_name: str, names: Sequence[str]) -> str:
    """Return the text with a run renamed; a whole log becomes a part that has the new name.

    names: of all runs.

    Raises:
        InputError: another run has the name, or the block cuts every file alike.
    """
    new_name = new_name.strip()
    if not new_name or new_name in names:
        raise InputError(f"a run is called '{new_name}' already; give another name" if new_name else "give a name")
    document = parsed_document(text)
    table = _block(document, block)
    part = next((part for part in _parts(table) if part["name"] == name), None)
    if part is None:
        if table.get("sources") or _parts(table):
            raise InputError(f"'{name}' is named by its block; change the name in the view 'File'")
        _append(table, _new_part(table, name, new_name, 0.0, 0.0))
    else:
        part["name"] = new_name
    for key in _KEYS.values():
        patterns = _patterns(table, key)
        if name in patterns:
            _set_patterns(table, key, [new_name if pattern == name else pattern for pattern in patterns])
    return toml_text(document, text)


def with_role(text: str, block: int, runs: Sequence[Run], name: str, role: Role) -> str:
    """Return the text in which a run of a block has another role; patterns that name several become their names.

    runs: of the block, with the roles that they have now.
    """
    document = parsed_document(text)
    table = _block(document, block)
    roles = {run.name: role if run.name == name else run.role for run in runs}
    default = Role.LEAVE_OUT if _patterns(table, _KEYS[Role.TRAIN]) else Role.TRAIN
    for kind, key in _KEYS.items():
        members = [run for run, its in roles.items() if its is kind]
        _set_patterns(table, key, members if kind is not default else [])
    return toml_text(document, text)


def part_of(table: Mapping[str, Any], name: str, duration: float) -> tuple[float, float] | None:
    """Return the ends [s] of a run of a block of parsed tables; None where an end is an event of the log."""
    part = next((part for part in table.get("parts", ()) if part["name"] == name), None)
    if part is None:
        return 0.0, duration
    ends = _seconds(part.get("from", ""), 0.0), _seconds(part.get("to", ""), duration)
    return None if None in ends else (ends[0] or 0.0, ends[1] or duration)


def _block(document: tomlkit.TOMLDocument, place: int) -> Any:
    records: Any = document.get("records", [])
    if not 0 <= place < len(records):
        raise InputError(f"there is no [[records]] number {place + 1} in the trial file; reload the page")
    return records[place]


def _parts(table: Any) -> list[Any]:
    return list(table.get("parts", ()))


def _files(table: Any) -> list[str]:
    files = table.get("files", [])
    return [files] if isinstance(files, str) else list(files)


def _new_part(table: Any, file: str, name: str, start: float, stop: float) -> dict[str, Any]:
    """A part; a block of several files says of which one; ends of zero length are those of the log."""
    is_several = len(_files(table)) > 1 or any(letter in _files(table)[0] for letter in "*?[") if _files(table) else 0
    part: dict[str, Any] = {"file": file} if is_several else {}
    part["name"] = name
    return part | ({"from": _text(start), "to": _text(stop)} if stop > start else {})


def _append(table: Any, part: Mapping[str, Any]) -> None:
    if "parts" not in table:
        table.add("parts", tomlkit.array().multiline(True))
        table["parts"].append(item_of(part))
        set_comment(table["parts"], _CUT)
    elif isinstance(table["parts"], Array):
        table["parts"].add_line(item_of(part), comment=_CUT)
    else:
        table["parts"].append(tomlkit.item(part))


def _cut(table: Any, piece: Any, ends: tuple[float, float], duration: float, *, is_new: bool) -> None:
    """Leave of a piece what lies before and after a stretch; an end that is an event stays as it is."""
    first, last = _seconds(piece.get("from", ""), 0.0), _seconds(piece.get("to", ""), duration)
    if first is None or last is None:
        return
    start, stop = ends
    before, after = (first, min(start, last)), (max(stop, first), last)
    kept = [(a, b) for a, b in (before, after) if b - a >= SHORTEST_S]
    if not is_new and kept == [(first, last)]:
        return
    if not is_new and not kept:
        _remove(table, piece)
        return
    for k, (a, b) in enumerate(kept):
        if k == 0 and not is_new:
            piece["from"], piece["to"] = _text(a), _text(b)
        else:
            number = sum(part["name"].startswith(f"{piece['name']}_") for part in _parts(table)) + 1
            _append(table, {**_as_dict(piece), "name": f"{piece['name']}_{number}", "from": _text(a), "to": _text(b)})


def _as_dict(piece: Any) -> dict[str, Any]:
    return {key: str(value) for key, value in piece.items()}


def _remove(table: Any, piece: Any) -> None:
    del table["parts"][next(k for k, part in enumerate(table["parts"]) if part is piece or part == piece)]
    _forget_role(table, piece["name"])


def _is_inside(part: Any, start: float, stop: float, duration: float) -> bool:
    first, last = _seconds(part.get("from", ""), 0.0), _seconds(part.get("to", ""), duration)
    return first is not None and last is not None and start <= first and last <= stop


def _forget_role(table: Any, name: str) -> None:
    for key in _KEYS.values():
        patterns = _patterns(table, key)
        if name in patterns:
            _set_patterns(table, key, [pattern for pattern in patterns if pattern != name])


def _patterns(table: Any, key: str) -> list[str]:
    value = table.get(key, [])
    return [str(value)] if isinstance(value, str) else [str(pattern) for pattern in value]


def _set_patterns(table: Any, key: str, names: Sequence[str]) -> None:
    """Write the names of a role, the comment behind the old ones kept only where they stay as they are."""
    if names == _patterns(table, key):
        return
    if not names:
        del table[key]
    elif key in table:
        table[key] = list(names)
    else:
        item: Any = tomlkit.item(list(names))
        place = next((k for k in ("files", "name") if k in table), None)
        _insert_after(table, place, key, item)


def _insert_after(table: Any, place: str | None, key: str, item: Any) -> None:
    """Put a key behind another, as keys at the end of a block would stand behind its comments."""
    if place is None or not hasattr(table, "value") or not hasattr(table.value, "_insert_after"):
        table.add(key, item)
    else:
        table.value._insert_after(place, key, item)


def _text(seconds: float) -> str:
    return f"{float(f'{seconds:.{_DIGITS}g}'):g} s"


def _seconds(text: str, default: float) -> float | None:
    """The time that an end of a part means; None: it is an event."""
    return seconds_in(str(text)) if text else default
