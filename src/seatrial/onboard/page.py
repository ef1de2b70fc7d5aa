"""A page of moving plots for a browser on the same machine; it listens on the loopback address only."""

import math
import secrets
import threading
import time
from typing import Any, Self

from seatrial.core.results.online import Counts, Snapshot
from seatrial.onboard import state
from seatrial.onboard.history import History
from seatrial.onboard.server import LOOPBACK, Server, listening

POLL = 0.1
WATCHED, LAST_LOOK = 3.0, 1.5


class Page:
    """Shows the snapshots it is given to whoever opens `address` on this machine.

    with Page(8000, title="trial.toml") as page: print(page.address); page.show(snapshot, counts)

    port: 0 takes a free one; title: what is followed. Threads answer the browser; the estimate never waits for them.
    """

    def __init__(self, port: int = 0, *, title: str = "") -> None:
        self.port = port
        self._title = title
        self._lock = threading.Lock()
        self._history = History()
        self._newest: tuple[Snapshot, Counts] | None = None
        self._news_at = time.monotonic()
        self._asked_at = -math.inf
        self._over: str | None = None
        self._over_at = math.inf
        self._stamp = secrets.token_hex(4)
        self._server: Server | None = None

    def __enter__(self) -> Self:
        """Begin to listen.

        Raises:
            InputError: the port is in use, not allowed, or no port at all.
        """
        self._server = listening(self.port, self.state)
        self.port = self._server.server_port
        threading.Thread(target=self._server.serve_forever, args=(POLL,), name="page", daemon=True).start()
        return self

    def __exit__(self, *raised: object) -> None:
        self._wait_for_a_last_look()
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
        self._server = None

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return f"http://{LOOPBACK}:{self.port}/"

    def show(self, snapshot: Snapshot, counts: Counts) -> None:
        """This is the newest; the same snapshot and counts again are no news."""
        with self._lock:
            last = self._newest
            if last is None or last[0] is not snapshot:
                self._history.add(snapshot)
            if last is None or last[0] is not snapshot or last[1] != counts:
                self._news_at = time.monotonic()
            self._newest = snapshot, counts

    def over(self, why: str = "") -> None:
        """Nothing more will come; the page says so and keeps what it shows."""
        with self._lock:
            self._over, self._over_at = why, time.monotonic()

    def state(self, since: int) -> dict[str, Any]:
        """What a browser that has the points up to number `since` needs; everything for -1."""
        with self._lock:
            newest, over = self._newest, self._over
            some, stride = self._history.since(since), self._history.stride
            epoch = f"{self._stamp}-{self._history.generation}"
            self._asked_at = time.monotonic()
            age = self._asked_at - self._news_at
        return {
            "title": self._title,
            "epoch": epoch,
            "stride": stride,
            "age": round(age, 1),
            "is_over": over is not None,
            "why": over or "",
            "told": None if newest is None else state.told(*newest),
            "points": [] if newest is None else state.points(some, newest[0]),
        }

    def _wait_for_a_last_look(self) -> None:
        """Whoever looks at the page as the stream ends gets its end before the page goes."""
        is_watched = self._over_at - self._asked_at < WATCHED
        while is_watched and self._asked_at < self._over_at and time.monotonic() < self._over_at + LAST_LOOK:
            time.sleep(POLL)
