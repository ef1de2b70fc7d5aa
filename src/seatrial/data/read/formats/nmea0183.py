"""NMEA 0183 sentences in a file: one topic for each kind of sentence."""

import math
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.data.read.formats.text import decoded_text
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, topic_table
from seatrial.data.read.nmea_sentence import (
    Received,
    Sentence,
    SentenceFault,
    SentenceReader,
    on_the_clock,
    reading_units,
    receipt_time,
)

_DAY_S = 86400.0  # s, of a day
_RMC_DATE = 9  # field of RMC with the date, ddmmyy
# sentences whose first reading is named after the sentence alone -> what it is
_SINGLE_READINGS = {"HDT": "heading", "THS": "heading", "HDM": "heading", "ROT": "rate", "RSA": "angle",
                    "VBW": "speed", "VHW": "speed"}  # fmt: skip
_HAS_CHECKSUM = re.compile(rb"[$!][A-Z0-9]+,[^\n*]*\*[0-9A-Fa-f]{2}\b")
_KINDS_NAMED = 6  # kinds of sentences that a note names, the most frequent first; chosen: a line of them


def read_nmea0183(path: Path, layout: Layout) -> Log:
    """Sentences by kind (``GGA/lat``, ``VTG/north``, ``HDT/heading``, ``ROT/rate``), SI.

    A checksum is required where any sentence has one. Headings of a compass become true by the last variation known.

    ``time`` is UTC in s since 1970 where a sentence (RMC, ZDA) gives the date, else since the midnight before the
    first stamp. Sentences without a time have that of their receipt where the logger wrote it, to parts of a second,
    before each; else that of the last stamp before them, several of a kind spread evenly.

    Raises:
        InputError: no sentence with a reading, or none with a time.
    """
    content = decoded_text(path, layout.encoding).encode("ascii", "replace")
    reader = SentenceReader(is_checked=_HAS_CHECKSUM.search(content) is not None)
    clock = _Clock()
    samples: dict[str, list[_Sample]] = defaultdict(list)
    units = dict[str, str]()
    receipts, own = list[float](), list[float]()
    for line in filter(None, map(bytes.strip, content.splitlines())):
        received = reader.read(line)
        if received is None:
            continue
        clock.take(received)
        if received.values and clock.stamps:
            kind = received.sentence.kind
            samples[kind].append(_Sample(len(receipts), len(clock.stamps) - 1, received.values))
            units |= reading_units(received.sentence, received.values.keys() - units.keys())
            receipts.append(receipt_time(line))
            own.append(received.stamp)
    if not samples:
        raise InputError(
            f"{path.name} holds no NMEA 0183 sentence with a reading and a time (GGA, RMC, ZDA, GLL); "
            f"{sum(reader.faults.values())} lines are damaged"
        )
    stamps, day = clock.seconds(), clock.first_day_s
    arrivals = on_the_clock(np.array(receipts), np.array(own) + day)
    tables = []
    for kind, rows in samples.items():
        has_own = bool(np.isfinite([own[row.place] for row in rows]).any())
        if arrivals is None or has_own:
            times = _spread(np.array([row.epoch for row in rows]), stamps)
        else:
            times = arrivals[[row.place for row in rows]]
        tables.append(_table(path.name, kind, rows, times, units))
    return Log(path.name, tuple(tables), notes=tuple(_notes(reader)))


def _notes(reader: SentenceReader) -> Iterator[str]:
    """What is to be known of the sentences: faults, missing checksums, kinds that are not read."""
    if reader.unchecked:
        yield f"{reader.unchecked} sentences have no checksum and are taken as they stand"
    faults = [f"{count} {_FAULTS[fault]}" for fault, count in reader.faults.items()]
    if faults:
        yield f"left out: {', '.join(faults)}, the last one: {reader.problem}"
    kinds = [f"{kind} ({count})" for kind, count in reader.unread.most_common() if count]
    if kinds:
        more = f" and {len(kinds) - _KINDS_NAMED} kinds more" if len(kinds) > _KINDS_NAMED else ""
        yield f"sentences that are not read: {', '.join(kinds[:_KINDS_NAMED])}{more}"


_FAULTS = {
    SentenceFault.GARBLED: "lines that are no sentence",
    SentenceFault.CHECKSUM: "sentences with a wrong checksum",
}


@dataclass(frozen=True)
class _Sample:
    """Readings of one sentence, its place among all and the number of its epoch."""

    place: int
    epoch: int
    values: dict[str, float]


class _Clock:
    """The time stamps of a file, one for each epoch, midnights passed."""

    def __init__(self) -> None:
        self.stamps: list[float] = []
        self._first_day: int | None = None

    def take(self, received: Received) -> None:
        """Take the stamp of a sentence, if it has one that is later than the last, and its date."""
        if not math.isfinite(received.stamp):
            return
        if not self.stamps or received.stamp > self.stamps[-1]:
            self.stamps.append(received.stamp)
        if self._first_day is None and (day := _day_number(received.sentence)) is not None:
            self._first_day = day - math.floor(received.stamp / _DAY_S)

    @property
    def first_day_s(self) -> float:
        """The midnight before the first stamp [s since 1970], 0 where no sentence gives the date."""
        return (self._first_day or 0) * _DAY_S

    def seconds(self) -> Array:
        """Return the stamps [s]."""
        return np.array(self.stamps) + self.first_day_s


def _day_number(sentence: Sentence) -> int | None:
    """Days from 1970-01-01 to the date of the sentence; None where it has none."""
    try:
        if sentence.kind == "RMC" and re.fullmatch(r"\d{6}", text := sentence.text(_RMC_DATE)):
            century = 2000  # RMC has two digits of the year; receivers of the last century are not read
            day = date(century + int(text[4:]), int(text[2:4]), int(text[:2]))
        elif sentence.kind == "ZDA" and sentence.text(4):
            day = date(int(sentence.text(4)), int(sentence.text(3)), int(sentence.text(2)))
        else:
            return None
    except ValueError:
        return None
    return day.toordinal() - date(1970, 1, 1).toordinal()  # days since the Unix epoch


def _table(file: str, kind: str, rows: list[_Sample], times: Array, units: Mapping[str, str]) -> RawTable:
    names = dict.fromkeys(name for row in rows for name in row.values)
    values = {name: np.array([row.values.get(name, math.nan) for row in rows]) for name in names}
    if kind == "RSA" and not np.isfinite(values["RSA"]).any():  # a single rudder in the field of the port one
        values = {"RSA": values["RSA port"]}
    fields = {_field(name, kind): name for name in values}
    columns = {"time": times} | {field: values[name] for field, name in fields.items()}
    return topic_table(file, kind, columns, {field: units[name] for field, name in fields.items()})


def _field(name: str, kind: str) -> str:
    """The field of a reading: ``GGA lat`` -> lat, ``HDT`` -> heading."""
    return _SINGLE_READINGS.get(kind, name) if name == kind else name.partition(" ")[2] or name


def _spread(epochs: np.ndarray, stamps: Array) -> Array:
    """Times of readings of one kind: the stamp of their epoch; of several in one epoch, evenly up to the next."""
    first = np.searchsorted(epochs, epochs, side="left")
    last = np.searchsorted(epochs, epochs, side="right")
    following = stamps[np.minimum(epochs + 1, len(stamps) - 1)]
    share = (np.arange(len(epochs)) - first) / (last - first)
    return stamps[epochs] + share * np.maximum(following - stamps[epochs], 0.0)
