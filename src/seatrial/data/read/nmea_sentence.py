"""NMEA 0183 sentences, of a file or a stream: checksums, fields, the clock, when each was received."""

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum
from functools import reduce
from operator import xor

import numpy as np

from seatrial.core.values import Array

# One NMEA 0183 sentence: its checksum, its fields, and those that a ship model can use.

# address of a talker or a maker; number; hhmmss.ss; dddmm.mm
_ADDRESS = re.compile(r"P[A-Z0-9]{2,}|[A-Z0-9]{5}")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)")
_TIME = re.compile(r"(\d\d)(\d\d)(\d\d(?:\.\d*)?)")
_ANGLE = re.compile(r"(\d{1,3})(\d\d(?:\.\d*)?)")
# m/s: a nautical mile an hour; m: a foot
_KNOT, _FOOT = 1852.0 / 3600.0, 0.3048
# letter of a wind's unit -> m/s: knots, metres a second, kilometres an hour, statute miles an hour
_WIND_UNITS = {"N": _KNOT, "M": 1.0, "K": 1.0 / 3.6, "S": 1609.344 / 3600.0}


# two hexadecimal digits behind the star of a sentence, and whatever a table holds behind them
_BODY = re.compile(rb"([^*\r\n\"]*)(?:\*(?:([0-9A-Fa-f]{2})(?![0-9A-Za-z]))?)?")


class SentenceFault(StrEnum):
    """Why a line is not a sentence."""

    GARBLED = "garbled"
    CHECKSUM = "checksum"


@dataclass(frozen=True)
class Sentence:
    """kind: the three letters after the talker, or the whole address of a proprietary one; fields: from the first."""

    kind: str
    fields: tuple[str, ...]

    def text(self, index: int) -> str:
        """Return field `index`, counted from 1; empty where the sentence is shorter."""
        return self.fields[index - 1].strip() if index <= len(self.fields) else ""

    def number(self, index: int) -> float:
        """Return field `index` as a number; NaN where it is empty.

        Raises:
            ValueError: it is something else.
        """
        text = self.text(index)
        if not text:
            return math.nan
        if not _NUMBER.fullmatch(text):
            raise ValueError(f"{self.kind}: field {index} is not a number")
        return float(text)


def parse_sentence(line: bytes, *, is_checked: bool = True) -> Sentence | SentenceFault:
    """Return the sentence in a line, from its last ``$`` or ``!`` on.

    is_checked: whether a checksum is required; else a sentence without one is taken as it stands.
    """
    start = max(line.rfind(b"$"), line.rfind(b"!"))
    match = _BODY.match(line, start + 1)
    if start < 0 or match is None or not match[1].isascii():
        return SentenceFault.GARBLED
    body, given, has_star = match[1].rstrip(), match[2], b"*" in match[0]
    if given is None and (has_star or is_checked):
        return SentenceFault.CHECKSUM if has_star else SentenceFault.GARBLED
    if given is not None and int(given, 16) != checksum(match[1]):  # base of its two digits
        return SentenceFault.CHECKSUM
    address, *fields = body.decode("ascii").split(",")
    if not _ADDRESS.fullmatch(address):
        return SentenceFault.GARBLED
    return Sentence(address if address.startswith("P") else address[2:], tuple(fields))


def checksum(body: bytes) -> int:
    """Return the exclusive or of the bytes between ``$`` and ``*``."""
    return reduce(xor, body, 0)


def utc_time(sentence: Sentence) -> float:
    """Return the UTC of the sentence in s since midnight; NaN where it has none.

    Raises:
        ValueError: the field is not a time.
    """
    field = _TIME_FIELDS.get(sentence.kind)
    text = sentence.text(field) if field else ""
    if not text:
        return math.nan
    match = _TIME.fullmatch(text)
    if not match:
        raise ValueError(f"{sentence.kind}: '{text}' is not a time")
    hours, minutes, seconds = int(match[1]), int(match[2]), float(match[3])
    if hours > 23 or minutes > 59 or seconds >= 61.0:  # of a day, of an hour, of a minute with a leap second
        raise ValueError(f"{sentence.kind}: '{text}' is not a time")
    return 3600.0 * hours + 60.0 * minutes + seconds  # s of an hour, of a minute


def readings(sentence: Sentence) -> dict[str, float]:
    """Return field -> value in SI (angles, latitude and longitude in rad, north and east positive); NaN where empty.

    Raises:
        ValueError: a field is not a number, a time or an angle as it should be.
    """
    reader = _READERS.get(sentence.kind)
    return reader(sentence) if reader else {}


def _heading(s: Sentence) -> dict[str, float]:
    valid = s.kind != "THS" or s.text(2) != "V"
    return {s.kind: math.radians(s.number(1)) if valid else math.nan}


def _compass(s: Sentence) -> dict[str, float]:
    """HDG: magnetic heading of a sensor, its deviation, and the variation of the place."""
    deviation = _to_side(s, 2, "EW")
    magnetic = math.radians(s.number(1)) + (0.0 if math.isnan(deviation) else deviation)
    return {"HDG magnetic": magnetic, "HDG variation": _to_side(s, 4, "EW")}


def _to_side(s: Sentence, index: int, sides: str) -> float:
    """An angle in degrees and its side in the field behind, in rad, positive to the first one."""
    angle, side = math.radians(s.number(index)), s.text(index + 1)
    return angle if side == sides[0] else -angle if side == sides[1] else math.nan


def _rate_of_turn(s: Sentence) -> dict[str, float]:
    return {"ROT": _if_valid(math.radians(s.number(1)) / 60.0, s.text(2))}  # deg/min


def _rudder(s: Sentence) -> dict[str, float]:
    starboard, port = math.radians(s.number(1)), math.radians(s.number(3))
    return {"RSA": _if_valid(starboard, s.text(2)), "RSA port": _if_valid(port, s.text(4))}


def _ground_course(s: Sentence) -> dict[str, float]:
    """VTG: course and speed over ground."""
    return {} if s.text(9) == "N" else _over_ground("VTG", _speed(s), s.number(1))  # field 9: "N" for not valid


def _recommended_minimum(s: Sentence) -> dict[str, float]:
    """RMC: position, speed and course over ground, variation of the place."""
    if s.text(2) != "A":
        return {}
    motion = _over_ground("RMC", s.number(7) * _KNOT, s.number(8))  # fields 7, 8: knots, degrees
    return _position(s, 3) | motion | {"RMC variation": _to_side(s, 10, "EW")}


def _over_ground(kind: str, speed: float, course: float) -> dict[str, float]:
    if math.isnan(course):
        return {}
    angle = math.radians(course)
    parts = {"north": speed * math.cos(angle), "east": speed * math.sin(angle), "speed": speed, "course": angle}
    return {f"{kind} {name}": value for name, value in parts.items()}


def _fix(s: Sentence, first: int, *, is_valid: bool) -> dict[str, float]:
    """Return the position from field `first` on; nothing where the receiver says that there is no fix."""
    return _position(s, first) if is_valid else {}


def _position(s: Sentence, first: int) -> dict[str, float]:
    latitude = _angle(s.text(first), s.text(first + 1), "NS", 90.0)
    longitude = _angle(s.text(first + 2), s.text(first + 3), "EW", 180.0)
    return {f"{s.kind} lat": latitude, f"{s.kind} lon": longitude}


def _angle(text: str, side: str, sides: str, limit: float) -> float:
    """Degrees and minutes (dddmm.mm) with their hemisphere, in rad."""
    if not text:
        return math.nan
    match = _ANGLE.fullmatch(text)
    degrees = int(match[1]) + float(match[2]) / 60.0 if match else math.inf  # minutes of a degree
    if degrees > limit or side not in tuple(sides):
        raise ValueError(f"'{text},{side}' is not a latitude or longitude")
    return math.radians(degrees if side == sides[0] else -degrees)


def _through_water(s: Sentence) -> dict[str, float]:
    return {
        "VHW": _speed(s), "VHW heading": math.radians(s.number(1)), "VHW magnetic": math.radians(s.number(3))
    }  # fmt: skip


def _own_ship(s: Sentence) -> dict[str, float]:
    """OSD: heading, and the speed where it is of a log."""
    factor = _WIND_UNITS.get(s.text(9), math.nan)  # field 9: unit
    speed = s.number(5) * factor if s.text(6) == "W" else math.nan  # fields 5, 6: speed, of what
    return {"OSD heading": _if_valid(math.radians(s.number(1)), s.text(2)), "OSD speed": speed}


def _attitude(s: Sentence) -> dict[str, float]:
    """PASHR: true heading, roll, pitch [deg] and heave [m]."""
    if s.text(3) != "T":
        return {}
    angles = {"heading": 2, "roll": 4, "pitch": 5}  # field numbers
    values = {f"PASHR {name}": math.radians(s.number(field)) for name, field in angles.items()}
    return values | {"PASHR heave": s.number(6)}  # field number


def _depth(s: Sentence) -> dict[str, float]:
    """DPT: depth below the transducer [m]; DBT, DBS, DBK: in metres (field 3), or else feet (field 1)."""
    metres = s.number(1) if s.kind == "DPT" else s.number(3) if s.text(3) else s.number(1) * _FOOT
    return {f"{s.kind} depth": metres}


def _speed(s: Sentence) -> float:
    """Return the speed of VTG and VHW: knots in field 5, or else km/h in field 7."""
    return s.number(5) * _KNOT if s.text(5) else s.number(7) / 3.6  # field numbers; km/h of a m/s


def _dual_speed(s: Sentence) -> dict[str, float]:
    water, ground = s.text(3), s.text(6)  # field numbers of the two states
    # field numbers: longitudinal, transverse
    return {
        "VBW": _if_valid(s.number(1) * _KNOT, water),
        "VBW transverse": _if_valid(s.number(2) * _KNOT, water),
        "VBW ground": _if_valid(s.number(4) * _KNOT, ground),
        "VBW ground transverse": _if_valid(s.number(5) * _KNOT, ground),
    }


def _revolutions(s: Sentence) -> dict[str, float]:
    return {f"RPM {s.text(1)}{s.text(2)}": _if_valid(s.number(3) / 60.0, s.text(5))}  # fields 3, 5: rev/min, validity


def _wind(s: Sentence) -> dict[str, float]:
    """MWV: angle off the bow and speed of the apparent wind (R), or of the true one with an angle off the bow (T)."""
    kind = {"R": "MWV", "T": "MWV true"}.get(s.text(2))
    factor = _WIND_UNITS.get(s.text(4), math.nan)
    if kind is None or s.text(5) != "A":  # field 5: validity
        return {}
    return {f"{kind} angle": math.radians(s.number(1)), f"{kind} speed": s.number(3) * factor}


def _wind_over_ground(s: Sentence) -> dict[str, float]:
    """MWD: direction from which the wind comes and its speed, in knots (field 5) or else m/s (field 7)."""
    speed = s.number(5) * _KNOT if s.text(5) else s.number(7)  # field numbers
    return {"MWD direction": math.radians(s.number(1)), "MWD speed": speed}


def _wind_to_a_side(s: Sentence) -> dict[str, float]:
    """VWR, VWT: angle of the wind off the bow to a side, and its speed in knots (field 3) or else m/s (field 5)."""
    speed = s.number(3) * _KNOT if s.text(3) else s.number(5)  # field numbers
    return {f"{s.kind} angle": _to_side(s, 1, "RL"), f"{s.kind} speed": speed}


def _transducers(s: Sentence) -> dict[str, float]:
    """XDR: groups of type, value, unit, name; those of `_TRANSDUCERS` in SI, others left out."""
    values = {}
    for first in range(1, len(s.fields) - 2, 4):
        kind, unit, name = s.text(first), s.text(first + 2), s.text(first + 3).upper()
        if kind in _TRANSDUCERS and unit in (_TRANSDUCERS[kind][0], ""):
            values[f"XDR {name}"] = s.number(first + 1) * _TRANSDUCERS[kind][1]
    return values


_RPM = 1.0 / 60.0  # rps, of a turn a minute
# type of a transducer -> letter of its unit, factor to SI, SI unit: angles, displacements, tachometers (NMEA 0183)
_TRANSDUCERS = {"A": ("D", math.radians(1.0), "rad"), "D": ("M", 1.0, "m"), "T": ("R", _RPM, "rps")}
# last word of a reading's name -> its SI unit
_UNITS = {
    **dict.fromkeys(("speed", "north", "east", "transverse", "ground", "VHW", "VBW"), "m/s"),
    **dict.fromkeys(("depth", "heave"), "m"), "ROT": "rad/s",
    **dict.fromkeys(
        ("lat", "lon", "course", "heading", "true", "magnetic", "variation", "angle", "direction", "roll", "pitch",
         "port", "HDT", "THS", "HDM", "RSA"), "rad"
    ),
}  # fmt: skip


def reading_units(sentence: Sentence, names: Iterable[str]) -> dict[str, str]:
    """Return the SI units of readings of a sentence, by their names; of a transducer by its type."""
    if sentence.kind == "XDR":
        groups = range(1, len(sentence.fields) - 2, 4)
        types = {f"XDR {sentence.text(first + 3).upper()}": sentence.text(first) for first in groups}
        return {name: _TRANSDUCERS[types[name]][2] for name in names}
    return {name: "rps" if sentence.kind == "RPM" else unit_of(name) for name in names}


def unit_of(name: str) -> str:
    """Return the SI unit of a reading by its name; empty where there is none of that name."""
    return _UNITS.get(name.rpartition(" ")[2], "")


def _if_valid(value: float, status: str) -> float:
    return value if status == "A" else math.nan


# sentence -> number of the field with its time
_TIME_FIELDS = {"PASHR": 1, "RMC": 1, "GGA": 1, "GNS": 1, "ZDA": 1, "GLL": 5}
# sentence -> its reader; numbers of the fields of a position and of its validity
_READERS: dict[str, Callable[[Sentence], dict[str, float]]] = {
    "HDT": _heading, "THS": _heading, "HDM": _heading, "HDG": _compass, "OSD": _own_ship, "PASHR": _attitude,
    **dict.fromkeys(("DPT", "DBT", "DBS", "DBK"), _depth), "MWD": _wind_over_ground,
    "VWR": _wind_to_a_side, "VWT": _wind_to_a_side, "ROT": _rate_of_turn, "RSA": _rudder, "VTG": _ground_course,
    "RMC": _recommended_minimum, "GGA": lambda s: _fix(s, 2, is_valid=s.text(6) not in ("", "0")),
    "GNS": lambda s: _fix(s, 2, is_valid=s.text(6).strip("N") != ""),
    "GLL": lambda s: _fix(s, 1, is_valid=s.text(6) != "V"), "VHW": _through_water, "VBW": _dual_speed,
    "RPM": _revolutions, "XDR": _transducers, "MWV": _wind,
}  # fmt: skip
READ = frozenset(_READERS)
"""Kinds of sentences with readings."""


# The sentences of a file or a stream, one line after the other.

_DAY_S = 86400.0  # s, of a day
# readings of a compass that the last variation known makes true
_MAGNETIC = {"HDM": "HDM true", "HDG magnetic": "HDG true", "VHW magnetic": "VHW heading"}


@dataclass(frozen=True)
class Received:
    """A sentence with its readings, and its stamp [s since the midnight before the first one]; NaN: it has none."""

    sentence: Sentence
    values: dict[str, float]
    stamp: float


class SentenceReader:
    """Reads lines one after the other: midnights are passed, late sentences stay late, magnetic headings become true.

    A checksum is required from the first right one on; before it sentences without are taken as they stand.

    Attributes:
        faults: lines that are no sentence, by their fault.
        unread: sentences without readings and without a time, by their kind.
        unchecked: sentences without a checksum that were taken.
        problem: the last fault, with the beginning of its line; empty: none.
    """

    def __init__(self, *, is_checked: bool = False) -> None:
        self._is_checked = is_checked
        self.faults, self.unread = Counter[SentenceFault](), Counter[str]()
        self.unchecked = 0
        self.problem = ""
        self._variation = self._last_stamp = math.nan

    def read(self, line: bytes) -> Received | None:
        """Return what a line holds; None for a fault, which is counted."""
        sentence = parse_sentence(line, is_checked=self._is_checked)
        if isinstance(sentence, SentenceFault):
            self._count(sentence, line)
            return None
        has_checksum = b"*" in line
        try:
            values, time_of_day = readings(sentence), utc_time(sentence)
        except ValueError:
            self._count(SentenceFault.GARBLED, line)
            return None
        self._is_checked |= has_checksum
        self.unchecked += not has_checksum
        self.unread[sentence.kind] += sentence.kind not in READ and sentence.kind not in _TIME_FIELDS
        self._make_true(values)
        return Received(sentence, values, self._continued(time_of_day))

    def _continued(self, time_of_day: float) -> float:
        """The stamp on the day that brings it nearest to the last."""
        if math.isnan(time_of_day):
            return math.nan
        if not math.isnan(self._last_stamp):
            time_of_day += _DAY_S * round((self._last_stamp - time_of_day) / _DAY_S)
        self._last_stamp = time_of_day
        return time_of_day

    def _make_true(self, values: dict[str, float]) -> None:
        variation = next((values[name] for name in ("RMC variation", "HDG variation") if name in values), math.nan)
        self._variation = self._variation if math.isnan(variation) else variation
        if math.isnan(self._variation):
            return
        for magnetic, true in _MAGNETIC.items():
            if magnetic in values and math.isnan(values.get(true, math.nan)):
                values[true] = values[magnetic] + self._variation

    def _count(self, fault: SentenceFault, line: bytes) -> None:
        self.faults[fault] += 1
        what = "wrong checksum" if fault is SentenceFault.CHECKSUM else "not a sentence"
        self.problem = f"{what}: {repr(line[:40])[1:]}"


# When a logger received each sentence, as it wrote before it: for those that have no time of their own.

# date and time with parts of a second; seconds or milliseconds since 1970
_ISO = re.compile(rb"(\d{4}-\d\d-\d\d)[T ](\d\d:\d\d:\d\d[.,]\d{1,6})")
_UNIX = re.compile(rb"(?<!\d)(1\d{9}\.\d{1,9})(?!\d)")
_UNIX_MS = re.compile(rb"(?<!\d)(1\d{12})(?!\d)")
_MS = 1e-3  # s, of a millisecond
_LEAST_SHARE = 0.99  # of the sentences that have a receipt, from which on it is used; chosen


def receipt_time(line: bytes) -> float:
    """Return the time before the ``$`` of a line [s since 1970, zone left out]; NaN without one to parts of a s."""
    head = line[: max(line.rfind(b"$"), line.rfind(b"!"), 0)]
    if match := _ISO.search(head):
        text = b"T".join(match.groups()).replace(b",", b".").decode()
        return datetime.fromisoformat(text).replace(tzinfo=UTC).timestamp()
    if match := _UNIX.search(head):
        return float(match[1])
    return _MS * int(match[1]) if (match := _UNIX_MS.search(head)) else math.nan


def on_the_clock(receipts: Array, stamps: Array) -> Array | None:
    """Return the times of sentences by their receipt, moved to the clock of those that have a time of their own.

    Args:
        receipts: (n,) s, NaN where there is none; stamps: (n,) s, of sentences with a time of their own, NaN else.

    The logger's clock and the delay of the line are the median difference. None: too few receipts, or they run back.
    """
    differences = receipts - stamps
    if np.mean(np.isfinite(receipts)) < _LEAST_SHARE or not np.isfinite(differences).any():
        return None
    rows = np.arange(len(receipts))
    known = np.isfinite(receipts)
    times = np.interp(rows, rows[known], receipts[known]) - float(np.nanmedian(differences))
    return None if np.any(np.diff(times) < 0.0) else times
