"""NMEA 0183 sentences in a file: one topic for each kind of sentence."""

import math
import re
from collections import defaultdict
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.data.read.formats.text import decoded_text
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, topic_table
from seatrial.data.read.nmea_sentence import (
    Sentence,
    SentenceFault,
    on_the_clock,
    parse_sentence,
    readings,
    receipt_time,
    utc_time,
)

_DAY_S = 86400.0  # s, of a day
_RMC_DATE = 9  # field of RMC with the date, ddmmyy
# field of a reading -> unit of its SI value; the second word of a reading is its field
_UNITS = {"lat": "rad", "lon": "rad", "north": "m/s", "east": "m/s", "transverse": "m/s", "heading": "rad",
          "rate": "rad/s", "angle": "rad", "port": "rad", "speed": "m/s", "ground": "m/s"}  # fmt: skip
# sentences whose first reading is named after the sentence alone -> what it is
_SINGLE_READINGS = {"HDT": "heading", "THS": "heading", "HDM": "heading", "ROT": "rate", "RSA": "angle",
                    "VBW": "speed", "VHW": "speed"}  # fmt: skip


def read_nmea0183(path: Path, layout: Layout) -> Log:
    """Sentences with a valid checksum, by kind (``GGA/lat``, ``VTG/north``, ``HDT/heading``, ``ROT/rate``), SI.

    ``time`` is UTC in s since 1970 where a sentence (RMC, ZDA) gives the date, else since the midnight before the
    first stamp. Sentences without a time have that of their receipt where the logger wrote it, to parts of a second,
    before each; else that of the last stamp before them, several of a kind spread evenly.

    Raises:
        InputError: no sentence with a reading, or none with a time.
    """
    content = decoded_text(path, layout.encoding).encode("ascii", "replace")
    clock = _Clock()
    samples: dict[str, list[_Sample]] = defaultdict(list)
    receipts, own = list[float](), list[float]()
    faults = 0
    for line in content.splitlines():
        if not line.strip():
            continue
        sentence = parse_sentence(line)
        if isinstance(sentence, SentenceFault):
            faults += 1
            continue
        try:
            values = readings(sentence)
            stamped = clock.read(sentence)
        except ValueError:
            faults += 1
            continue
        if values and clock.stamps:
            samples[sentence.kind].append(_Sample(len(receipts), len(clock.stamps) - 1, values))
            receipts.append(receipt_time(line))
            own.append(stamped)
    if not samples:
        raise InputError(
            f"{path.name} holds no NMEA 0183 sentence with a reading and a time (GGA, RMC, ZDA, GLL); {faults} lines "
            "are damaged"
        )
    stamps, day = clock.seconds(), clock.first_day_s
    received = on_the_clock(np.array(receipts), np.array(own) + day)
    tables = []
    for kind, rows in samples.items():
        has_own = bool(np.isfinite([own[row.place] for row in rows]).any())
        if received is None or has_own:
            times = _spread(np.array([row.epoch for row in rows]), stamps)
        else:
            times = received[[row.place for row in rows]]
        tables.append(_table(path.name, kind, rows, times))
    return Log(path.name, tuple(tables))


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
        self._midnights = 0
        self._first_day: int | None = None

    def read(self, sentence: Sentence) -> float:
        """Take the stamp of a sentence, if it has one that is later than the last, and return it; NaN: it has none."""
        stamp = utc_time(sentence)
        if not math.isfinite(stamp):
            return math.nan
        if self.stamps and stamp + self._midnights * _DAY_S < self.stamps[-1] - _DAY_S / 2.0:
            self._midnights += 1
        stamp += self._midnights * _DAY_S
        if not self.stamps or stamp > self.stamps[-1]:
            self.stamps.append(stamp)
        if self._first_day is None and (day := _day_number(sentence)) is not None:
            self._first_day = day - self._midnights
        return stamp

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


def _table(file: str, kind: str, rows: list[_Sample], times: Array) -> RawTable:
    names = list(dict.fromkeys(name for row in rows for name in row.values))
    fields = {_field(name, kind): name for name in names}
    columns = {"time": times}
    for field, name in fields.items():
        columns[field] = np.array([row.values.get(name, math.nan) for row in rows])
    units = {field: "rps" if kind == "RPM" else _UNITS.get(field.rpartition(" ")[2], "") for field in fields}
    return topic_table(file, kind, columns, units)


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
