"""Lines of UDP datagrams; any sender that reaches the socket can write them, so none is trusted."""

import select
import socket
import time
from collections.abc import Callable

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import InputError
from seatrial.onboard.lines import MAX_LINE_BYTES, LineBatch

# bytes of a datagram, above what any logger sends at once; lines accepted, over those expected; chosen: a sender that
# bursts still passes, a flood does not
MAX_DATAGRAM_BYTES, RATE_ALLOWANCE = 8192, 5.0
# datagrams read at once, lines that may arrive at once, however low the rate; chosen as the above
_MAX_DATAGRAMS, _MIN_CAPACITY = 2048, 20.0


class TokenBucket:
    """Lets `rate` items a second pass on average, and up to one second's worth at once."""

    def __init__(self, rate: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._rate, self._clock = rate, clock
        self._capacity = max(rate, _MIN_CAPACITY)
        self._tokens = self._capacity
        self._refilled_at = clock()

    def take(self, count: int) -> int:
        """Return how many of `count` items may pass now."""
        now = self._clock()
        self._tokens = min(self._capacity, self._tokens + self._rate * max(now - self._refilled_at, 0.0))
        self._refilled_at = now
        granted = min(count, int(self._tokens))
        self._tokens -= granted
        return granted


class UdpLines:
    """Lines of the datagrams that reach `host`:`port`; the last line of a datagram needs no line feed.

    rate: lines expected a second; five times as many pass, the rest is dropped and counted, as are datagrams beyond
    8 KiB and lines beyond 4 KiB. Nothing is kept between reads. Datagrams that the system drops between reads are not
    counted. port 0: one that is free. is_binary: a datagram is one item, whatever its bytes.

    Raises:
        InputError: the address cannot be listened to.
    """

    is_over = False

    def __init__(
        self,
        port: int,
        *,
        rate: float,
        host: str = "127.0.0.1",
        clock: Callable[[], float] = time.monotonic,
        is_binary: bool = False,
    ) -> None:
        self._bucket = TokenBucket(RATE_ALLOWANCE * rate, clock)
        self._rate = rate
        self._is_binary = is_binary
        self._dropped = 0
        self._last_error = ""
        if not 0 <= port <= 65535:  # ports are 16 bits
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
        """The port in use."""
        return int(self._socket.getsockname()[1])

    def read(self, seconds: float) -> LineBatch:
        """As `LineSource.read`."""
        deadline = time.monotonic() + seconds
        lines: list[bytes] = []
        remaining = seconds
        while not lines and select.select([self._socket], [], [], max(remaining, 0.0))[0]:
            lines = self._receive()
            remaining = deadline - time.monotonic()
            if remaining <= 0.0:
                break
        return LineBatch(lines)

    @property
    def counts(self) -> SampleCounts:
        """dropped: lines beyond the rate or too long, datagrams too long."""
        return SampleCounts(dropped=self._dropped, last_problem=self._last_error)

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
            self._last_error = f"a datagram of more than {MAX_DATAGRAM_BYTES} bytes was dropped"
            return []
        lines = [datagram] if self._is_binary else [line for line in datagram.split(b"\n") if line.strip()]
        kept = [line for line in lines if len(line) <= MAX_LINE_BYTES]
        passed = kept[: self._bucket.take(len(kept))]
        self._dropped += len(lines) - len(passed)
        if len(passed) < len(kept):
            expected = f"{RATE_ALLOWANCE:g} times the {self._rate:g} lines a second expected"
            self._last_error = f"more than {expected}; the rest is dropped"
        return passed


def _listen_error(host: str, port: int, error: Exception) -> InputError:
    return InputError(f"cannot listen to UDP {host}:{port} ({error}); choose another host or port")
