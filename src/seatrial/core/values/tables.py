"""Tables of TOML and JSON files: read within a size, parsed within a depth, whole numbers within 64 bits."""

import json
import math
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from seatrial.core.values.errors import InputError

# bytes of a file of tables, at most: 64 times the largest that the package writes; chosen
_LARGEST_FILE = 2**28
# sizes of a number of a trial or loop file, unless it is 0 or infinite, in any unit: 1e30 N m exceeds what the heaviest
# ship can meet by 1e16, and its tenth power is still a float64; ours
_SMALLEST_NUMBER, _LARGEST_NUMBER = 1e-30, 1e30
# whole numbers that TOML promises (toml.io, v1.0.0, "Integer"), and that any program reads as numbers
_LARGEST_INTEGER = 2**63


def read_bounded(path: Path, limit: int = _LARGEST_FILE) -> bytes:
    """Return the bytes of a file.

    Raises:
        OSError: it cannot be read.
        ValueError: it holds more than `limit` bytes; no more than these are read.
    """
    with path.open("rb") as file:
        size = file.seek(0, 2) if file.seekable() else 0
        file.seek(0) if size else None
        content = file.read(limit + 1) if size <= limit else b""
    if max(size, len(content)) > limit:
        raise ValueError(f"it is larger than {limit >> 20} MiB, which no such file is")
    return content


def read_table_text(path: Path) -> str:
    """Return the text of a file of tables; errors as `read_bounded`.

    Raises:
        ValueError: it is not UTF-8 text.
    """
    try:
        return read_bounded(path).decode()
    except UnicodeDecodeError:
        raise ValueError("it is not UTF-8 text") from None


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
        ValueError: no JSON, nested too deep, NaN, infinity, or a whole number beyond 64 bits; the text says which.
    """
    try:
        return json.loads(text, parse_int=_whole_number, parse_float=_finite_number, parse_constant=_finite_number)
    except RecursionError:
        raise ValueError("its tables are nested too deep") from None


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
