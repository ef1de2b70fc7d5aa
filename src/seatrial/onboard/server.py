"""Answers a browser on the same machine: two fixed paths, the loopback address only, no files."""

import errno
import json
import socketserver
import sys
from collections.abc import Callable
from functools import cache
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs

from seatrial.core.pages import shell
from seatrial.core.values import InputError
from seatrial.numerics.platform import reuses_addresses_safely

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
