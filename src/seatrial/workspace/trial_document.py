"""The trial file as the only state: edits that keep its comments, each with a diff and an undo, written atomically."""

import difflib
import hashlib
import re
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import InlineTable

from seatrial.core.values import InputError
from seatrial.core.values.files import is_file, parse_toml, read_table_text, write_atomically
from seatrial.data.draft.draft_text import ASSUMED
from seatrial.data.trial.load import parse_tables
from seatrial.data.trial.plausibility import ESTIMATED

_DIGEST_LETTERS = 16  # of a version; chosen: 64 bits, no two texts of a file share one by chance
_CONTEXT = 2  # lines around a change in a diff; chosen
_ESTIMATE = re.compile(rf"\b({ESTIMATED}|{ASSUMED}): ")
_BRACES = re.compile(r"(= |^\s+)\{ ?(\w+ = [^{}]*?) *\}")
BY_HAND = "by hand"
"""Mark in the comment of a channel that a person has set, which a new draft keeps."""

Place = Sequence[str | int]
Edit = Callable[[str], str]


class EditConflictError(InputError):
    """The file is no longer the text that an edit was made for; `version` is what it is now."""

    def __init__(self, message: str, version: str) -> None:
        super().__init__(message)
        self.version = version


@dataclass(frozen=True)
class FileChange:
    """One change of the file: what it does, in a phrase, and both texts."""

    summary: str
    before: str
    after: str

    @property
    def diff(self) -> list[str]:
        """The lines of the change with a few around them, without the names of files."""
        lines = difflib.unified_diff(self.before.splitlines(), self.after.splitlines(), lineterm="", n=_CONTEXT)
        return list(lines)[2:]


def version_of(text: str) -> str:
    """Return the version of a text: equal texts have equal ones."""
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGEST_LETTERS]


class TrialDocument:
    """A trial file that several browsers and editors may change; what it holds is read from disk each time.

    Attributes:
        path: of the file, which need not exist yet.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lock = threading.Lock()
        self._history: list[FileChange] = []
        self._last = self._read()

    @property
    def text(self) -> str:
        """The text of the file; empty where there is none. A change by another program joins the history."""
        with self._lock:
            return self._current()

    @property
    def version(self) -> str:
        """The version of the text on disk."""
        return version_of(self.text)

    @property
    def history(self) -> tuple[FileChange, ...]:
        """The changes that can be undone, oldest first."""
        with self._lock:
            return tuple(self._history)

    def apply(self, edit: Edit, version: str, summary: str) -> FileChange:
        """Edit the file and return the change; nothing is written where the edit leaves the text as it is.

        Args:
            edit: the old text -> the new one.
            version: of the text that the person saw.

        Raises:
            EditConflictError: the file has changed since. InputError: the edit fails, or its text is no trial file.
        """
        with self._lock:
            before = self._current()
            self._require(version, before)
            after = edit(before)
            change = FileChange(summary, before, after)
            if after != before:
                require_readable(before, after, self.path)
                self._write(change)
            return change

    def undo(self, version: str) -> FileChange:
        """Take the last change back and return the change that does so.

        Raises:
            EditConflictError: the file has changed since. InputError: there is nothing to undo.
        """
        with self._lock:
            before = self._current()
            self._require(version, before)
            if not self._history:
                raise InputError("there is nothing to undo: the file is as it was when the workspace was opened")
            last = self._history.pop()
            change = FileChange(f"undo: {last.summary}", before, last.before)
            self._write(change, is_undo=True)
            return change

    def changes_since(self, version: str) -> FileChange | None:
        """Return what has changed since a version that the history knows; None where it does not."""
        with self._lock:
            now = self._current()
            texts = [text for change in self._history for text in (change.before, change.after)]
            then = next((text for text in texts if version_of(text) == version), None)
            return None if then is None else FileChange("", then, now)

    def _current(self) -> str:
        text = self._read()
        if text != self._last:
            self._history.append(FileChange("changed by another program", self._last, text))
            self._last = text
        return text

    def _read(self) -> str:
        try:
            return read_table_text(self.path) if is_file(self.path) else ""
        except (OSError, ValueError) as error:
            raise InputError(f"trial file '{self.path.name}' cannot be read ({error}); correct it") from None

    def _require(self, version: str, text: str) -> None:
        if version != version_of(text):
            raise EditConflictError(
                f"{self.path.name} has changed since this page showed it, in another window or program; nothing was "
                "written: look at the change, then do it again",
                version_of(text),
            )

    def _write(self, change: FileChange, *, is_undo: bool = False) -> None:
        write_atomically(self.path, change.after.encode())
        self._last = change.after
        if not is_undo:
            self._history.append(change)


def require_readable(before: str, after: str, path: Path) -> None:
    """Refuse a text that is no trial file where the text before was; one that was none may stay so, if it is TOML.

    Raises:
        InputError: what is wrong with the new text.
    """
    try:
        tables = parse_toml(after)
    except ValueError as error:
        raise InputError(f"{path.name} would be no valid TOML: {error}") from None
    try:
        parse_tables(tables, path)
    except InputError:
        if before and _is_trial(before, path):
            raise


def _is_trial(text: str, path: Path) -> bool:
    try:
        parse_tables(parse_toml(text), path)
    except (InputError, ValueError):
        return False
    return True


# Edits: functions from text to text, by tomlkit, so that comments and layout stay.


def with_value(text: str, place: Place, value: Any) -> str:
    """Return the text with one key set; None removes it. Tables on the way are made where they are missing.

    Args:
        place: keys and positions from 0, as ``("records", 0, "channels", "delta", "unit")``.

    Raises:
        InputError: no such table, or a place that is none.
    """
    document = parsed_document(text)
    try:
        table: Any = document
        for key in place[:-1]:
            table = _entered(table, key)
        last = place[-1]
        if value is None:
            if last in table:
                del table[last]
        else:
            _set(table, last, value)
        if "channels" in place[:-2] and isinstance(table, InlineTable):
            mark_by_hand(table)
        return toml_text(document, text)
    except (TOMLKitError, KeyError, IndexError, TypeError, AttributeError, ValueError) as error:
        key = ".".join(map(str, place))
        raise InputError(f"the trial file has no place '{key}' ({error}); reload the page") from None


def with_comment(text: str, place: Place, reason: str) -> str:
    """Return the text with the mark of a person's hand, and a reason, behind a channel."""
    document = parsed_document(text)
    channel: Any = document
    for key in place:
        channel = channel[key]
    set_comment(channel, f"{BY_HAND}; {reason}" if reason else BY_HAND)
    return toml_text(document, text)


def _set(table: Any, key: str | int, value: Any) -> None:
    """Set a value; the comment behind the old one stays, but an estimate is one no longer."""
    comment = table[key].trivia.comment if key in table and hasattr(table[key], "trivia") else ""
    table[key] = item_of(value)
    if comment:
        reason = _ESTIMATE.sub("", comment.lstrip("# "))
        set_comment(table[key], f"{BY_HAND}; in place of: {reason}" if _ESTIMATE.search(comment) else reason)


def item_of(value: Any) -> Any:
    """Return a value of JSON as TOML writes it; a table on one line."""
    if isinstance(value, dict):
        inline = tomlkit.inline_table()
        for key, inner in value.items():
            inline[key] = item_of(inner)
        return inline
    return tomlkit.item(value)


def set_comment(item: Any, comment: str) -> None:
    """Put a comment behind a value, at the distance that drafts have."""
    item.comment(comment)
    item.trivia.comment_ws = "    "


def mark_by_hand(channel: InlineTable) -> None:
    """Say at a channel that a person has set it."""
    reason = channel.trivia.comment.lstrip("# ")
    if not reason.startswith(BY_HAND):
        set_comment(channel, f"{BY_HAND}; {reason}" if reason else BY_HAND)


def _entered(table: Any, key: str | int) -> Any:
    if isinstance(key, str) and isinstance(table, dict) and key not in table:
        table[key] = tomlkit.table()
    return table[key]


def toml_text(document: tomlkit.TOMLDocument, before: str) -> str:
    """Return tables as text; changed lines have a space inside their braces, as those of drafts do."""
    kept = set(before.splitlines())
    lines = (line if line in kept else _BRACES.sub(r"\1{ \2 }", line) for line in tomlkit.dumps(document).split("\n"))
    return "\n".join(lines)


def parsed_document(text: str) -> tomlkit.TOMLDocument:
    """Return the tables of a text with their comments.

    Raises:
        InputError: no TOML.
    """
    try:
        return tomlkit.parse(text)
    except TOMLKitError as error:
        raise InputError(f"the trial file is no valid TOML ({error}); correct it in the view 'File'") from None
