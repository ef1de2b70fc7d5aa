"""One sample of a stream, and where samples come from."""

from typing import Protocol

from seatrial.core.results.online import Sample, SampleCounts

__all__ = ["Sample", "SampleSource"]


class SampleSource(Protocol):
    """Where samples come from; never waits longer than the time given, never raises for what is sent."""

    def poll(self, seconds: float) -> list[Sample]:
        """Return the samples that have arrived, waiting up to `seconds` s for the first."""
        ...

    @property
    def is_over(self) -> bool:
        """Whether the input has ended (end of file, end of standard input)."""
        ...

    @property
    def counts(self) -> SampleCounts:
        """Counts of what could not be read so far: garbled, checksum, dropped, truncated."""
        ...

    def close(self) -> None:
        """Close the file or the socket."""
        ...
