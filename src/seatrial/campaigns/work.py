"""What a campaign does: tasks, each a table of keys with an identity by content, and the function that does one."""

import base64
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from seatrial.core.values import InputError, versions

Scalar = str | int | float | bool | None
Row = Mapping[str, Scalar]
TaskFunction = Callable[[Mapping[str, Any]], Sequence[Row]]

DIGEST_SIZE = 32  # bytes of a SHA-256
MAX_TASKS = 1_000_000
"""Most tasks of a campaign: chosen, a year of a core at half a minute each."""


@dataclass(frozen=True)
class Task:
    """One task: its place in the plan, what distinguishes it from the others, and its identity (SHA-256)."""

    number: int
    keys: Mapping[str, Any]
    identity: bytes


@dataclass(frozen=True, eq=False)
class Work:
    """Tasks and the function that does one.

    Attributes:
        description: what all tasks share; with the versions of the packages it is part of every identity.
        keys: one table for each task, from name to scalar (a list or table only as the value of an override).
        function: keys of a task -> rows of its result; it and what it holds must pickle.
        contents: what a task depends on beyond its keys, by the value of its key ``trial``: a digest.
        question: one sentence for the page.
    """

    description: Mapping[str, Any]
    keys: Sequence[Mapping[str, Any]]
    function: TaskFunction
    contents: Mapping[str, str] = field(default_factory=dict)
    question: str = ""
    versions: Mapping[str, str] = field(default_factory=versions)

    @property
    def digest(self) -> str:
        """Return the SHA-256 of what all tasks share, hexadecimal."""
        shared = {"description": self.description, "versions": self.versions}
        return hashlib.sha256(canonical_json(shared)).hexdigest()

    def tasks(self) -> tuple[Task, ...]:
        """Return the tasks in the order of the plan.

        Raises:
            InputError: there is none, more than a campaign takes, or one occurs twice.
        """
        refuse_count(len(self.keys))
        tasks = tuple(self._identified())
        twice = len(tasks) - len({task.identity for task in tasks})
        if twice:
            raise InputError(f"{twice} tasks of the campaign occur twice; remove repeated values of its keys")
        return tasks

    def _identified(self) -> Iterator[Task]:
        shared = self.digest.encode()
        for number, keys in enumerate(self.keys):
            content = self.contents.get(str(keys.get("trial", "")), "").encode()
            yield Task(number, keys, hashlib.sha256(b"\0".join([shared, content, canonical_json(keys)])).digest())


def refuse_count(count: int) -> None:
    """Raises:
    InputError: the campaign has no task, or more than it may have.
    """
    if count < 1:
        raise InputError("the campaign has no task; give at least one seed, value, run and trial file")
    if count > MAX_TASKS:
        raise InputError(
            f"the campaign has {count:,} tasks, more than the {MAX_TASKS:,} that one may have; give fewer values or "
            "seeds, or split it into several plans"
        )


def canonical_json(value: object) -> bytes:
    """Return the one JSON text of a value: keys in order, no spaces, numbers to the last bit."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()


def packed(identities: Sequence[bytes]) -> str:
    """Return identities as one text."""
    return base64.b64encode(b"".join(identities)).decode()


def unpacked(text: str) -> list[bytes]:
    """Return the inverse of `packed`."""
    data = base64.b64decode(text)
    return [data[k : k + DIGEST_SIZE] for k in range(0, len(data), DIGEST_SIZE)]
