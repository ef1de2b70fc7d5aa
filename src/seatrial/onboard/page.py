"""A page of moving plots for a browser on the same machine; it listens on the loopback address only."""

import math
import secrets
import threading
import time
from typing import Any, Self

from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.onboard import page_state
from seatrial.onboard.history import History
from seatrial.onboard.server import LOOPBACK, Server, bind_server

# s between looks for a request to stop
POLL_INTERVAL_S = 0.1
# s since the last request within which a page counts as watched; s to wait for its last request (two a second)
WATCHED_S, LAST_REQUEST_WAIT_S = 3.0, 1.5


class Page:
    """Shows the snapshots it is given in a browser that opens `address` on this machine.

    with Page(8000, title="trial.toml") as page: print(page.address); page.show(snapshot, counts)

    port: 0 takes a free one; title: what is followed. Threads answer the browser; the estimation never waits for them.
    """

    def __init__(self, port: int = 0, *, title: str = "") -> None:
        self.port = port
        self._title = title
        self._lock = threading.Lock()
        self._history = History()
        self._latest: tuple[Snapshot, SampleCounts] | None = None
        self._updated_at = time.monotonic()
        self._requested_at = -math.inf
        self._end_reason: str | None = None
        self._ended_at = math.inf
        self._instance_id = secrets.token_hex(4)
        self._server: Server | None = None

    def __enter__(self) -> Self:
        """Start to listen.

        Raises:
            InputError: the port is in use, not allowed, or outside 0 to 65535.
        """
        self._server = bind_server(self.port, self.state)
        self.port = self._server.server_port
        threading.Thread(target=self._server.serve_forever, args=(POLL_INTERVAL_S,), name="page", daemon=True).start()
        return self

    def __exit__(self, *raised: object) -> None:
        self._wait_for_last_request()
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
        self._server = None

    @property
    def address(self) -> str:
        """The address to open in a browser."""
        return f"http://{LOOPBACK}:{self.port}/"

    def show(self, snapshot: Snapshot, counts: SampleCounts) -> None:
        """Show a snapshot; the same one with the same counts again changes nothing."""
        with self._lock:
            last = self._latest
            if last is None or last[0] is not snapshot:
                self._history.add(snapshot)
            if last is None or last[0] is not snapshot or last[1] != counts:
                self._updated_at = time.monotonic()
            self._latest = snapshot, counts

    def end(self, reason: str = "") -> None:
        """Mark the stream as ended; the page says so and keeps its numbers."""
        with self._lock:
            self._end_reason, self._ended_at = reason, time.monotonic()

    def state(self, since: int) -> dict[str, Any]:
        """Return what a browser that has the points up to number `since` needs; everything for -1."""
        with self._lock:
            newest, end_reason = self._latest, self._end_reason
            points, stride = self._history.since(since), self._history.stride
            epoch = f"{self._instance_id}-{self._history.generation}"
            self._requested_at = time.monotonic()
            age = self._requested_at - self._updated_at
        return {
            "title": self._title,
            "epoch": epoch,
            "stride": stride,
            "age": round(age, 1),
            "is_over": end_reason is not None,
            "reason": end_reason or "",
            "snapshot": None if newest is None else page_state.snapshot_json(*newest),
            "recent": page_state.recent_json(() if newest is None else newest[0].recent),
            "points": [] if newest is None else page_state.plot_points(points, newest[0]),
        }

    def _wait_for_last_request(self) -> None:
        """Wait until a page that is watched has fetched the end of the stream."""
        is_watched = self._ended_at - self._requested_at < WATCHED_S
        while (
            is_watched
            and self._requested_at < self._ended_at
            and time.monotonic() < self._ended_at + LAST_REQUEST_WAIT_S
        ):
            time.sleep(POLL_INTERVAL_S)
