"""What may reach the workspace: this machine's browser with the token, small requests, completed in time."""

import asyncio
import hmac
from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import dataclass
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

REQUEST_TIMEOUT_S = 10.0
"""s from the first byte of a request to its last, after which the connection is closed; chosen: loopback is fast."""
LARGEST_REQUEST = 2**22
"""bytes of an edit, at most; chosen: four times the longest trial file."""
LARGEST_UPLOAD = 2**29
"""bytes of a log that is dropped on the page, at most; chosen: half an hour of a flight logger."""
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""What the page may do: only its own files take effect, and it speaks with its own address only."""
_HEADERS = {
    "cache-control": "no-store",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-resource-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
}

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Scope, Receive, Send], Awaitable[None]]


class DeadlineProtocol(H11Protocol):
    """HTTP/1.1 in which a request must be complete in time, however its bytes trickle in."""

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin the time in which a first request must come."""
        super().connection_made(transport)
        self._arm()

    def data_received(self, data: bytes) -> None:
        """Take bytes; the time runs until the last one of the request has come."""
        if self._deadline is None and self.conn.their_state is not h11.SEND_BODY:
            self._arm()
        super().data_received(data)
        if self.conn.their_state not in (h11.IDLE, h11.SEND_BODY):
            self._end()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the deadline of a connection that has ended."""
        self._end()
        super().connection_lost(exc)

    def _arm(self) -> None:
        self._deadline = self.loop.call_later(REQUEST_TIMEOUT_S, self._drop)

    def _end(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _drop(self) -> None:
        if self.transport is not None and not self.transport.is_closing():
            self.transport.abort()


@dataclass(frozen=True)
class Guard:
    """Lets through what names this machine, comes from the page itself, holds the token and is small enough.

    Attributes:
        application: what answers.
        port: on which it listens; hosts: by which this machine may be named.
        token: in the address that the terminal prints, then in a cookie that scripts cannot read.
    """

    application: Application
    port: int
    token: str

    @property
    def hosts(self) -> frozenset[str]:
        """The names of this machine with the port."""
        return frozenset(f"{name}:{self.port}" for name in ("127.0.0.1", "localhost"))

    @property
    def cookie(self) -> str:
        """The name of the cookie, of this port alone: cookies know no ports."""
        return f"seatrial-{self.port}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or refuse with the reason."""
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self.application(scope, receive, send)
            return
        headers = _headers(scope)
        refusal = self._refusal(scope, headers)
        if refusal is not None:
            await _answer(send, *refusal)
        elif scope["path"] == "/" and (token := _query(scope, "token")):
            await self._enter(send, token)
        elif not self._holds_token(headers):
            await _answer(send, HTTPStatus.UNAUTHORIZED, "open the address that the terminal shows: it has the token")
        else:
            limit = LARGEST_UPLOAD if scope["path"].startswith("/api/upload/") else LARGEST_REQUEST
            await self.application(scope, _bounded(receive, limit), _with_headers(send))

    def _refusal(self, scope: Scope, headers: dict[str, list[str]]) -> tuple[HTTPStatus, str] | None:
        """Why a request is answered by nothing else; None: it may go on."""
        if len(headers.get("host", [])) != 1 or headers["host"][0] not in self.hosts:
            # another name for this address is how a foreign page would read it (DNS rebinding)
            return HTTPStatus.FORBIDDEN, "this address answers to its own name only"
        if scope["method"] not in ("GET", "HEAD", "POST"):
            return HTTPStatus.METHOD_NOT_ALLOWED, "GET and POST only"
        origins = {f"http://{host}" for host in self.hosts}
        if any(origin not in origins for origin in headers.get("origin", [])):
            return HTTPStatus.FORBIDDEN, "requests come from the page itself"
        if scope["method"] == "POST" and not headers.get("origin"):
            return HTTPStatus.FORBIDDEN, "an edit names the page that it comes from"
        site = headers.get("sec-fetch-site", ["same-origin"])[0]
        is_navigation = headers.get("sec-fetch-mode", [""])[0] == "navigate" and scope["path"] == "/"
        if site not in ("same-origin", "none") and not is_navigation:
            return HTTPStatus.FORBIDDEN, "requests come from the page itself"
        length = headers.get("content-length", ["0"])[0]
        limit = LARGEST_UPLOAD if scope["path"].startswith("/api/upload/") else LARGEST_REQUEST
        if not length.isdigit() or int(length) > limit:
            return HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"at most {limit >> 20} MiB"
        return None

    def _holds_token(self, headers: dict[str, list[str]]) -> bool:
        try:
            cookies = SimpleCookie("; ".join(headers.get("cookie", [])))
        except CookieError:
            return False
        return self.cookie in cookies and hmac.compare_digest(cookies[self.cookie].value, self.token)

    async def _enter(self, send: Send, token: str) -> None:
        """Change the token of the address for the cookie."""
        if not hmac.compare_digest(token, self.token):
            await _answer(send, HTTPStatus.UNAUTHORIZED, "the token is that of an earlier workspace")
            return
        cookie = f"{self.cookie}={self.token}; HttpOnly; SameSite=Strict; Path=/"
        await _answer(send, HTTPStatus.SEE_OTHER, "", {"location": "/", "set-cookie": cookie})


def _headers(scope: Scope) -> dict[str, list[str]]:
    headers: dict[str, list[str]] = {}
    for name, value in scope["headers"]:
        headers.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
    return headers


def _query(scope: Scope, name: str) -> str:
    return parse_qs(scope["query_string"].decode("latin-1")).get(name, [""])[0]


def _bounded(receive: Receive, limit: int) -> Receive:
    """The body, cut off with an error where it is longer than it may be."""
    received = 0

    async def next_part() -> Message:
        nonlocal received
        message = await receive()
        received += len(message.get("body", b""))
        if received > limit:
            return {"type": "http.disconnect"}
        return message

    return next_part


def _with_headers(send: Send) -> Send:
    """Every answer with the page's policy, unless it has its own, as a report has."""

    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            present = {name.lower() for name, _ in message["headers"]}
            added = _HEADERS | {"content-security-policy": POLICY}
            message["headers"] = [
                *message["headers"],
                *((n.encode(), v.encode()) for n, v in added.items() if n.encode() not in present),
            ]
        await send(message)

    return send_with_headers


async def _answer(send: Send, status: HTTPStatus, text: str, headers: dict[str, str] | None = None) -> None:
    body = f"{status.value} {text or status.phrase}\n".encode()
    sent = {
        "content-type": "text/plain; charset=utf-8",
        "content-length": str(len(body)),
        "content-security-policy": "default-src 'none'",
        **_HEADERS,
        **(headers or {}),
    }
    pairs = [(name.encode(), value.encode()) for name, value in sent.items()]
    await send({"type": "http.response.start", "status": status.value, "headers": pairs})
    await send({"type": "http.response.body", "body": body})
