"""Inputs made from well-formed ones: bytes, numbers, words, lines and brackets changed at random."""

import random
import re
from collections.abc import Callable, Sequence

_NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
_WORD = re.compile(rb"[A-Za-z_]{2,}")
# what stands for a number where programs go wrong
_NUMBERS = (
    b"nan", b"inf", b"-inf", b"0", b"-0.0", b"-1", b"1e308", b"-1e308", b"1e-320", b"1e30", b"1e-30", b"1e15", b"1e400",
    b"9" * 400, b"1_0", "１２".encode(), b"0x10", b"1,5", b"", b"1e12", b"-999", b"2147483648", b"9223372036854775808",
    b"true", b'"x"', b"[]", b"{}", b"0.1", b"3.14159", b"1e-9", b"65536",
)  # fmt: skip
_TEXTS = (
    b"\0", b"\xff\xfe", "é".encode(), "\u202e".encode(), b"\r", b"\n", b"'", b'"', b'"""', b"<script>", b"${HOME}",
    b"../", b"/dev/zero", b"*", b"**", b"{", b"}", b"[" * 50, b"]" * 50, b"=", b"#", b",", b";", b"\t", b" ", b"$",
    b"%s%n", b"\\", b":",
)  # fmt: skip
_MOST_CHANGES = 4  # of one input: chosen, more leave little that a parser reads to its end
_LONGEST = 200_000  # bytes of an input: chosen, larger ones only cost time

Change = Callable[[bytes, random.Random, Sequence[bytes]], bytes]


def mutated(seeds: Sequence[bytes], rng: random.Random) -> bytes:
    """Return one of the seeds after a few random changes; other seeds lend their words and their parts."""
    data = rng.choice(seeds)
    for _ in range(rng.randint(1, _MOST_CHANGES)):
        data = rng.choice(_CHANGES)(data, rng, seeds)
    return data[:_LONGEST]


def _position(data: bytes, rng: random.Random) -> int:
    return rng.randrange(len(data) + 1)


def _flip(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    if not data:
        return data
    place = rng.randrange(len(data))
    return data[:place] + bytes([data[place] ^ 1 << rng.randrange(8)]) + data[place + 1 :]


def _insert(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    place = _position(data, rng)
    return data[:place] + rng.choice(_TEXTS) + data[place:]


def _remove(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    first = _position(data, rng)
    return data[:first] + data[first + rng.choice((1, 2, 10, 100, 1000)) :]


def _cut(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    return data[: _position(data, rng)]


def _splice(data: bytes, rng: random.Random, seeds: Sequence[bytes]) -> bytes:
    other = rng.choice(seeds)
    return data[: _position(data, rng)] + other[_position(other, rng) :]


def _number(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    return _replaced(data, _NUMBER, rng.choice(_NUMBERS), rng)


def _word(data: bytes, rng: random.Random, seeds: Sequence[bytes]) -> bytes:
    words = _WORD.findall(rng.choice(seeds))
    return _replaced(data, _WORD, rng.choice(words), rng) if words else data


def _lines(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    """One line repeated, removed, or put in another place."""
    lines = data.split(b"\n")
    line = lines[rng.randrange(len(lines))]
    match rng.randrange(3):
        case 0:
            lines[rng.randrange(len(lines)) :] = []
        case 1:
            lines = [line] * rng.choice((1, 2, 100)) + lines
        case _:
            lines.insert(rng.randrange(len(lines) + 1), line)
    return b"\n".join(lines)


def _nest(data: bytes, rng: random.Random, _: Sequence[bytes]) -> bytes:
    place, depth = _position(data, rng), rng.choice((1, 30, 3000))
    opening, closing = rng.choice(((b"[", b"]"), (b"{a=", b"}"), (b'{"a":', b"}"), (b"(", b")")))
    return data[:place] + opening * depth + closing * depth + data[place:]


def _replaced(data: bytes, pattern: re.Pattern[bytes], text: bytes, rng: random.Random) -> bytes:
    places = [match.span() for match in pattern.finditer(data)]
    if not places:
        return data
    first, last = rng.choice(places)
    return data[:first] + text + data[last:]


_CHANGES: tuple[Change, ...] = (
    _flip, _insert, _remove, _cut, _splice, _number, _number, _number, _word, _word, _lines, _nest,
)  # fmt: skip
