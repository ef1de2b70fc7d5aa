"""A file that grows, shrinks, is cut, replaced and removed while it is read."""

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from seatrial.core.values import InputError
from seatrial.onboard.lines import TailLines


def everything(tail: TailLines) -> list[bytes]:
    found: list[bytes] = []
    for _ in range(8):
        found += tail.read(0.0).lines
    return found


def test_half_lines_wait_for_their_end(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(b"t,u\n0,1")
    tail = TailLines(path)
    assert everything(tail) == [b"t,u"]
    with path.open("ab") as file:
        file.write(b".5\n1,2\n2,")
    assert everything(tail) == [b"0,1.5", b"1,2"]
    assert not tail.is_over


def test_once_ends_with_the_last_line_even_without_its_end(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(b"0,1\n1,2")
    tail = TailLines(path, once=True)
    assert everything(tail) == [b"0,1", b"1,2"] and tail.is_over


def test_a_beginning_is_stated_once(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(b"0\n")
    tail = TailLines(path)
    assert tail.read(0.0).starts_file and not tail.read(0.0).starts_file


def test_truncation_is_counted_and_reading_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(b"0,1\n1,2\n2,hal")
    tail = TailLines(path)
    everything(tail)
    os.truncate(path, 0)
    assert tail.read(0.0).starts_file
    with path.open("ab") as file:
        file.write(b"3,4\n")
    assert everything(tail) == [b"3,4"]
    assert (tail.counts.truncated, tail.counts.garbled) == (1, 1) and "truncated" in tail.counts.last_problem


def test_truncation_is_seen_though_the_file_has_grown_beyond_again(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(b"0,1\n1,2\n")
    tail = TailLines(path)
    everything(tail)
    path.write_bytes(b"7,7\n8,8\n9,9\n10,10\n")
    assert everything(tail) == [b"7,7", b"8,8", b"9,9", b"10,10"]
    assert tail.counts.truncated == 1


def test_a_file_put_in_its_place_is_read_after_the_rest_of_the_old(tmp_path: Path) -> None:
    path, old = tmp_path / "run.csv", tmp_path / "run.csv.1"
    path.write_bytes(b"0,1\n")
    tail = TailLines(path)
    everything(tail)
    path.rename(old)
    assert everything(tail) == []
    with old.open("ab") as file:
        file.write(b"1,2\n2,3")
    path.write_bytes(b"3,4\n")
    batches = [tail.read(0.0) for _ in range(6)]
    assert [b.lines for b in batches if b.lines] == [[b"1,2"], [b"2,3"], [b"3,4"]]
    seen = [b for b in batches if b.lines or b.starts_file]
    assert [b.starts_file for b in seen] == [False, False, True, False] and seen[-1].lines == [b"3,4"]
    assert tail.counts.truncated == 0 and "replaced" in tail.counts.last_problem


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(pieces=st.lists(st.binary(max_size=30), max_size=12))
def test_appended_bytes_come_out_whatever_they_are(tmp_path: Path, pieces: list[bytes]) -> None:
    path = tmp_path / "any.csv"
    path.write_bytes(b"")
    tail = TailLines(path)
    found: list[bytes] = []
    with path.open("ab", buffering=0) as file:
        for piece in pieces:
            file.write(piece)
            found += everything(tail)
    tail.close()
    assert found == b"".join(pieces).split(b"\n")[:-1]
    assert tail.counts.truncated == 0


def test_a_long_wait_ends_with_the_first_line(tmp_path: Path) -> None:
    from threading import Timer
    from time import monotonic

    path = tmp_path / "run.csv"
    path.write_bytes(b"")
    tail, since = TailLines(path), monotonic()
    timer = Timer(0.1, path.write_bytes, [b"0,1\n"])
    timer.start()
    assert tail.read(5.0).lines == [b"0,1"] and monotonic() - since < 3.0
    timer.join()


def test_what_cannot_be_followed_is_refused(tmp_path: Path) -> None:
    packed = tmp_path / "run.csv.gz"
    packed.write_bytes(b"")
    for path, text in (
        (packed, "is compressed"),
        (tmp_path / "no.csv", "does not exist"),
        (tmp_path, "not a regular file"),
    ):
        with pytest.raises(InputError, match=text):
            TailLines(path)
