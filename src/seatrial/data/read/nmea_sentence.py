"""One NMEA 0183 sentence: its checksum, its fields, when it was received."""

import math
import re
from collections.abc import Callable
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
# m/s: a nautical mile an hour
_KNOT = 1852.0 / 3600.0
# letter of a wind's unit -> m/s: knots, metres a second, kilometres an hour, statute miles an hour
_WIND_UNITS = {"N": _KNOT, "M": 1.0, "K": 1.0 / 3.6, "S": 1609.344 / 3600.0}


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


def parse_sentence(line: bytes) -> Sentence | SentenceFault:
    """Return the sentence in a line, from its last ``$`` or ``!`` on; a checksum is required."""
    start = max(line.rfind(b"$"), line.rfind(b"!"))
    body, star, given = line[start + 1 :].strip().partition(b"*")
    if start < 0 or not star or not body.isascii():
        return SentenceFault.GARBLED
    # two hexadecimal digits
    if not re.fullmatch(rb"[0-9A-Fa-f]{2}", given) or int(given, 16) != checksum(body):
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


def _rate_of_turn(s: Sentence) -> dict[str, float]:
    return {"ROT": _if_valid(math.radians(s.number(1)) / 60.0, s.text(2))}  # deg/min


def _rudder(s: Sentence) -> dict[str, float]:
    starboard, port = math.radians(s.number(1)), math.radians(s.number(3))
    return {"RSA": _if_valid(starboard, s.text(2)), "RSA port": _if_valid(port, s.text(4))}


def _ground_course(s: Sentence) -> dict[str, float]:
    """VTG: course and speed over ground."""
    return {} if s.text(9) == "N" else _over_ground("VTG", _speed(s), s.number(1))  # field 9: "N" for not valid


def _recommended_minimum(s: Sentence) -> dict[str, float]:
    """RMC: position, speed and course over ground."""
    if s.text(2) != "A":
        return {}
    return _position(s, 3) | _over_ground("RMC", s.number(7) * _KNOT, s.number(8))  # fields 7, 8: knots, degrees


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
    return {"VHW": _speed(s), "VHW heading": math.radians(s.number(1))}


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


def _transducers(s: Sentence) -> dict[str, float]:
    """XDR: groups of type, value, unit, name; angles in degrees, displacements in metres, others left out."""
    values = {}
    for first in range(1, len(s.fields) - 2, 4):
        kind, unit, name = s.text(first), s.text(first + 2), s.text(first + 3).upper()
        if kind == "A" and unit in ("D", ""):
            values[f"XDR {name}"] = math.radians(s.number(first + 1))
        elif kind == "D" and unit in ("M", ""):
            values[f"XDR {name}"] = s.number(first + 1)
    return values


def _if_valid(value: float, status: str) -> float:
    return value if status == "A" else math.nan


# sentence -> number of the field with its time
_TIME_FIELDS = {"RMC": 1, "GGA": 1, "GNS": 1, "ZDA": 1, "GLL": 5}
# sentence -> its reader; numbers of the fields of a position and of its validity
_READERS: dict[str, Callable[[Sentence], dict[str, float]]] = {
    "HDT": _heading, "THS": _heading, "HDM": _heading, "ROT": _rate_of_turn, "RSA": _rudder, "VTG": _ground_course,
    "RMC": _recommended_minimum, "GGA": lambda s: _fix(s, 2, is_valid=s.text(6) not in ("", "0")),
    "GNS": lambda s: _fix(s, 2, is_valid=s.text(6).strip("N") != ""),
    "GLL": lambda s: _fix(s, 1, is_valid=s.text(6) != "V"), "VHW": _through_water, "VBW": _dual_speed,
    "RPM": _revolutions, "XDR": _transducers, "MWV": _wind,
}  # fmt: skip


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
