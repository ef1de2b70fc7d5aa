"""A page of moving plots for a browser on the same machine; it listens on the loopback address only."""

import errno
import json
import math
import secrets
import socketserver
import sys
import threading
import time
from collections.abc import Callable
from functools import cache
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Self
from urllib.parse import parse_qs

import numpy as np

from seatrial.core.pages import shell
from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, Array, InputError, Record, display_unit, worst_first
from seatrial.core.values.notation import POSITIONS, channel_label, channel_unit, display_values, reading_order
from seatrial.core.values.record_chart import has_track, is_constant
from seatrial.numerics.platform import reuses_addresses_safely
from seatrial.onboard.table import (
    NORMAL_95,
    History,
    HistoryPoint,
    estimate_rows,
    fault_counts,
    phase_meaning,
    proposal_lines,
    residual_rms,
    time_text,
    watch_sentence,
)

# Answers a browser on the same machine: two fixed paths, the loopback address only, no files.

LOOPBACK = "127.0.0.1"
# s after which a request that has not been completed is dropped
REQUEST_TIMEOUT_S = 5.0
# the address of a page itself, in its policy
SELF = "'self'"
StateProvider = Callable[[int], dict[str, Any]]


def bind_server(port: int, state: StateProvider) -> "Server":
    """Return a server bound to its port; 0 takes a free one.

    Raises:
        InputError: the port is in use, not allowed, or outside 0 to 65535.
    """
    if not 0 <= port < 65536:  # ports are 16 bits
        raise InputError(
            f"there is no port {port} for the page; give one from 1024 to 65535, or 0 for any that is free"
        )
    try:
        return Server(port, state)
    except OSError as error:
        in_use = error.errno == errno.EADDRINUSE
        why = "is in use by another program" if in_use else f"cannot be opened ({error.strerror or error})"
        raise InputError(f"port {port} of the page {why}; give another, or 0 for a free one") from None


class Server(ThreadingHTTPServer):
    """Answers with the page and with the result of `state(since)`."""

    daemon_threads = True
    allow_reuse_address = reuses_addresses_safely()

    def __init__(self, port: int, state: StateProvider) -> None:
        self.state = state
        super().__init__((LOOPBACK, port), _RequestHandler)
        self.hosts = {f"{name}:{self.server_port}" for name in (LOOPBACK, "localhost")}

    def server_bind(self) -> None:
        """Bind as a socket does, without a look-up of this machine's name in the network."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = LOOPBACK, self.server_address[1]

    def handle_error(self, request: object, client_address: object) -> None:
        """Ignore a browser that has disconnected; report anything else."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)  # pyright: ignore[reportArgumentType]


class _RequestHandler(BaseHTTPRequestHandler):
    """Two fixed paths, GET only, for a browser that names this machine."""

    server: Server  # pyright: ignore[reportIncompatibleVariableOverride]
    server_version, sys_version = "seatrial", ""
    timeout = REQUEST_TIMEOUT_S

    def do_GET(self) -> None:
        path, _, query = self.path.partition("?")
        if self.headers.get_all("Host") not in [[host] for host in self.server.hosts]:
            # another name for this address is how a foreign page would read it (DNS rebinding)
            self._respond_error(HTTPStatus.FORBIDDEN)
        elif path == "/":
            self._respond("text/html; charset=utf-8", html().encode())
        elif path != "/state.json":
            self._respond_error(HTTPStatus.NOT_FOUND)
        elif self.headers.get("Sec-Fetch-Site", "same-origin") not in ("same-origin", "none"):
            self._respond_error(HTTPStatus.FORBIDDEN)
        elif (since := _parse_since(query)) is None:
            self._respond_error(HTTPStatus.BAD_REQUEST)
        else:
            text = json.dumps(self.server.state(since), allow_nan=False, separators=(",", ":"))
            self._respond("application/json", text.encode())

    def do_other(self) -> None:
        """Refuse every other method."""
        self._respond_error(HTTPStatus.METHOD_NOT_ALLOWED)

    do_HEAD = do_POST = do_PUT = do_PATCH = do_DELETE = do_OPTIONS = do_TRACE = do_CONNECT = do_other

    def _respond(self, kind: str, body: bytes) -> None:
        self._send_headers(HTTPStatus.OK, kind, len(body))
        self.wfile.write(body)

    def _respond_error(self, status: HTTPStatus) -> None:
        body = f"{status.value} {status.phrase}\n".encode()
        self._send_headers(status, "text/plain; charset=utf-8", len(body))
        if self.command != "HEAD":
            self.wfile.write(body)

    def _send_headers(self, status: HTTPStatus, kind: str, length: int) -> None:
        self.send_response(status)
        sent = {
            "Content-Type": kind,
            "Content-Length": str(length),
            **HEADERS,
            "Content-Security-Policy": content_security_policy(),
        }
        if status is HTTPStatus.METHOD_NOT_ALLOWED:
            sent["Allow"] = "GET"
        for name, value in sent.items():
            self.send_header(name, value)
        self.end_headers()

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing."""


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
    """Return the page, the same for every stream: style and script inside, nothing fetched but the state."""
    return shell.with_policy(shell.environment("seatrial.onboard").get_template("follow.html").render(), SELF)


@cache
def content_security_policy() -> str:
    """Return the page's policy: only its own script and style, and requests to its own address."""
    return f"{shell.policy(html(), SELF)}; frame-ancestors 'none'"


def _parse_since(query: str) -> int | None:
    """The number in the query, -1 if there is none, None if it is not a number."""
    text = parse_qs(query).get("since", ["-1"])[0]
    digits = text.removeprefix("-")
    is_number = digits.isascii() and digits.isdigit() and len(digits) < 16  # digits that JavaScript counts
    return int(text) if is_number else None


# What the page requests: the newest snapshot as text, and the points its plots do not have yet.

# digits of plotted points, letters of a finding; chosen: finer than a screen, longer than any sentence of ours
JSON_DIGITS, MAX_LENGTH = 8, 1000
# channels that say most of a manoeuvre, and how many of others are shown where a stream has neither
_FIRST_CHANNELS, MAX_CHANNELS = ("delta", "psi"), 2


def snapshot_json(snapshot: Snapshot, counts: SampleCounts) -> dict[str, Any]:
    """Return the newest snapshot as text: facts, table rows, findings."""
    return {
        "phase": snapshot.phase.value,
        "meaning": phase_meaning(snapshot),
        "time": time_text(snapshot.time),
        "samples": snapshot.samples,
        "runs": snapshot.runs,
        "rows": [vars(row) for row in estimate_rows(snapshot)],
        "noise": [
            {"name": name, "meaning": NOTATION[name].meaning if name in NOTATION else "", "rms": rms, "unit": unit}
            for name, rms, unit in residual_rms(snapshot)
        ],
        "unidentified": [printable(name) for name in snapshot.unidentified],
        "advice": printable(snapshot.advice),
        "proposal": [] if snapshot.proposal is None else proposal_lines(snapshot.proposal),
        "change": watch_sentence(snapshot),
        "accepted": counts.accepted,
        "faults": fault_counts(counts),
        "last": printable(counts.last_problem),
        "findings": [
            {
                "severity": f.severity.value,
                "text": printable(f.text, MAX_LENGTH),
                "advice": printable(f.advice, MAX_LENGTH),
            }
            for f in worst_first(snapshot.findings)
        ],
    }


def recent_json(records: tuple[Record, ...]) -> dict[str, Any]:
    """Return the run so far in display units: track [m], and rudder and heading, or the first channels that move."""
    if not records:
        return {"track": None, "channels": []}
    record = records[-1]
    moving = [name for name in reading_order(list(record.channels)) if not is_constant(record, name)]
    names = [name for name in _FIRST_CHANNELS if name in moving] or moving[:MAX_CHANNELS]
    elapsed = _json_numbers(record.time - record.time[0])
    channels = [
        {
            "label": channel_label(name, record.channel(name).unit),
            "time": elapsed,
            "values": _json_numbers(display_values(name, record[name], record.channel(name).unit)),
        }
        for name in names
    ]
    track = {name: _json_numbers(record[name]) for name in POSITIONS} if has_track(record) else None
    return {"track": track, "channels": channels}


def plot_points(points: list[HistoryPoint], snapshot: Snapshot) -> list[list[Any]]:
    """Return for each point: sequence, elapsed [s], values, half intervals, noise, in display units; null: unknown.

    Values and half intervals as `snapshot.names`, noise as `snapshot.noise`.
    """
    factors = np.array([display_unit(unit)[0] for unit in snapshot.units])
    channels = [(name, display_unit(channel_unit(name))[0]) for name in snapshot.noise]
    return [
        [
            point.sequence,
            _json_number(point.elapsed),
            _json_numbers(factors * point.value),
            _json_numbers(NORMAL_95 * factors * point.standard_error),
            [_json_number(factor * point.noise.get(name, math.nan)) for name, factor in channels],
        ]
        for point in points
    ]


def _json_numbers(values: Array) -> list[float | None]:
    return [_json_number(float(value)) for value in values]


def _json_number(value: float) -> float | None:
    """A number for JSON: no infinities, no more digits than a plot shows."""
    return float(f"{value:.{JSON_DIGITS}g}") if math.isfinite(value) else None


# A page of moving plots for a browser on the same machine; it listens on the loopback address only.

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
            "snapshot": None if newest is None else snapshot_json(*newest),
            "recent": recent_json(() if newest is None else newest[0].recent),
            "points": [] if newest is None else plot_points(points, newest[0]),
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
