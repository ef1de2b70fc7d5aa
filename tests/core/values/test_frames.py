"""Frames: what was appended comes back, whatever bytes are cut off or damaged costs the frames they lie in."""

import errno
import io
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values.files import FrameWriter, whole_frames

CRC_SIZE = 4  # bytes of a CRC-32


def payload_size(content: bytes, offset: int) -> int:
    if content[offset : offset + 1] != b"E" or len(content) < offset + 5:
        return 0
    return 5 + struct.unpack_from("<I", content, offset + 1)[0]


def entry(body: bytes) -> bytes:
    return b"E" + struct.pack("<I", len(body)) + body


def written(bodies: list[bytes]) -> bytes:
    file = io.BytesIO()
    file.fileno = lambda: 0  # type: ignore[method-assign]
    writer = FrameWriter(file, flush_s=1e9, clock=lambda: 0.0)  # type: ignore[arg-type]
    for body in bodies:
        writer.append(entry(body))
    writer.write_pending()
    return b"head" + file.getvalue()


def read(content: bytes) -> list[bytes]:
    return [content[f.start + 5 : f.stop - CRC_SIZE] for f in whole_frames(content, 4, payload_size)]


@given(st.lists(st.binary(max_size=30), max_size=8), st.integers(0, 20))
def test_what_was_appended_comes_back_up_to_a_torn_end(bodies: list[bytes], cut: int) -> None:
    content = written(bodies)
    assert read(content) == bodies
    back = read(content[: max(len(content) - cut, 4)])
    assert back == bodies[: len(back)]
    assert len(back) >= len(bodies) - 1 - cut // 9


@given(st.lists(st.binary(min_size=1, max_size=30), min_size=3, max_size=6), st.data())
def test_a_damaged_byte_costs_its_own_frame(bodies: list[bytes], data: st.DataObject) -> None:
    content = bytearray(written(bodies))
    place = data.draw(st.integers(4, len(content) - 1))
    content[place] ^= 0xFF
    back = read(bytes(content))
    assert len(back) >= len(bodies) - 1
    assert all(body in bodies for body in back)


def test_a_full_disk_is_an_error() -> None:
    class Full(io.RawIOBase):
        def write(self, data: object) -> int:  # noqa: ARG002
            return 0

    writer = FrameWriter(Full(), 1.0)
    writer.append(b"x")
    with pytest.raises(OSError, match="space") as caught:
        writer.flush()
    assert caught.value.errno == errno.ENOSPC
