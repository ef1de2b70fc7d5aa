"""A trial's stream opened: from any place, in either language, to its last line."""

import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.onboard.sentences import sentence

from seatrial.core.results.online import Sample
from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.onboard.sources import SampleSource, open_source

COLUMNS = Layout("text", ColumnSpec("time", 1, "s"), (ColumnSpec("psi", 2, "deg"),))
SENTENCES = Layout("text", ColumnSpec("time", "stamp", "s"), (ColumnSpec("psi", "psi", "deg"),))
LINES = b"".join(b"%d,90\n" % k for k in range(5)) + b"5,90"
SAID = b"".join(sentence(f"GPZDA,00000{k}") + sentence("HEHDT,90,T") for k in range(6))


def everything(source: SampleSource) -> list[float]:
    found: list[Sample] = []
    for _ in range(200):
        found += source.poll(0.01)
        if source.is_over:
            break
    source.close()
    return [s.time for s in found]


@pytest.mark.parametrize(
    ("feed", "layout", "text"), [(StreamSource.FILE, COLUMNS, LINES), (StreamSource.NMEA_FILE, SENTENCES, SAID)]
)
def test_a_file_once(tmp_path: Path, feed: StreamSource, layout: Layout, text: bytes) -> None:
    path = tmp_path / "run.txt"
    path.write_bytes(text)
    source = open_source(Stream(source=feed, layout=layout, rate=1.0, file=path), once=True)
    assert everything(source) == [0, 1, 2, 3, 4, 5] and source.is_over and source.poll(0.0) == []


@pytest.fixture
def standard_input() -> Iterator[int]:
    """The writing end of a pipe that stands for standard input."""
    reading, writing = os.pipe()
    kept = os.dup(0)
    os.dup2(reading, 0)
    yield writing
    os.dup2(kept, 0)
    for descriptor in (reading, kept):
        os.close(descriptor)


@pytest.mark.parametrize(
    ("feed", "layout", "text"), [(StreamSource.STDIN, COLUMNS, LINES), (StreamSource.NMEA_STDIN, SENTENCES, SAID)]
)
def test_standard_input(standard_input: int, feed: StreamSource, layout: Layout, text: bytes) -> None:
    os.write(standard_input, text)
    os.close(standard_input)
    assert everything(open_source(Stream(source=feed, layout=layout, rate=1.0))) == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize(
    ("feed", "layout", "text"), [(StreamSource.UDP, COLUMNS, LINES), (StreamSource.NMEA_UDP, SENTENCES, SAID)]
)
def test_datagrams(feed: StreamSource, layout: Layout, text: bytes) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.bind(("127.0.0.1", 0))
        port = sender.getsockname()[1]
    source = open_source(Stream(source=feed, layout=layout, rate=10.0, port=port))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for line in (*text.splitlines(), b"garbage", b"\x00" * 9000):
            sender.sendto(line, ("127.0.0.1", port))
    times = [s.time for s in source.poll(1.0)]
    assert times == [0, 1, 2, 3, 4, 5][: len(times)] and len(times) >= 5
    assert (source.counts.garbled, source.counts.dropped) == (1, 1)
    source.close()


def test_a_file_that_is_not_named_is_refused() -> None:
    with pytest.raises(InputError, match="Stream: source = 'file' needs a file; add it"):
        Stream(source=StreamSource.FILE, layout=COLUMNS, rate=1.0)
