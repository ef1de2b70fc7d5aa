"""On board: a growing source followed by `seatrial follow` in a process of its own, its page inside the workspace."""

import http.client
import socket
import time
from collections.abc import Callable, Mapping
from typing import Any

import tomli_w

from seatrial.core.values import InputError
from seatrial.core.values.files import parse_toml
from seatrial.onboard.page import LOOPBACK, content_security_policy, html

_WAIT_S = 5.0  # s for an answer of the follower; chosen: it answers within milliseconds
_PAUSE_S = 0.2  # s between two attempts to reach a follower that begins; chosen
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


def free_port() -> int:
    """Return a port of this machine that is free now."""
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


def follower_page() -> tuple[str, str]:
    """Return the page of a stream and its policy: it is shown in a frame of the workspace."""
    return html(), content_security_policy().replace("frame-ancestors 'none'", "frame-ancestors 'self'")


def follower_state(port: int, since: str, is_running: Callable[[], bool]) -> bytes:
    """Return what the follower at a port answers to its page, once it has begun.

    is_running: whether it is still worth waiting for.

    Raises:
        InputError: it does not answer: it has not begun yet, or has ended.
    """
    while True:
        connection = http.client.HTTPConnection(LOOPBACK, port, timeout=_WAIT_S)
        try:
            connection.request("GET", f"/state.json?since={since}")
            answer = connection.getresponse()
            content = answer.read()
        except OSError:
            if not is_running():
                raise InputError("nothing is followed yet, or it has ended") from None
            time.sleep(_PAUSE_S)
            continue
        finally:
            connection.close()
        if answer.status != http.HTTPStatus.OK:
            raise InputError("the follower does not understand its page; start it again")
        return content
