"""On board: a growing source that is followed, by the command in the terminal or by a job of the workspace."""

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

import tomli_w

from seatrial.core.values import InputError
from seatrial.core.values.files import parse_toml

_COPIED = ("header_lines", "encoding", "separator", "time", "channels", "waves")
"""Keys that the table `[follow]` and a block of records have in common."""


def with_follow_table(text: str, block: int, file: str, rate: float) -> str:
    """Return the text with a table `[follow]` for a file that grows, with the columns of a block of records.

    rate: of its samples [Hz].

    Raises:
        InputError: the text has one already, the block is a run of several sources, or the file is one of its records.
    """
    tables: Mapping[str, Any] = parse_toml(text)
    if "follow" in tables:
        raise InputError("the trial file has a table [follow] already; change it in the view 'File'")
    records = tables["records"][block]
    files = records.get("files", [])
    if not files:
        raise InputError("a run of several sources is followed by its own bus; write [follow] in the view 'File'")
    if not file or file in files:
        raise InputError("name the file that grows, which is none of the records; it need not be there yet")
    table = {"source": "file", "file": file, "rate": rate, "header_lines": 1}  # line; the one with the names
    table |= {key: records[key] for key in _COPIED if key in records}
    return f"{text.rstrip()}\n\n{tomli_w.dumps({'follow': table})}"


class FollowedStream:
    """What has been reported of a stream: the newest report, and the points of its plots that the follower keeps.

    Args:
        publish: takes each report (`StreamReporter`) as it comes.
        name: of the job that follows; empty: the command in the terminal, which ends it.
    """

    def __init__(self, publish: Callable[[dict[str, Any]], None], name: str) -> None:
        self._publish, self.name = publish, name
        self._lock = threading.Lock()
        self._report: dict[str, Any] = {}
        self._points: list[list[Any]] = []
        self._taken_at = time.monotonic()
        self._end: dict[str, Any] = {"is_over": False, "reason": ""}

    @property
    def is_over(self) -> bool:
        """Whether nothing will be reported any more."""
        return bool(self._end["is_over"])

    def take(self, report: Mapping[str, Any]) -> None:
        """Take a report and pass it on."""
        with self._lock:
            point, stride = report["point"], report["stride"]
            earlier = self._points if report["epoch"] == self._report.get("epoch") else []
            self._points = [p for p in earlier if p[0] % stride == 0 and p[0] < point[0]] + [point]
            self._report, self._taken_at = dict(report), time.monotonic()
        self._publish({**report, "age": 0.0, **self._state()})

    def end(self, reason: str = "") -> None:
        """Note that the stream has ended, and why."""
        self._end = {"is_over": True, "reason": reason}
        self._publish(self._state())

    def view(self) -> dict[str, Any]:
        """Return the newest report with all points, and how old it is [s]."""
        with self._lock:
            age = time.monotonic() - self._taken_at
            return {**self._report, "points": self._points, "age": round(age, 1), **self._state()}

    def _state(self) -> dict[str, Any]:
        """What every answer has: of which follower, when it left [s, of this machine], and whether it is over."""
        return {"name": self.name, "at": time.monotonic(), **self._end}
