"""Signal K logs: a delta in JSON on each line, also behind the time and the letter that a server writes before it."""

import json
import math
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from seatrial.core.values import InputError
from seatrial.data.read.formats.text import decoded_text
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, topic_table

_MS = 1e-3  # s, of a millisecond
_STAMPED = re.compile(r"(\d{13})\D")  # ms since 1970 with which a server begins a line
# last name of a path -> its unit (Signal K specification 1.7, keys reference): SI, degrees for places alone
_UNITS = (
    (re.compile("rate", re.IGNORECASE), "rad/s"),
    (re.compile("speed|velocity", re.IGNORECASE), "m/s"),
    (re.compile("latitude|longitude", re.IGNORECASE), "deg"),
    (re.compile("heading|course|angle|roll|pitch|yaw|variation|direction", re.IGNORECASE), "rad"),
    (re.compile("revolutions", re.IGNORECASE), "rps"),
    (re.compile("below|depth|heave", re.IGNORECASE), "m"),
)

_Readings = dict[tuple[str, str], list[tuple[float, dict[str, float]]]]  # path and source -> stamps [s] with values


def read_signalk(path: Path, layout: Layout) -> Log:
    """Every path as a topic, ``navigation.position`` with its fields, others with the path's end as the only field.

    Paths that several sources send have one topic for each, ``navigation.headingTrue@gps.1``.

    Raises:
        InputError: no line holds a delta with numbers and a time.
    """
    readings: _Readings = defaultdict(list)
    undeciphered = 0
    for line in filter(None, map(str.strip, decoded_text(path, layout.encoding).split("\n"))):
        start = line.find("{")
        try:
            delta = json.loads(line[start:]) if start >= 0 else None
            for key, stamp, values in _values_of(delta, line) if isinstance(delta, dict) else ():
                readings[key].append((stamp, values))
        except (ValueError, TypeError, AttributeError, RecursionError):
            delta = None
        undeciphered += not isinstance(delta, dict)
    if not readings:
        raise InputError(f"{path.name} holds no Signal K delta with numbers and a time; check the format")
    notes = (f"{undeciphered} lines hold no Signal K delta and are not read",) if undeciphered else ()
    return Log(path.name, tuple(_tables(path.name, readings)), notes=notes)


def _values_of(delta: Mapping[str, Any], line: str) -> Iterator[tuple[tuple[str, str], float, dict[str, float]]]:
    """The path and source, stamp [s since 1970] and numbers of each value of a delta."""
    for update in delta.get("updates", ()):
        stamp = _stamp(update, line)
        source = update.get("$source") or (update.get("source") or {}).get("label", "")
        for entry in update.get("values", ()) if math.isfinite(stamp) else ():
            place, value = str(entry["path"]), entry["value"]
            fields = value if isinstance(value, dict) else {place.partition(".")[2] or place: value}
            numbers = {name: float(x) for name, x in fields.items() if isinstance(x, int | float)}
            if numbers:
                yield (place, str(source)), stamp, numbers


def _stamp(update: Mapping[str, Any], line: str) -> float:
    if text := update.get("timestamp"):
        moment = datetime.fromisoformat(text)
        return moment.replace(tzinfo=moment.tzinfo or UTC).timestamp()
    match = _STAMPED.match(line)
    return _MS * int(match[1]) if match else math.nan


def _tables(file: str, readings: _Readings) -> Iterator[RawTable]:
    places = [place for place, _ in readings]
    for (place, source), samples in readings.items():
        samples.sort(key=lambda sample: sample[0])
        names = list(dict.fromkeys(name for _, values in samples for name in values))
        columns = {"time": [stamp for stamp, _ in samples]}
        columns |= {name: [values.get(name, math.nan) for _, values in samples] for name in names}
        topic = f"{place}@{source}" if places.count(place) > 1 else place
        yield topic_table(file, topic, columns, {name: _unit(name) for name in names})


def _unit(name: str) -> str:
    end = name.rpartition(".")[2]
    return next((unit for pattern, unit in _UNITS if pattern.search(end)), "")
