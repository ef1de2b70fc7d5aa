"""Bytes to lines, whoever sends them: halves wait for their end, lines beyond a length are dropped and counted."""

from dataclasses import dataclass
from typing import Protocol

from seatrial.core.results.online import SampleCounts

MAX_LINE_BYTES = 4096


@dataclass(frozen=True)
class LineBatch:
    """Lines received, without their ends; `starts_file`: the next line is the first of a file (header and all)."""

    lines: list[bytes]
    starts_file: bool = False


class LineSource(Protocol):
    """Where lines come from. Never waits longer than asked, never raises for what somebody sends."""

    def read(self, seconds: float) -> LineBatch:
        """Lines that have come, waiting at most so long for the first; those of one file only."""
        ...

    @property
    def is_over(self) -> bool:
        """Whether nothing more will come."""
        ...

    @property
    def counts(self) -> SampleCounts:
        """What did not become a line: dropped, garbled (a half line whose end was lost), truncated."""
        ...

    def close(self) -> None:
        """Give back the file or the socket."""
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
        """The lines that end in this piece."""
        *whole, self._partial = (self._partial + chunk).split(b"\n")
        if self._is_skipping and whole:
            del whole[0]
            self._is_skipping = False
        kept = [line for line in whole if len(line) <= self._longest]
        self.dropped += len(whole) - len(kept)
        if self._is_skipping:
            self._partial = b""
        elif len(self._partial) > self._longest:
            self._partial = b""
            self._is_skipping = True
            self.dropped += 1
        return kept

    def flush(self) -> list[bytes]:
        """The half line, taken as a whole one because nothing more will come; empty if there is none."""
        half, self._partial = self._partial, b""
        self._is_skipping = False
        return [half] if half else []
