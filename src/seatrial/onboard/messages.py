"""Messages with topics to samples: one every step of the nominal rate, of the last reading of each channel in it."""

import math
import time
from collections.abc import Callable
from typing import Protocol

import numpy as np

from seatrial.core.results.online import Sample, SampleCounts
from seatrial.core.values import Array, InputError
from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.onboard.lines import LineBatch
from seatrial.onboard.message_decoders import StreamMessage
from seatrial.onboard.nmea import ARRIVAL, east_distance, north_distance

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
