"""Lines of a pipe: in halves, to its end, never waited for longer than asked."""

import os
from subprocess import PIPE, Popen
from time import monotonic

import pytest

from seatrial.core.values import InputError
from seatrial.onboard.lines import PipeLines


def test_lines_come_as_they_are_written_and_end_with_the_writer() -> None:
    reading, writing = os.pipe()
    lines = PipeLines(reading)
    os.write(writing, b"0,1\n1,")
    first = lines.read(1.0)
    assert first.lines == [b"0,1"] and first.starts_file
    os.write(writing, b"2\n\xff\x00half")
    second = lines.read(1.0)
    assert second.lines == [b"1,2"] and not second.starts_file
    os.close(writing)
    assert lines.read(1.0).lines == [b"\xff\x00half"] and lines.is_over
    assert lines.read(1.0).lines == []
    os.close(reading)


def test_nothing_is_waited_for_longer_than_asked() -> None:
    reading, writing = os.pipe()
    os.write(writing, b"half")
    since = monotonic()
    assert PipeLines(reading).read(0.1).lines == [] and 0.05 < monotonic() - since < 2.0
    os.close(writing)
    os.close(reading)


def test_an_endless_line_does_not_hold_the_reader() -> None:
    with Popen(["/bin/sh", "-c", "exec cat /dev/zero"], stdout=PIPE) as writer:
        assert writer.stdout is not None
        lines, since = PipeLines(writer.stdout.fileno()), monotonic()
        found = lines.read(0.1).lines
        writer.kill()
    assert found == [] and monotonic() - since < 2.0 and lines.counts.dropped == 1


def test_a_closed_input_is_refused() -> None:
    reading, writing = os.pipe()
    os.close(writing)
    os.close(reading)
    with pytest.raises(InputError, match="standard input is closed"):
        PipeLines(reading)
