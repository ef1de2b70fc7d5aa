"""Samples from a stream: lines from a file, a pipe or a socket, read as columns or as NMEA sentences."""

from time import monotonic
from typing import Protocol

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import InputError
from seatrial.data.trial.trial import Stream, StreamSource
from seatrial.onboard.columns import ColumnReader
from seatrial.onboard.lines import LineBatch, LineSource
from seatrial.onboard.nmea import NmeaReader
from seatrial.onboard.sample import Sample, SampleSource
from seatrial.onboard.sample_order import combined_counts
from seatrial.onboard.stdin import PipeLines
from seatrial.onboard.tail import TailLines
from seatrial.onboard.udp import UdpLines

_SENTENCES_PER_SAMPLE = 20


class LineReader(Protocol):
    """Lines to samples; keeps what it needs of the lines before, never raises for what is in them."""

    def samples(self, batch: LineBatch) -> list[Sample]:
        """The samples that these lines complete, in order."""
        ...

    def flush(self) -> list[Sample]:
        """What is left when no more lines will come."""
        ...

    @property
    def counts(self) -> SampleCounts:
        """What could not be read."""
        ...


class LineSampleSource:
    """A source of samples: lines from one place, read in one way."""

    def __init__(self, lines: LineSource, reader: LineReader) -> None:
        self._lines, self._reader = lines, reader
        self._is_over = False

    def poll(self, seconds: float) -> list[Sample]:
        """Samples that have come, waiting at most so long for the first."""
        deadline = monotonic() + seconds
        found: list[Sample] = []
        while not (found or self._is_over):
            left = deadline - monotonic()
            found = self._reader.samples(self._lines.read(max(left, 0.0)))
            if self._lines.is_over:
                self._is_over = True
                found += self._reader.flush()
            if left <= 0.0:
                break
        return found

    @property
    def is_over(self) -> bool:
        """Whether nothing more will come."""
        return self._is_over

    @property
    def counts(self) -> SampleCounts:
        """What could not be read so far."""
        return combined_counts(self._lines.counts, self._reader.counts)

    def close(self) -> None:
        """Give back the file or the socket."""
        self._lines.close()


def open_source(stream: Stream, *, once: bool = False) -> SampleSource:
    """The source of a trial's stream; with `once` a file is over at its end.

    Raises:
        InputError: the file or address cannot be opened, the layout cannot be followed (see the readers).
    """
    is_nmea = stream.source in (StreamSource.NMEA_FILE, StreamSource.NMEA_STDIN, StreamSource.NMEA_UDP)
    reader: LineReader = NmeaReader(stream.layout, rate=stream.rate) if is_nmea else ColumnReader(stream.layout)
    return LineSampleSource(_open_lines(stream, once=once), reader)


def _open_lines(stream: Stream, *, once: bool) -> LineSource:
    match stream.source:
        case StreamSource.FILE | StreamSource.NMEA_FILE:
            if stream.file is None:
                raise InputError("follow.file is missing; name the file that is to be followed")
            return TailLines(stream.file, once=once)
        case StreamSource.STDIN | StreamSource.NMEA_STDIN:
            return PipeLines()
        case StreamSource.UDP:
            return UdpLines(stream.port, rate=stream.rate, host=stream.host)
        case StreamSource.NMEA_UDP:
            return UdpLines(stream.port, rate=stream.rate * _SENTENCES_PER_SAMPLE, host=stream.host)
