"""Bytes as lines, from any sender: half a line waits for its end, too long a line is dropped and counted."""

from dataclasses import dataclass
from typing import Protocol

from seatrial.core.results.online import SampleCounts

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
