"""The store of a campaign: what it belongs to, and its journals; done is the union of what these hold."""

import json
import mmap
import os
import secrets
import socket
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from io import FileIO
from pathlib import Path
from typing import Any

from seatrial.campaigns.work import Outcome, Task, Work, packed, unpacked
from seatrial.core.results.campaign import CampaignStatus
from seatrial.core.values import InputError
from seatrial.core.values.files import FrameWriter, whole_frames, write_atomically
from seatrial.numerics.platform import flush_folder_to_disk

# Journals of outcomes: appended by one process each, readable at any moment, whatever becomes of the writer.

SUFFIX = ".journal"
_HEADER = b"seatrial campaign journal 1\n"
_HEADER_PREFIX = b"seatrial campaign journal "
_HEAD = struct.Struct("<cI32sd")
_DONE, _FAILED = b"D", b"F"
_NAME_BYTES = 4  # of the random part of a journal's name: chosen, no two alike on one machine and process number


class OutcomeJournal:
    """A new journal, to which one process appends."""

    def __init__(self, folder: Path, flush_s: float) -> None:
        """Create the file; flush_s: s between two flushes to the disk.

        Raises:
            InputError: it cannot be written.
        """
        name = f"{socket.gethostname()}-{os.getpid()}-{secrets.token_hex(_NAME_BYTES)}{SUFFIX}"
        self.path = folder / name
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file: FileIO = self.path.open("xb", buffering=0)
            self._file.write(_HEADER)
            flush_folder_to_disk(folder)
        except OSError as error:
            raise self._sentence(error) from None
        self._writer = FrameWriter(self._file, flush_s)

    def append(self, outcome: Outcome) -> None:
        """Append an outcome; it survives this process from now on.

        Raises:
            InputError: the disk is full or has failed.
        """
        tag = _FAILED if outcome.is_failure else _DONE
        self._writer.append(_HEAD.pack(tag, len(outcome.body), outcome.identity, outcome.seconds) + outcome.body)
        try:
            self._writer.write_pending()
        except OSError as error:
            raise self._sentence(error) from None

    def close(self) -> None:
        """Write through to the disk and close; one without an outcome is removed.

        Raises:
            InputError: the disk is full or has failed.
        """
        try:
            self._writer.flush()
            is_empty = self._file.tell() == len(_HEADER)
            self._file.close()
            if is_empty:
                self.path.unlink(missing_ok=True)
        except OSError as error:
            raise self._sentence(error) from None

    def _sentence(self, error: OSError) -> InputError:
        return InputError(
            f"journal '{self.path}' cannot be written ({error.strerror}); what was finished before is kept: make room "
            "there and run the same command again"
        )


@dataclass(frozen=True)
class JournalEntry:
    """An outcome in a journal: where its body stands, so that it can be read when it is needed."""

    path: Path
    is_failure: bool
    identity: bytes
    seconds: float
    start: int
    stop: int


def read_journal(path: Path) -> tuple[tuple[JournalEntry, ...], int]:
    """Return the whole entries of a journal, and in how many places something between or behind them is damaged.

    A torn end is that of a process that was killed, or is writing now.

    Raises:
        InputError: it cannot be read, is no journal of a campaign, or one of a newer version.
    """
    try:
        with path.open("rb") as file:
            header = file.read(len(_HEADER))
            if len(header) < len(_HEADER) and _HEADER.startswith(header):  # its writer was killed at once
                return (), 0
            _check_header(header, path)
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
                return _parsed(content, path)
    except OSError as error:
        raise InputError(f"journal '{path}' cannot be read ({error.strerror}); check its permissions") from None


def body_of(entry: JournalEntry) -> bytes:
    """Return the body of an entry."""
    with entry.path.open("rb") as file:
        file.seek(entry.start)
        return file.read(entry.stop - entry.start)


def _check_header(header: bytes, path: Path) -> None:
    if header == _HEADER:
        return
    if header.startswith(_HEADER_PREFIX):
        raise InputError(f"journal '{path}' is of a newer version of seatrial; update this one")
    raise InputError(f"'{path}' is no journal of a campaign; remove it from the store")


def _parsed(content: mmap.mmap, path: Path) -> tuple[tuple[JournalEntry, ...], int]:
    entries, damaged, end = list[JournalEntry](), 0, len(_HEADER)
    for frame in whole_frames(content, end, _payload_size):
        tag, length, identity, seconds = _HEAD.unpack_from(content, frame.start)
        body = frame.start + _HEAD.size
        entries.append(JournalEntry(path, tag == _FAILED, identity, seconds, body, body + length))
        damaged += frame.start > end
        end = frame.stop
    return tuple(entries), damaged


def _payload_size(content: bytes | mmap.mmap, offset: int) -> int:
    """Return the bytes of the payload that begins at `offset`; 0 where none can begin."""
    if content[offset : offset + 1] not in (_DONE, _FAILED) or offset + _HEAD.size > len(content):
        return 0
    return _HEAD.size + int.from_bytes(content[offset + 1 : offset + 5], "little")


# The store of a campaign: what it belongs to, and the journals; done is the union of what these hold.

FORMAT = 1
_FILE, _JOURNALS = "campaign.json", "journals"


@dataclass(frozen=True, eq=False)
class StoredTasks:
    """The outcomes of a store: identity -> entry of what is done, and of what has only failed."""

    done: Mapping[bytes, JournalEntry]
    failed: Mapping[bytes, JournalEntry]
    damaged_places: int

    def is_finished(self, task: Task, *, retry: bool = False) -> bool:
        """Return whether a task needs no more work; with `retry` a failed one does."""
        return task.identity in self.done or (not retry and task.identity in self.failed)


@dataclass(frozen=True)
class Store:
    """A folder with a campaign, and what its file says."""

    folder: Path
    table: Mapping[str, Any]

    @cached_property
    def identities(self) -> list[bytes]:
        """Identities of the plan's tasks, in order."""
        return unpacked(self.table["identities"])

    def new_journal(self, flush_s: float) -> OutcomeJournal:
        """Return a journal for this process; errors as those of the journal."""
        return OutcomeJournal(self.folder / _JOURNALS, flush_s)

    def outcomes(self) -> StoredTasks:
        """Read all journals.

        Where a task was done twice, by two processes that did not know of each other, the outcome is the one whose
        bytes come first, so that the order of the work does not matter; a result counts more than a failure.

        Raises:
            InputError: a journal cannot be read, or is of a newer version.
        """
        done: dict[bytes, JournalEntry] = {}
        failed: dict[bytes, JournalEntry] = {}
        damaged = 0
        for path in sorted((self.folder / _JOURNALS).glob(f"*{SUFFIX}")):
            entries, damaged_places = read_journal(path)
            damaged += damaged_places
            for entry in entries:
                kept = failed if entry.is_failure else done
                first = kept.get(entry.identity)
                kept[entry.identity] = entry if first is None else min(first, entry, key=body_of)
        return StoredTasks(done, {i: e for i, e in failed.items() if i not in done}, damaged)

    def repeated(self) -> Iterator[tuple[JournalEntry, JournalEntry]]:
        """Yield pairs of outcomes of one task that was done more than once."""
        first: dict[bytes, JournalEntry] = {}
        for path in sorted((self.folder / _JOURNALS).glob(f"*{SUFFIX}")):
            for entry in read_journal(path)[0]:
                if not entry.is_failure and first.setdefault(entry.identity, entry) is not entry:
                    yield first[entry.identity], entry

    def status(self) -> CampaignStatus:
        """Return how many tasks are done, failed and left; errors as in `outcomes`."""
        stored, tasks = self.outcomes(), set(self.identities)
        done = [entry.seconds for identity, entry in stored.done.items() if identity in tasks]
        failed = sum(identity in tasks for identity in stored.failed)
        mean = sum(done) / len(done) if done else None
        return CampaignStatus(len(tasks), len(done), failed, mean, stored.damaged_places)


def open_store(folder: Path) -> Store:
    """Return the campaign that a folder holds.

    Raises:
        InputError: it holds none, or one of a newer version.
    """
    try:
        table = json.loads((folder / _FILE).read_text(encoding="utf-8"))
        written_format = table["format"]
    except OSError:
        raise InputError(
            f"'{folder}' holds no campaign (no {_FILE}); give the STORE of 'seatrial campaign PLAN --out STORE'"
        ) from None
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"'{folder / _FILE}' is damaged ({error}); run the campaign's command again") from None
    if written_format != FORMAT:
        raise InputError(
            f"the campaign in '{folder}' is of format {written_format}, this version of seatrial reads {FORMAT}; "
            "use the version that made it"
        )
    return Store(folder, table)


def store_for(work: Work, tasks: tuple[Task, ...], folder: Path, plan: Path | None = None) -> Store:
    """Return the store of this work in a folder, which is made where it does not exist.

    A plan whose tasks have become more (seeds, values of a grid, files of a fleet) goes on with its store.

    Args:
        plan: the file that describes the work, from which `retry` reads it again.

    Raises:
        InputError: the folder holds another campaign, one of other versions, or something else; or cannot be written.
    """
    if (folder / _FILE).exists():
        _refuse_other(open_store(folder), work)
    elif folder.exists() and (not folder.is_dir() or any(p for p in folder.iterdir() if p.name != _JOURNALS)):
        raise InputError(f"'{folder}' exists and holds no campaign; name another folder")
    table = {
        "format": FORMAT,
        "plan": None if plan is None else str(plan.resolve()),
        "question": work.question,
        "description": dict(work.description),
        "versions": dict(work.versions),
        "digest": work.digest,
        "identities": packed([task.identity for task in tasks]),
    }
    write_atomically(folder / _FILE, json.dumps(table, indent=1, ensure_ascii=False).encode())
    return Store(folder, table)


def _refuse_other(store: Store, work: Work) -> None:
    """Raises:
    InputError: the store belongs to another campaign, or was begun with other versions.
    """
    if store.table["digest"] == work.digest:
        return
    for name, version in work.versions.items():
        begun_with = store.table["versions"].get(name)
        if begun_with != version:
            raise InputError(
                f"the campaign in '{store.folder}' was begun with {name} {begun_with}, this is {version}: results "
                f"would mix; install {name} {begun_with}, or name another folder"
            )
    old, new = store.table["description"], dict(work.description)
    changed = ", ".join(sorted(key for key in {*old, *new} if old.get(key) != new.get(key)))
    raise InputError(
        f"'{store.folder}' holds another campaign (it differs in: {changed}); name another folder for --out"
    )
