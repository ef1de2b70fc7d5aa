"""One sample of a stream, and where samples come from."""

from typing import Protocol

from seatrial.core.results.online import Sample, SampleCounts

__all__ = ["Sample", "SampleSource"]


class SampleSource(Protocol):
    """Where samples come from. Never waits longer than asked, never raises for what somebody sends."""

    def poll(self, seconds: float) -> list[Sample]:
        """Samples that have come, waiting at most so long for the first; empty if none has."""
        ...

    @property
    def is_over(self) -> bool:
        """Whether nothing more will come (end of file, end of standard input)."""
        ...

    @property
    def counts(self) -> SampleCounts:
        """What could not be read so far: garbled, checksum, dropped, truncated."""
        ...

    def close(self) -> None:
        """Give back the file or the socket."""
        ...
