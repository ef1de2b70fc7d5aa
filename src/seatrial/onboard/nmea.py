"""NMEA 0183 sentences to samples: grouped by time stamp or arrival, position on a plane about the first fix."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import Array, InputError
from seatrial.data.read.layout import Layout
from seatrial.onboard.lines import LineBatch
from seatrial.onboard.nmea_fields import columns_by_field
from seatrial.onboard.nmea_sentence import SentenceFault, parse_sentence, readings, utc_time
from seatrial.onboard.sample import Sample

ARRIVAL = "arrival"
_STAMP_NAMES = ("stamp", "time")
_DAY_S = 86400.0
_RELAY_DELAY_S = 10.0
_SAME_EPOCH = 0.25
# WGS 84 (NIMA 2000, TR8350.2): semi-major axis [m], first eccentricity squared
_A, _E2 = 6378137.0, 6.69437999014e-3


@dataclass(eq=False)
class _SentenceGroup:
    """The sample that is being put together; time is NaN until it is known."""

    time: float
    values: Array = field(default_factory=lambda: np.empty(0))


class NmeaReader:
    """Sentences to samples of the wanted channels, SI; what a group of sentences does not tell is NaN.

    The layout says which channels are wanted and, by its column names, from which field
    (`nmea_fields.columns_by_field`); its
    units, separators and header mean nothing here. With time column ``stamp``, a time stamp later than the last (RMC,
    GGA, GNS, GLL, ZDA) begins a group, to which all belongs until the next; of several readings of one channel the
    first counts, being nearest the stamp. Stamps a quarter of a step apart are one; sentences up to 10 s behind come
    from a relay and are late. Time is UTC in s since the midnight before the first stamp. With ``arrival``, a reading
    of a channel that the group has already begins the next, and time is the clock at which its lines were handed over;
    groups handed over at once are spread at the nominal rate.

    x0 north and y0 east lie on the plane that touches the ellipsoid at the first fix (error of y0: distance north
    times tan(latitude) over 6400 km, relative), heading and rudder are positive to starboard, roll, pitch and heave
    as the transducer sends them: their sign belongs into the layout.

    Attributes:
        used, unused: sentences that told something wanted, and all other good ones.
        origin: latitude and longitude [rad] of the plane; given: as before a restart.

    Raises:
        InputError: a channel that no sentence tells, or a place that does not exist.
    """

    def __init__(
        self,
        layout: Layout,
        *,
        rate: float,
        origin: tuple[float, float] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._column_ranks = columns_by_field(layout.columns)
        self._latitude_fields = {
            place.replace(" lon", " lat") for place in self._column_ranks if place[-4:] in (" lat", " lon")
        }
        self._by_arrival = _is_by_arrival(layout)
        self._dt, self._clock = 1.0 / rate, clock
        self._best_rank = [math.inf] * len(layout.columns)
        self._group: _SentenceGroup | None = None
        self._completed: list[_SentenceGroup] = []
        self._arrived_at = -math.inf
        self.origin = origin
        self.used = self.unused = 0
        self._garbled = self._checksum = self._late = 0
        self._last_trouble = ""

    @property
    def counts(self) -> SampleCounts:
        """garbled, checksum, late (relayed behind their time)."""
        last = self._last_trouble
        if not (self._by_arrival or self._group or self._completed) and self.unused > 100:
            last = "no sentence with a time (RMC, GGA, GLL, ZDA) has come; set follow.time column = 'arrival'"
        return SampleCounts(garbled=self._garbled, checksum=self._checksum, late=self._late, last_problem=last)

    def samples(self, batch: LineBatch) -> list[Sample]:
        """The samples that these lines complete, in order."""
        for line in batch.lines:
            if line.strip():
                self._read_line(line)
        if self._by_arrival:
            self._set_arrival_times()
        done, self._completed = self._completed, []
        return [Sample(group.time, group.values) for group in done]

    def flush(self) -> list[Sample]:
        """The last group, which nothing will complete."""
        group, self._group = self._group, None
        return [] if group is None else [Sample(group.time, group.values)]

    def _read_line(self, line: bytes) -> None:
        sentence = parse_sentence(line)
        if isinstance(sentence, SentenceFault):
            self._count_fault(sentence, line)
            return
        try:
            told, at = readings(sentence), math.nan if self._by_arrival else utc_time(sentence)
        except ValueError:
            self._count_fault(SentenceFault.GARBLED, line)
            return
        self._set_origin(told)
        is_used = False
        if math.isfinite(at):
            if not self._accept_stamp(at):
                self._late += 1
                self._last_trouble = f"a {sentence.kind} sentence is behind the clock of the others"
                return
            is_used = True
        for place, value in told.items():
            if math.isfinite(value) and place in self._column_ranks:
                is_used |= self._use_reading(place, value)
        self.used += is_used
        self.unused += not is_used

    def _count_fault(self, fault: SentenceFault, line: bytes) -> None:
        shown = repr(line[:40])[1:]
        if fault is SentenceFault.CHECKSUM:
            self._checksum += 1
            self._last_trouble = f"wrong checksum: {shown}"
        else:
            self._garbled += 1
            self._last_trouble = f"no sentence: {shown}"

    def _accept_stamp(self, time_of_day: float) -> bool:
        """Begin a group if the stamp is a new one; whether what comes with it belongs to the group."""
        if self._group is None:
            self._start_group(time_of_day)
            return True
        now = self._group.time
        at = time_of_day + _DAY_S * round((now - time_of_day) / _DAY_S)
        if -_RELAY_DELAY_S < at - now < -_SAME_EPOCH * self._dt:
            return False
        if abs(at - now) > _SAME_EPOCH * self._dt:
            self._start_group(at)
        return True

    def _start_group(self, timestamp: float) -> None:
        if self._group is not None:
            self._completed.append(self._group)
        self._group = _SentenceGroup(timestamp, np.full(len(self._best_rank), np.nan))

    def _use_reading(self, field_name: str, value: float) -> bool:
        if self._group is None and not self._by_arrival:
            return False
        is_used = False
        for index, rank in self._column_ranks[field_name]:
            if rank > self._best_rank[index]:
                continue
            is_better, self._best_rank[index] = rank < self._best_rank[index], rank
            if self._by_arrival and (self._group is None or not (is_better or np.isnan(self._group.values[index]))):
                self._start_group(math.nan)
            group = self._group
            if group is not None and (is_better or np.isnan(group.values[index])):
                group.values[index] = self._to_local_plane(field_name, value)
                is_used = True
        return is_used

    def _to_local_plane(self, field_name: str, value: float) -> float:
        """Latitude and longitude to metres north and east of the origin; anything else as it is."""
        part = field_name.partition(" ")[2]
        if self.origin is None or part not in ("lat", "lon"):
            return value
        return north_distance(value, self.origin) if part == "lat" else east_distance(value, self.origin)

    def _set_origin(self, field_values: dict[str, float]) -> None:
        """The first position that is wanted touches the plane."""
        if self.origin is not None:
            return
        for place, latitude in field_values.items():
            longitude = field_values.get(place.replace(" lat", " lon"), math.nan)
            if place.endswith(" lat") and place in self._latitude_fields and math.isfinite(latitude + longitude):
                self.origin = (latitude, longitude)

    def _set_arrival_times(self) -> None:
        """Times of the groups begun in these lines: spread up to now, never further apart than the nominal step."""
        begun = [group for group in (*self._completed, self._group) if group is not None and math.isnan(group.time)]
        now, before = self._clock(), self._arrived_at
        for number, group in enumerate(begun, start=1):
            group.time = now - (len(begun) - number) * self._dt
            if math.isfinite(before):
                group.time = max(group.time, before + (now - before) * number / len(begun))
        if begun:
            self._arrived_at = now


def north_distance(latitude: float, origin: tuple[float, float]) -> float:
    """m north of the origin (latitude, longitude) [rad] along its meridian: Snyder 1987, USGS PP 1395, eq. 4-18."""
    return _A * (1.0 - _E2) / (1.0 - _E2 * math.sin(origin[0]) ** 2) ** 1.5 * (latitude - origin[0])


def east_distance(longitude: float, origin: tuple[float, float]) -> float:
    """m east of the origin (latitude, longitude) [rad] along its parallel: ibid., eq. 4-20, 4-21."""
    radius = _A / math.sqrt(1.0 - _E2 * math.sin(origin[0]) ** 2)
    return radius * math.cos(origin[0]) * math.remainder(longitude - origin[1], 2.0 * math.pi)


def _is_by_arrival(layout: Layout) -> bool:
    source = layout.time.source
    if isinstance(source, int) or source.lower() in _STAMP_NAMES:
        return False
    if source.lower() != ARRIVAL:
        raise InputError(f"time of NMEA sentences comes from 'stamp' or '{ARRIVAL}', not from '{source}'; give one")
    return True
