"""Lines are the same however the bytes come, and none is lost without being counted."""

from hypothesis import given
from hypothesis import strategies as st

from seatrial.onboard.lines import LineSplitter

PIECES = st.lists(st.binary(max_size=40).map(lambda b: b.replace(b"\x00", b"\n")), max_size=20)


def cut(pieces: list[bytes], longest: int) -> tuple[list[bytes], int]:
    cutter = LineSplitter(longest)
    lines = [line for piece in pieces for line in cutter.split(piece)]
    return lines + cutter.flush(), cutter.dropped


@given(PIECES, st.integers(1, 60))
def test_lines_do_not_depend_on_the_pieces(pieces: list[bytes], longest: int) -> None:
    assert cut(pieces, longest) == cut([b"".join(pieces)], longest)


@given(PIECES, st.integers(1, 60))
def test_every_line_comes_out_or_is_counted(pieces: list[bytes], longest: int) -> None:
    *whole, rest = b"".join(pieces).split(b"\n")
    expected = [*whole, rest] if rest else whole
    lines, dropped = cut(pieces, longest)
    assert lines == [line for line in expected if len(line) <= longest]
    assert dropped == len(expected) - len(lines)


def test_of_an_endless_line_nothing_is_kept() -> None:
    cutter = LineSplitter(100)
    for _ in range(1000):
        assert cutter.split(b"x" * 90) == []
        assert len(cutter._partial) <= 100
    assert cutter.dropped == 1
    assert cutter.split(b"end\nnext\n") == [b"next"]
