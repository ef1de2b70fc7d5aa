"""Messages of an NMEA 2000 bus as text, and of MAVLink, as numbers by topic and field."""

import math
from dataclasses import dataclass

from seatrial.data.read.formats.nmea2000 import decoded_message
from seatrial.data.read.log import require_library

_STREAM = "the stream"
_DEGREE, _TENTH_MICRODEGREE = math.pi / 180.0, math.pi / 180.0 * 1e-7  # rad; MAVLink: 1e-7 deg as integers
_MILLI, _MICRO = 1e-3, 1e-6  # s, of MAVLink's clocks


@dataclass(frozen=True)
class StreamMessage:
    """A message: its names (with and without the sender), stamp [s] or NaN, and numbers; positions in rad."""

    topics: tuple[str, ...]
    time: float
    values: dict[str, float]


class BusDecoder:
    """NMEA 2000 by canboat's names: text of canboat, candump, Actisense or a gateway, one message or frame a line.

    Besides the fields as the bus states them: ``north`` and ``east`` [m/s] of a course and speed over ground.

    Raises:
        InputError: nmea2000 (extra `logs`) is not installed.
    """

    def __init__(self) -> None:
        self._decoder = require_library("nmea2000", _STREAM, "NMEA 2000", "logs").NMEA2000Decoder()

    def messages(self, item: bytes) -> list[StreamMessage]:
        """Return the message that a line completes, none for a part of one.

        Raises:
            ValueError: the line is no text.
        """
        message = decoded_message(self._decoder, item.decode("ascii").strip())
        if message is None:
            return []
        values = dict(message.values)
        for name in ("latitude", "longitude"):
            if name in values:
                values[name] *= _DEGREE
        if {"cog", "sog"} <= set(values):
            values["north"] = values["sog"] * math.cos(values["cog"])
            values["east"] = values["sog"] * math.sin(values["cog"])
        topic = f"{message.name}:{message.reference}" if message.reference else message.name
        return [StreamMessage((topic, f"{topic}@{message.source}"), message.time, values)]


class MavlinkDecoder:
    """MAVLink 1 and 2 by the names of its messages, ``ATTITUDE/yaw``; a datagram holds whole ones.

    Raises:
        InputError: pymavlink (extra `logs`) is not installed.
    """

    def __init__(self) -> None:
        self._dialect = require_library("pymavlink.dialects.v20.ardupilotmega", _STREAM, "MAVLink", "logs")

    def messages(self, item: bytes) -> list[StreamMessage]:
        """Return the messages of a datagram.

        Raises:
            ValueError: it holds none.
        """
        parser = self._dialect.MAVLink(None)  # what a datagram leaves over is not the beginning of the next
        parser.robust_parsing = True
        complete = [one for one in parser.parse_buffer(item) or [] if one.get_type() != "BAD_DATA"]
        if not complete:
            raise ValueError("no MAVLink message")
        return [_mavlink_message(one) for one in complete]


def _mavlink_message(message: object) -> StreamMessage:
    fields = message.to_dict()  # type: ignore[attr-defined]
    topic = fields.pop("mavpackettype")
    values = {name: float(value) for name, value in fields.items() if isinstance(value, int | float)}
    for name in ("lat", "lon"):
        if name in values:
            values[name] *= _TENTH_MICRODEGREE
    time = values.get("time_boot_ms", math.nan) * _MILLI
    time = values["time_usec"] * _MICRO if "time_usec" in values else time
    return StreamMessage((topic, f"{topic}[{message.get_srcSystem()}.{message.get_srcComponent()}]"), time, values)  # type: ignore[attr-defined]
