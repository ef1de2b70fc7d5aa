"""The store of a campaign: what it belongs to, and the journals; done is the union of what these hold.

STORE/campaign.json says which plan and versions it belongs to and which tasks that has. STORE/journals holds a journal
for each process that worked on it; none is ever changed by another.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from seatrial.campaigns.journal import SUFFIX, JournalEntry, OutcomeJournal, body_of, read_journal
from seatrial.campaigns.work import Task, Work, packed, unpacked
from seatrial.core.results.campaign import CampaignStatus
from seatrial.core.values import InputError
from seatrial.core.values.files import write_atomically

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
            content = read_journal(path)
            damaged += content.damaged_places
            for entry in content.entries:
                kept = failed if entry.is_failure else done
                first = kept.get(entry.identity)
                kept[entry.identity] = entry if first is None else min(first, entry, key=body_of)
        return StoredTasks(done, {i: e for i, e in failed.items() if i not in done}, damaged)

    def repeated(self) -> Iterator[tuple[JournalEntry, JournalEntry]]:
        """Yield pairs of outcomes of one task that was done more than once."""
        first: dict[bytes, JournalEntry] = {}
        for path in sorted((self.folder / _JOURNALS).glob(f"*{SUFFIX}")):
            for entry in read_journal(path).entries:
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
