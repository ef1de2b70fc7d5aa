"""Events to every open page: what has changed, and how far a job is (server-sent events, HTML Living Standard 9.2)."""

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any

HEARTBEAT_S = 15.0
"""s of silence after which a comment shows whether a page is still there; chosen."""
MOST_WAITING = 256
"""Events that a page may leave unread before it is dropped and loads anew; chosen."""


class EventStream:
    """Takes events from any thread and gives them to each open page."""

    def __init__(self) -> None:
        self._loop: asyncio.AbstractEventLoop | None = None
        self._queues: set[asyncio.Queue[str]] = set()
        self.is_closed = False

    def publish(self, kind: str, content: dict[str, Any]) -> None:
        """Send an event to every page that listens; from any thread, and without waiting."""
        self._send(f"event: {kind}\ndata: {json.dumps(content, allow_nan=False)}\n\n")

    def close(self) -> None:
        """End the streams of all pages."""
        self.is_closed = True
        self._send("")

    def _send(self, text: str) -> None:
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._deliver, text)

    async def listen(self) -> AsyncIterator[str]:
        """Yield the events from now on, as text of the stream."""
        self._loop = asyncio.get_running_loop()
        queue: asyncio.Queue[str] = asyncio.Queue(MOST_WAITING)
        self._queues.add(queue)
        try:
            yield "event: hello\ndata: {}\n\n"
            while not self.is_closed:
                try:
                    text = await asyncio.wait_for(queue.get(), HEARTBEAT_S)
                except TimeoutError:
                    text = ": still here\n\n"
                if not text:
                    return
                yield text
        finally:
            self._queues.discard(queue)

    def _deliver(self, text: str) -> None:
        for queue in list(self._queues):
            if queue.full():
                self._queues.discard(queue)  # the page loads anew what it has not read
                queue.get_nowait()
                queue.put_nowait("")
            else:
                queue.put_nowait(text)
