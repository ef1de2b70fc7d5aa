"""Messages with topics to samples: NMEA 2000 as text and MAVLink, one every step of the nominal rate."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from seatrial.core.results.online import Sample, SampleCounts
from seatrial.core.values import Array, InputError
from seatrial.data.read.formats.nmea2000 import decoded_message
from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.data.read.log import require_library
from seatrial.onboard.lines import LineBatch
from seatrial.onboard.nmea import ARRIVAL, east_distance, north_distance

# Messages of an NMEA 2000 bus as text, and of MAVLink, as numbers by topic and field.

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


# Messages with topics to samples: one every step of the nominal rate, of the last reading of each channel in it.

_STAMP = "stamp"
_LATITUDES, _LONGITUDES = ("lat", "latitude"), ("lon", "longitude")


class MessageDecoder(Protocol):
    """Turns what arrives into messages; raises ValueError for what is none."""

    def messages(self, item: bytes) -> list[StreamMessage]:
        """Return the messages that an item completes."""
        ...


class MessageReader:
    """Turns messages into samples of the layout's channels, SI; a channel without a reading in a step is NaN.

    Columns are called ``topic/field`` as in a log: ``vesselHeading:True/heading``, ``ATTITUDE/yaw``. x0 and y0 may come
    from a latitude and a longitude: metres from the first fix. The time column is ``stamp``, the clock of the sender
    where its messages have one (others are dated by the last stamp), or ``arrival``, the clock of this machine.

    Attributes:
        origin: latitude and longitude [rad] of the plane; None before the first fix.

    Raises:
        InputError: a column without topic, or another time.
    """

    def __init__(
        self, layout: Layout, decoder: MessageDecoder, *, rate: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._columns = layout.columns
        self._wanted = [_topic_and_field(column) for column in layout.columns]
        if layout.time.source not in (_STAMP, ARRIVAL):
            raise InputError(
                f"time of messages comes from '{_STAMP}' or '{ARRIVAL}', not from '{layout.time.source}'; give one"
            )
        self._by_arrival = layout.time.source == ARRIVAL
        self._decoder, self._rate, self._clock = decoder, rate, clock
        self.origin: tuple[float, float] | None = None
        self._step: int | None = None
        self._values = self._empty()
        self._garbled = self._undated = 0

    @property
    def counts(self) -> SampleCounts:
        """garbled: lines or datagrams that are no message."""
        last = "no message with a stamp has arrived; set column = 'arrival' in follow.time" if self._undated else ""
        return SampleCounts(garbled=self._garbled, last_problem=last if self._step is None else "")

    def samples(self, batch: LineBatch) -> list[Sample]:
        """Return the samples that these items complete, in order."""
        done: list[Sample] = []
        for item in batch.lines:
            try:
                messages = self._decoder.messages(item)
            except ValueError:
                self._garbled += 1
                continue
            for message in messages:
                done += self._use(message)
        return done

    def flush(self) -> list[Sample]:
        """Return the sample of the last step, at the end of the input."""
        done = self._completed()
        self._step, self._values = None, self._empty()
        return done

    def _use(self, message: StreamMessage) -> list[Sample]:
        stamp = self._clock() if self._by_arrival else message.time
        done: list[Sample] = []
        if math.isfinite(stamp):
            step = math.floor(stamp * self._rate)
            if step != self._step:
                done, self._step, self._values = self._completed(), step, self._empty()
        elif self._step is None:
            self._undated += 1
            return []
        self._set_origin(message)
        for index, (topic, name) in enumerate(self._wanted):
            if topic in message.topics and name in message.values:
                self._values[index] = self._reading(index, name, message.values[name])
        return done

    def _completed(self) -> list[Sample]:
        if self._step is None or not np.any(np.isfinite(self._values)):
            return []
        return [Sample(self._step / self._rate, self._values)]

    def _empty(self) -> Array:
        return np.full(len(self._columns), np.nan)

    def _reading(self, index: int, name: str, value: float) -> float:
        """The number in SI; of a position the metres from the first fix."""
        column = self._columns[index]
        if column.symbol in ("x0", "y0") and name in (*_LATITUDES, *_LONGITUDES):
            if self.origin is None:
                return math.nan
            return north_distance(value, self.origin) if name in _LATITUDES else east_distance(value, self.origin)
        return float(column.in_si(np.array([value]))[0])

    def _set_origin(self, message: StreamMessage) -> None:
        latitude, longitude = (
            next((message.values[name] for name in names if name in message.values), math.nan)
            for names in (_LATITUDES, _LONGITUDES)
        )
        if self.origin is None and math.isfinite(latitude + longitude):
            self.origin = (latitude, longitude)


def _topic_and_field(column: ColumnSpec) -> tuple[str, str]:
    topic, slash, name = str(column.source).rpartition("/")
    if not slash:
        raise InputError(
            f"channel '{column.symbol}': a column of messages is called topic/field, such as 'ATTITUDE/yaw', not "
            f"'{column.source}'"
        )
    return topic, name
