"""Samples from a stream: lines from a file, a pipe or a socket, read as columns or as NMEA sentences."""

from time import monotonic
from typing import Protocol

from seatrial.core.results.online import Sample, SampleCounts
from seatrial.core.values import InputError
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.onboard.columns import ColumnReader
from seatrial.onboard.lines import LineBatch, LineSource, PipeLines, TailLines, UdpLines
from seatrial.onboard.messages import BusDecoder, MavlinkDecoder, MessageReader
from seatrial.onboard.nmea import NmeaReader
from seatrial.onboard.stream_session import combined_counts

# sentences that a talker sends with each sample, at most; chosen: an integrated bridge repeats about ten
_SENTENCES_PER_SAMPLE = 20

_BUS_LINES = 400.0
"""Lines or datagrams a second that a bus or an autopilot sends; chosen: an NMEA 2000 bus carries some 1800 frames."""


class SampleSource(Protocol):
    """Where samples come from; never waits longer than the time given, never raises for what is sent."""

    is_over: bool
    """Whether the input has ended (end of file, end of standard input)."""

    @property
    def counts(self) -> SampleCounts:
        """Counts of what could not be read so far: garbled, checksum, dropped, truncated."""
        ...

    def poll(self, seconds: float) -> list[Sample]:
        """Return the samples that have arrived, waiting up to `seconds` s for the first."""
        ...

    def close(self) -> None:
        """Close the file or the socket."""
        ...


class LineReader(Protocol):
    """Turns lines into samples; keeps what it needs of earlier lines, never raises for their content."""

    def samples(self, batch: LineBatch) -> list[Sample]:
        """Return the samples that these lines complete, in order."""
        ...

    def flush(self) -> list[Sample]:
        """Return the remaining samples, at the end of the input."""
        ...

    @property
    def counts(self) -> SampleCounts:
        """Counts of what could not be read."""
        ...


class LineSampleSource:
    """A source of samples: lines from one input, read by one reader."""

    def __init__(self, lines: LineSource, reader: LineReader) -> None:
        self._lines, self._reader = lines, reader
        self.is_over = False

    def poll(self, seconds: float) -> list[Sample]:
        """As `SampleSource.poll`."""
        deadline = monotonic() + seconds
        samples: list[Sample] = []
        while not (samples or self.is_over):
            remaining = deadline - monotonic()
            samples = self._reader.samples(self._lines.read(max(remaining, 0.0)))
            if self._lines.is_over:
                self.is_over = True
                samples += self._reader.flush()
            if remaining <= 0.0:
                break
        return samples

    @property
    def counts(self) -> SampleCounts:
        """As `SampleSource.counts`."""
        return combined_counts(self._lines.counts, self._reader.counts)

    def close(self) -> None:
        """Give back the file or the socket."""
        self._lines.close()


def open_source(stream: Stream, *, once: bool = False) -> SampleSource:
    """Return the source of a trial's stream; with `once` a file ends at its present end.

    Raises:
        InputError: the file or address cannot be opened, or the layout cannot be followed (see the readers).
    """
    return LineSampleSource(_open_lines(stream, once=once), _reader(stream))


def _reader(stream: Stream) -> LineReader:
    match stream.source:
        case StreamSource.NMEA_FILE | StreamSource.NMEA_STDIN | StreamSource.NMEA_UDP:
            return NmeaReader(stream.layout, rate=stream.rate)
        case StreamSource.NMEA2000_UDP:
            return MessageReader(stream.layout, BusDecoder(), rate=stream.rate)
        case StreamSource.MAVLINK_UDP:
            return MessageReader(stream.layout, MavlinkDecoder(), rate=stream.rate)
        case _:
            return ColumnReader(stream.layout)


def _open_lines(stream: Stream, *, once: bool) -> LineSource:
    match stream.source:
        case StreamSource.FILE | StreamSource.NMEA_FILE:
            if stream.file is None:
                raise InputError("file is missing in [follow]; name the file to follow")
            return TailLines(stream.file, once=once)
        case StreamSource.STDIN | StreamSource.NMEA_STDIN:
            return PipeLines()
        case StreamSource.UDP:
            return UdpLines(stream.port or 0, rate=stream.rate, host=stream.host)
        case StreamSource.NMEA_UDP:
            return UdpLines(stream.port or 0, rate=stream.rate * _SENTENCES_PER_SAMPLE, host=stream.host)
        case StreamSource.NMEA2000_UDP:
            return UdpLines(stream.port or 0, rate=_BUS_LINES, host=stream.host)
        case StreamSource.MAVLINK_UDP:
            return UdpLines(stream.port or 0, rate=_BUS_LINES, host=stream.host, is_binary=True)
