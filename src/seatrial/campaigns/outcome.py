"""What came of a task: rows, or a sentence why there are none; encoded where it was computed."""

import json
import time
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from seatrial.campaigns.machine import linear_algebra, processor
from seatrial.campaigns.work import Row, Scalar, Task, TaskFunction
from seatrial.core.values import InputError
from seatrial.numerics.workers import limited_workers


@dataclass(frozen=True)
class Outcome:
    """The result of one task.

    Attributes:
        is_failure: whether `body` holds a sentence in place of rows.
        seconds: wall time of the task [s].
        body: JSON: the task's keys, where it was computed, and columns of the rows, or the sentence.
    """

    identity: bytes
    is_failure: bool
    seconds: float
    body: bytes


Outcomes = Generator[Outcome, None, None]
"""Outcomes as they come; closing it ends the workers."""


@dataclass(frozen=True)
class DecodedBody:
    """The body of an outcome: columns of equal length, or why there are none, and the arithmetic it comes from."""

    keys: Mapping[str, Any]
    columns: Mapping[str, Sequence[Scalar]]
    failure: str
    processor: str
    linear_algebra: str


def attempted(function: TaskFunction, task: Task) -> Outcome:
    """Do a task and return what came of it; an error is a sentence, whatever it is.

    The task works in one thread, so that its result does not depend on the machine's cores, and as many tasks as there
    are cores do not hinder one another.
    """
    began = time.perf_counter()
    try:
        with limited_workers(1):
            rows = function(task.keys)
        body, failed = {"columns": _columns(rows)}, False
    except InputError as error:
        body, failed = {"failure": " ".join(str(error).split())}, True
    except (Exception, SystemExit) as error:  # one task must not end the others
        text = " ".join(str(error).split())
        body, failed = {"failure": f"an error of the program ({type(error).__name__}): {text}"}, True
    return Outcome(task.identity, failed, time.perf_counter() - began, _encoded(task, body))


def lost_outcome(task: Task, reason: str) -> Outcome:
    """Return the failure of a task whose worker ended without a word."""
    return Outcome(task.identity, True, 0.0, _encoded(task, {"failure": reason}))


def decoded(body: bytes) -> DecodedBody:
    """Return what a body says."""
    table: dict[str, Any] = json.loads(body)
    return DecodedBody(
        table["keys"], table.get("columns", {}), table.get("failure", ""), table["processor"], table["linear_algebra"]
    )


def _encoded(task: Task, body: Mapping[str, Any]) -> bytes:
    facts = {"keys": dict(task.keys), "processor": processor(), "linear_algebra": linear_algebra()}
    # NaN and infinities in the spelling of Python's json, which reads them back
    return json.dumps(facts | dict(body), separators=(",", ":"), ensure_ascii=False).encode()


def _columns(rows: Sequence[Row]) -> dict[str, list[Scalar]]:
    names = dict.fromkeys(name for row in rows for name in row)
    return {name: [_plain(row.get(name)) for row in rows] for name in names}


def _plain(value: object) -> Scalar:
    """Return a NumPy scalar as one of Python."""
    return value.item() if hasattr(value, "item") else value  # type: ignore[union-attr, return-value]
