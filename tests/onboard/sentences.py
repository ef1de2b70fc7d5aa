"""Sentences with their checksums, for tests."""

from seatrial.data.read.nmea_sentence import checksum


def sentence(body: str) -> bytes:
    """The line of a sentence, `body` between the dollar and the star."""
    return f"${body}*{checksum(body.encode()):02X}\r\n".encode()
