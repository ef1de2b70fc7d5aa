"""Tables of TOML and JSON files: read within a size, parsed within a depth, whole numbers within 64 bits."""

import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from seatrial.core.values.errors import InputError
from seatrial.numerics.platform import open_without_waiting

# bytes of a file of tables, at most: 64 times the largest that the package writes; chosen
_LARGEST_FILE = 2**28
# sizes of a number of a trial or loop file, unless it is 0 or infinite, in any unit: 1e30 N m exceeds what the heaviest
# ship can meet by 1e16, and its tenth power is still a float64; ours
_SMALLEST_NUMBER, _LARGEST_NUMBER = 1e-30, 1e30
# whole numbers that TOML promises (toml.io, v1.0.0, "Integer"), and that any program reads as numbers
_LARGEST_INTEGER = 2**63


# how JSON writes halves of characters beyond 16 bits (RFC 8259, section 8.2), of which pairs are right
_HALF_CHARACTER = re.compile(r"\\u[dD][89a-fA-F]")


def read_bounded(path: Path, limit: int = _LARGEST_FILE) -> bytes:
    """Return the bytes of a file, or of a pipe; one without a writer is empty.

    Raises:
        OSError: it cannot be read.
        ValueError: it holds more than `limit` bytes; no more than these are read.
    """
    with open(path, "rb", opener=open_without_waiting) as file:
        size = file.seek(0, 2) if file.seekable() else 0
        file.seek(0) if size else None
        content = file.read(limit + 1) if size <= limit else b""
    if max(size, len(content)) > limit:
        raise ValueError(f"it is larger than {limit >> 20} MiB, which no such file is")
    return content


def read_table_text(path: Path) -> str:
    """Return the text of a file of tables, without the mark that some editors put first; errors as `read_bounded`.

    Raises:
        ValueError: it is not UTF-8 text.
    """
    try:
        return read_bounded(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError("it is not UTF-8 text; save it as UTF-8") from None


def parse_toml(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text.

    Raises:
        ValueError: no TOML, nested too deep, or a whole number beyond 64 bits; the text says which.
    """
    try:
        table = tomllib.loads(text)
        for _ in _numbers(table):
            pass
    except RecursionError:
        raise ValueError("its tables are nested too deep") from None
    return table


def parse_json(text: str) -> Any:
    """Return the value of a JSON text.

    Raises:
        ValueError: no JSON, nested too deep, NaN, infinity, a whole number beyond 64 bits, or half of a character; the
            text says which.
    """
    try:
        value = json.loads(text, parse_int=_whole_number, parse_float=_finite_number, parse_constant=_finite_number)
        if _HALF_CHARACTER.search(text):
            json.dumps(value, ensure_ascii=False).encode()
    except RecursionError:
        raise ValueError("its tables are nested too deep") from None
    except UnicodeEncodeError:
        raise ValueError("it holds half of a character, which no text is") from None
    return value


def refuse_absurd_numbers(table: Mapping[str, Any], where: str) -> None:
    """Refuse tables with a number that no quantity of a ship has in any unit; where: names the file.

    Raises:
        InputError: there is one; its key is named.
    """
    for key, number in _numbers(table):
        if math.isfinite(number) and number and not _SMALLEST_NUMBER <= abs(number) <= _LARGEST_NUMBER:
            raise InputError(f"{where}: {key} = {number:g} is no size that a quantity of a ship can have; correct it")


def _numbers(value: object, key: str = "") -> Iterator[tuple[str, float]]:
    """Yield every number of nested tables with its key."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _numbers(inner, f"{key}.{name}" if key else str(name))
    elif isinstance(value, list):
        for index, inner in enumerate(value, 1):
            yield from _numbers(inner, f"{key}[{index}]")
    elif isinstance(value, float):
        yield key, value
    elif isinstance(value, int):
        yield key, float(_within_64_bits(value))


def _whole_number(text: str) -> int:
    return _within_64_bits(int(text))


def _within_64_bits(number: int) -> int:
    if abs(number) > _LARGEST_INTEGER:
        raise ValueError("it holds a whole number beyond 64 bits")
    return number


def _finite_number(text: str) -> float:
    if not math.isfinite(number := float(text)):
        raise ValueError(f"it holds {text[:20]}, which is no finite number")
    return number
