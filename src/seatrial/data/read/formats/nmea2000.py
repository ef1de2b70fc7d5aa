"""NMEA 2000 logs: canboat's text, candump, Actisense text; by nmea2000 from the extra `logs`."""

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC
from pathlib import Path
from typing import Any

from seatrial.core.values import InputError
from seatrial.data.read.formats.text import decoded_text
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, require_library, topic_table

_LEFT_OUT = ("sid", "instance")
_Key = tuple[str, int, str]


def read_nmea2000(path: Path, layout: Layout) -> Log:
    """Every message (PGN) as a topic by canboat's name, ``rateOfTurn@27`` where several sources send it.

    A candump without time stamps has no column ``time``. Messages with a reference (true or magnetic) have one topic
    for each: ``vesselHeading:Magnetic``.

    Raises:
        InputError: nmea2000 is not installed, or no line is a message.
    """
    library = require_library("nmea2000", path.name, "an NMEA 2000 log", "logs")
    decoder = library.NMEA2000Decoder()
    rows: dict[_Key, list[tuple[float, dict[str, float]]]] = defaultdict(list)
    units: dict[str, str] = {}
    for line in decoded_text(path, layout.encoding).splitlines():
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        message = decoded_message(decoder, text)
        if message is not None:
            rows[message.name, message.source, message.reference].append((message.time, message.values))
            units |= message.units
    if not rows:
        raise InputError(f"{path.name} holds no NMEA 2000 message that can be decoded; check the format")
    return Log(path.name, tuple(_tables(path.name, rows, units)))


@dataclass(frozen=True)
class BusMessage:
    """A message of the bus: canboat's name, who sent it, what it is measured against, stamp [s], numbers with units."""

    name: str
    source: int
    reference: str
    time: float
    values: dict[str, float]
    units: dict[str, str]


def decoded_message(decoder: Any, text: str) -> BusMessage | None:
    """Return the message of a line; None where it is none, a part of one, or holds no number. time: NaN without."""
    try:
        message = decoder.decode(text)
    except Exception:
        return None
    if message is None:
        return None
    stamp = message.timestamp.replace(tzinfo=message.timestamp.tzinfo or UTC)
    numbers = [field for field in message.fields if _is_number(field)]
    values = {field.id: float(field.value) for field in numbers}
    units = {field.id: field.unit_of_measurement or "" for field in numbers}
    reference = next((str(field.value) for field in reversed(message.fields) if _is_reference(field)), "")
    time = stamp.timestamp() if _has_stamp(text) else math.nan
    return BusMessage(message.id, message.source, reference, time, values, units) if values else None


def _is_number(field: Any) -> bool:
    is_value = isinstance(field.value, int | float) and not isinstance(field.value, bool)
    return is_value and not _is_reference(field) and field.id not in _LEFT_OUT and not field.id.startswith("reserved")


def _is_reference(field: Any) -> bool:
    """Whether a field says what a message is measured against or which instance sent it, and does say so."""
    return field.id.lower().endswith(("reference", "instance")) and field.value is not None


def _has_stamp(line: str) -> bool:
    return not line.startswith("<") and not line.startswith("can")


def _tables(file: str, rows: dict[_Key, list], units: dict[str, str]) -> Iterator[RawTable]:
    sources: dict[tuple[str, str], int] = defaultdict(int)
    references: dict[str, set[str]] = defaultdict(set)
    for identity, _, reference in rows:
        sources[identity, reference] += 1
        references[identity].add(reference)
    for (identity, source, reference), samples in rows.items():
        names = list(dict.fromkeys(name for _, values in samples for name in values))
        stamps = [time for time, _ in samples]
        columns = {} if math.isnan(stamps[0]) else {"time": stamps}
        columns |= {name: [values.get(name, math.nan) for _, values in samples] for name in names}
        topic = identity
        if reference:
            topic += f":{reference}"
        if sources[identity, reference] > 1:
            topic += f"@{source}"
        yield topic_table(file, topic, columns, {name: units[name] for name in names})
