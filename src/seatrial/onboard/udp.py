"""Lines of UDP datagrams, from anyone who can reach the socket and therefore never trusted."""

import select
import socket
import time
from collections.abc import Callable

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import InputError
from seatrial.onboard.lines import MAX_LINE_BYTES, LineBatch

MAX_DATAGRAM_BYTES = 8192
RATE_ALLOWANCE = 5.0
_MAX_DATAGRAMS = 2048
_MIN_CAPACITY = 20.0


class TokenBucket:
    """Lets through `rate` things a second on the average, and up to a second's worth at once."""

    def __init__(self, rate: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._rate, self._clock = rate, clock
        self._capacity = max(rate, _MIN_CAPACITY)
        self._tokens = self._capacity
        self._refilled_at = clock()

    def take(self, count: int) -> int:
        """How many of `count` may pass now."""
        now = self._clock()
        self._tokens = min(self._capacity, self._tokens + self._rate * max(now - self._refilled_at, 0.0))
        self._refilled_at = now
        granted = min(count, int(self._tokens))
        self._tokens -= granted
        return granted


class UdpLines:
    """Lines of the datagrams that reach `host`:`port`; the last line of a datagram needs no end.

    rate: lines a second that are expected; five times as many pass, the rest is dropped and counted, as is a datagram
    beyond 8 KiB (one) and a line beyond 4 KiB. Nothing is kept between reads. What the system drops because nobody
    reads is not seen here. port 0: one that is free.

    Raises:
        InputError: the address cannot be listened to.
    """

    def __init__(
        self, port: int, *, rate: float, host: str = "127.0.0.1", clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._bucket = TokenBucket(RATE_ALLOWANCE * rate, clock)
        self._rate = rate
        self._dropped = 0
        self._last_trouble = ""
        if not 0 <= port <= 65535:
            raise InputError(f"there is no UDP port {port}; choose one from 1 to 65535")
        try:
            kind, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            self._socket = socket.socket(kind, socket.SOCK_DGRAM)
        except (OSError, UnicodeError) as error:
            raise _listen_error(host, port, error) from None
        try:
            self._socket.setblocking(False)
            self._socket.bind(address)
        except OSError as error:
            self._socket.close()
            raise _listen_error(host, port, error) from None

    @property
    def port(self) -> int:
        """The port that is listened to."""
        return int(self._socket.getsockname()[1])

    def read(self, seconds: float) -> LineBatch:
        """Lines that have come, waiting at most so long for the first."""
        deadline = time.monotonic() + seconds
        lines: list[bytes] = []
        left = seconds
        while not lines and select.select([self._socket], [], [], max(left, 0.0))[0]:
            lines = self._receive()
            left = deadline - time.monotonic()
            if left <= 0.0:
                break
        return LineBatch(lines)

    @property
    def is_over(self) -> bool:
        """Never."""
        return False

    @property
    def counts(self) -> SampleCounts:
        """dropped: lines beyond the rate or too long, datagrams too long."""
        return SampleCounts(dropped=self._dropped, last_problem=self._last_trouble)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def _receive(self) -> list[bytes]:
        lines: list[bytes] = []
        for _ in range(_MAX_DATAGRAMS):
            try:
                datagram = self._socket.recv(MAX_DATAGRAM_BYTES + 1)
            except OSError:
                break
            lines += self._accepted_lines(datagram)
        return lines

    def _accepted_lines(self, datagram: bytes) -> list[bytes]:
        if len(datagram) > MAX_DATAGRAM_BYTES:
            self._dropped += 1
            self._last_trouble = f"a datagram of more than {MAX_DATAGRAM_BYTES} bytes was dropped"
            return []
        lines = [line for line in datagram.split(b"\n") if line.strip()]
        kept = [line for line in lines if len(line) <= MAX_LINE_BYTES]
        passed = kept[: self._bucket.take(len(kept))]
        self._dropped += len(lines) - len(passed)
        if len(passed) < len(kept):
            self._last_trouble = (
                f"more than {RATE_ALLOWANCE:g} times the {self._rate:g} lines a second expected; the rest is dropped"
            )
        return passed


def _listen_error(host: str, port: int, error: Exception) -> InputError:
    return InputError(f"cannot listen to UDP {host}:{port} ({error}); choose another host or port")
