"""Bytes as lines from any sender: standard input, a file that grows, datagrams."""

import os
import select
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from stat import S_ISREG
from typing import Protocol

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import InputError
from seatrial.numerics.platform import has_input

# Bytes as lines, from any sender: half a line waits for its end, too long a line is dropped and counted.

# ten times the longest NMEA sentence or row of a logger with some dozens of channels
MAX_LINE_BYTES = 4096


@dataclass(frozen=True)
class LineBatch:
    """Lines received, without their ends; `starts_file`: the next line is the first of a file (header and all)."""

    lines: list[bytes]
    starts_file: bool = False


class LineSource(Protocol):
    """Where lines come from; never waits longer than the time given, never raises for what is sent."""

    is_over: bool
    """Whether the input has ended."""

    @property
    def counts(self) -> SampleCounts:
        """What did not become a line: dropped, garbled (half a line whose end was lost), truncated."""
        ...

    def read(self, seconds: float) -> LineBatch:
        """Return the lines that have arrived, of one file only, waiting up to `seconds` s for the first."""
        ...

    def close(self) -> None:
        """Close the file or the socket."""
        ...


class LineSplitter:
    """Cuts a stream of bytes at its line feeds, whatever the pieces in which it comes.

    dropped: lines longer than `longest` bytes so far; of such a line nothing is kept.
    """

    def __init__(self, longest: int = MAX_LINE_BYTES) -> None:
        self.dropped = 0
        self._longest = longest
        self._partial = b""
        self._is_skipping = False

    def split(self, chunk: bytes) -> list[bytes]:
        """Return the lines that end in this piece."""
        *lines, self._partial = (self._partial + chunk).split(b"\n")
        if self._is_skipping and lines:
            del lines[0]
            self._is_skipping = False
        kept = [line for line in lines if len(line) <= self._longest]
        self.dropped += len(lines) - len(kept)
        if self._is_skipping:
            self._partial = b""
        elif len(self._partial) > self._longest:
            self._partial = b""
            self._is_skipping = True
            self.dropped += 1
        return kept

    def flush(self) -> list[bytes]:
        """Return the rest as a line, at the end of the input; empty if there is none."""
        half, self._partial = self._partial, b""
        self._is_skipping = False
        return [half] if half else []


# Lines of standard input, or of any pipe.

# bytes read at once: what a pipe holds
_CHUNK = 1 << 16
STANDARD_INPUT = 0


class PipeLines:
    """Lines of an open file descriptor, standard input by default, until its end.

    Raises:
        InputError: the descriptor is not open.
    """

    def __init__(self, descriptor: int = STANDARD_INPUT) -> None:
        try:
            os.fstat(descriptor)
        except OSError:
            raise InputError("standard input is closed; pipe the samples into the command") from None
        self._descriptor = descriptor
        self._splitter = LineSplitter()
        self.is_over = False
        self._starts_file = True

    def read(self, seconds: float) -> LineBatch:
        """As `LineSource.read`."""
        deadline = time.monotonic() + seconds
        lines: list[bytes] = []
        remaining = seconds
        while not (lines or self.is_over) and has_input(self._descriptor, remaining):
            lines = self._read_lines()
            remaining = deadline - time.monotonic()
            if remaining <= 0.0:
                break
        starts_file, self._starts_file = self._starts_file, False
        return LineBatch(lines, starts_file)

    @property
    def counts(self) -> SampleCounts:
        """dropped: lines that were too long."""
        return SampleCounts(dropped=self._splitter.dropped)

    def close(self) -> None:
        """Do nothing: the descriptor belongs to the caller."""

    def _read_lines(self) -> list[bytes]:
        try:
            chunk = os.read(self._descriptor, _CHUNK)
        except BlockingIOError:
            return []
        except OSError:
            chunk = b""
        if chunk:
            return self._splitter.split(chunk)
        self.is_over = True
        return self._splitter.flush()


# Lines of a file that grows: appended, truncated, replaced while it is read.

# bytes read at once; bytes at the end that are compared to notice a truncation; s between looks at the file; chosen: no
# logger writes more in between, and a wait that nobody notices
_FILE_CHUNK, _MARK_BYTES, _POLL_INTERVAL_S = 1 << 18, 64, 0.05


class TailLines:
    """Lines of the file at `path`; with `once` until its present end, where the last line may lack its line feed.

    The last bytes read are compared each time: where they have changed, the file has been truncated (or written anew),
    which is counted, and reading goes on from its start. Where another file has taken its place, the old one is read to
    its end first.

    Raises:
        InputError: the file does not exist, is compressed, or is not a regular file.
    """

    def __init__(self, path: Path, *, once: bool = False) -> None:
        if path.suffix == ".gz":
            raise InputError(f"{path.name} is compressed; decompress it to follow it, or run 'seatrial identify'")
        if not path.exists():
            raise InputError(f"{path} does not exist; start the logger first, or check the path")
        if not S_ISREG(path.stat().st_mode):
            raise InputError(f"{path} is not a regular file; pipe it into standard input instead")
        self._path, self._once = path, once
        self._splitter = LineSplitter()
        self._truncated = self._garbled = 0
        self._last_error = ""
        self.is_over = False
        self._open()

    def read(self, seconds: float) -> LineBatch:
        """As `LineSource.read`."""
        deadline = time.monotonic() + seconds
        while True:
            lines = self._read_appended()
            remaining = deadline - time.monotonic()
            if lines or self.is_over or remaining <= 0:
                starts_file, self._starts_file = self._starts_file, False
                return LineBatch(lines, starts_file)
            time.sleep(min(_POLL_INTERVAL_S, remaining))

    @property
    def counts(self) -> SampleCounts:
        """truncated, garbled (half lines lost with it) and dropped (too long)."""
        dropped, truncated = self._splitter.dropped, self._truncated
        return SampleCounts(garbled=self._garbled, dropped=dropped, truncated=truncated, last_problem=self._last_error)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _open(self) -> None:
        try:
            self._file = self._path.open("rb", buffering=0)
        except OSError as error:
            raise InputError(f"{self._path} cannot be read ({error.strerror}); check its permissions") from None
        self._inode = os.fstat(self._file.fileno()).st_ino
        self._rewind()

    def _rewind(self) -> None:
        self._position, self._last_bytes, self._starts_file = 0, b"", True

    def _read_appended(self) -> list[bytes]:
        try:
            self._file.seek(self._position - len(self._last_bytes))
            data = self._file.read(len(self._last_bytes) + _FILE_CHUNK) or b""
        except OSError as error:
            self._last_error = f"{self._path.name} could not be read ({error.strerror}); trying again"
            return []
        if not data.startswith(self._last_bytes):
            self._restart()
            return []
        chunk = data[len(self._last_bytes) :]
        if chunk:
            self._position += len(chunk)
            self._last_bytes = data[-_MARK_BYTES:]
            return self._splitter.split(chunk)
        return self._at_end()

    def _at_end(self) -> list[bytes]:
        is_replaced = self._is_replaced()
        if not is_replaced and not self._once:
            return []
        rest = self._splitter.flush()
        if is_replaced and not rest:
            self._last_error = (
                f"{self._path.name} was replaced by another file while it was read; reading goes on there"
            )
            self._reopen()
        elif not is_replaced:
            self.is_over = True
        return rest

    def _is_replaced(self) -> bool:
        try:
            return self._path.stat().st_ino != self._inode
        except OSError:
            return False

    def _reopen(self) -> None:
        old = self._file
        try:
            self._open()
        except InputError as error:
            self._last_error = str(error)
        else:
            old.close()

    def _restart(self) -> None:
        self._truncated += 1
        self._garbled += len(self._splitter.flush())
        self._last_error = f"{self._path.name} was truncated while it was read; reading goes on from its start"
        self._rewind()


# Lines of UDP datagrams; any sender that reaches the socket can write them, so none is trusted.

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
