"""A page of moving plots for a browser on the same machine; it listens on the loopback address only."""

import base64
import errno
import hashlib
import json
import os
import secrets
import socketserver
import sys
import threading
import time
from functools import cache
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from typing import Any, Self
from urllib.parse import parse_qs

from seatrial.follow import state
from seatrial.follow.history import History
from seatrial.results.online import Counts, Snapshot
from seatrial.values import InputError

LOOPBACK = "127.0.0.1"
PATIENCE = 5.0
POLL = 0.1


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
        self._over: str | None = None
        self._stamp = secrets.token_hex(4)
        self._server: _Server | None = None

    def __enter__(self) -> Self:
        """Begin to listen.

        Raises:
            InputError: the port is in use, not allowed, or no port at all.
        """
        self._server = _listening(self)
        self.port = self._server.server_port
        threading.Thread(target=self._server.serve_forever, args=(POLL,), name="page", daemon=True).start()
        return self

    def __exit__(self, *raised: object) -> None:
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
            self._over = why

    def state(self, since: int) -> dict[str, Any]:
        """What a browser that has the points up to number `since` needs; everything for -1."""
        with self._lock:
            newest, over = self._newest, self._over
            some, stride = self._history.since(since), self._history.stride
            epoch = f"{self._stamp}-{self._history.generation}"
            age = time.monotonic() - self._news_at
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


class _Server(ThreadingHTTPServer):
    """Answers for one page."""

    daemon_threads = True
    # on Windows this option would let two programs share a port
    allow_reuse_address = os.name != "nt"

    def __init__(self, page: Page) -> None:
        self.page = page
        super().__init__((LOOPBACK, page.port), _Answer)
        self.hosts = {f"{name}:{self.server_port}" for name in (LOOPBACK, "localhost")}

    def server_bind(self) -> None:
        """As the socket does, without asking the network for this machine's name."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = LOOPBACK, self.server_address[1]

    def handle_error(self, request: object, client_address: object) -> None:
        """A browser that went away is nobody's trouble; anything else is told."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)  # pyright: ignore[reportArgumentType]


class _Answer(BaseHTTPRequestHandler):
    """Two fixed paths, GET only, for a browser that names this machine."""

    server: _Server  # pyright: ignore[reportIncompatibleVariableOverride]
    server_version, sys_version = "seatrial", ""
    timeout = PATIENCE

    def do_GET(self) -> None:
        path, _, query = self.path.partition("?")
        if self.headers.get_all("Host") not in [[host] for host in self.server.hosts]:
            # another name for this address is how a foreign page would read it (DNS rebinding)
            self._refuse(HTTPStatus.FORBIDDEN)
        elif path == "/":
            self._answer("text/html; charset=utf-8", html().encode())
        elif path != "/state.json":
            self._refuse(HTTPStatus.NOT_FOUND)
        elif self.headers.get("Sec-Fetch-Site", "same-origin") not in ("same-origin", "none"):
            self._refuse(HTTPStatus.FORBIDDEN)
        elif (since := _since(query)) is None:
            self._refuse(HTTPStatus.BAD_REQUEST)
        else:
            text = json.dumps(self.server.page.state(since), allow_nan=False, separators=(",", ":"))
            self._answer("application/json", text.encode())

    def do_other(self) -> None:
        """No other method is known."""
        self._refuse(HTTPStatus.METHOD_NOT_ALLOWED)

    do_HEAD = do_POST = do_PUT = do_PATCH = do_DELETE = do_OPTIONS = do_TRACE = do_CONNECT = do_other

    def _answer(self, kind: str, body: bytes) -> None:
        self._begin(HTTPStatus.OK, kind, len(body))
        self.wfile.write(body)

    def _refuse(self, status: HTTPStatus) -> None:
        body = f"{status.value} {status.phrase}\n".encode()
        self._begin(status, "text/plain; charset=utf-8", len(body))
        if self.command != "HEAD":
            self.wfile.write(body)

    def _begin(self, status: HTTPStatus, kind: str, length: int) -> None:
        self.send_response(status)
        sent = {"Content-Type": kind, "Content-Length": str(length), **HEADERS, "Content-Security-Policy": policy()}
        if status is HTTPStatus.METHOD_NOT_ALLOWED:
            sent["Allow"] = "GET"
        for name, value in sent.items():
            self.send_header(name, value)
        self.end_headers()

    def log_message(self, format: str, *args: object) -> None:
        """Nothing is logged."""


HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}


@cache
def html() -> str:
    """The page, the same for every stream: style and script inside, nothing fetched but the state."""
    page, style, script = (_template(name) for name in ("page.html", "page.css", "page.js"))
    return page.replace("{style}", style).replace("{script}", script)


@cache
def policy() -> str:
    """What the page may do: run the one script and the one style it came with, ask its own address, nothing else."""
    style, script = (_digest(_template(name)) for name in ("page.css", "page.js"))
    return (
        f"default-src 'none'; script-src '{script}'; style-src '{style}'; connect-src 'self'; img-src data:; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


def _template(name: str) -> str:
    return files("seatrial.follow").joinpath("templates", name).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _since(query: str) -> int | None:
    """The number asked for, -1 if none is, None if it is no number."""
    text = parse_qs(query).get("since", ["-1"])[0]
    is_number = text.removeprefix("-").isascii() and text.removeprefix("-").isdigit() and len(text) < 16
    return int(text) if is_number else None


def _listening(page: Page) -> _Server:
    port = page.port
    if not 0 <= port < 65536:
        raise InputError(f"port {port} of the page is none; give one from 1024 to 65535, or 0 for any that is free")
    try:
        return _Server(page)
    except OSError as error:
        in_use = error.errno == errno.EADDRINUSE
        why = "is in use by another program" if in_use else f"cannot be had ({error.strerror or error})"
        raise InputError(f"port {port} of the page {why}; give another, or 0 for any that is free") from None
