"""NMEA 0183 sentences to samples: grouped by time stamp or arrival, position on a plane about the first fix."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from seatrial.core.results.online import Counts
from seatrial.core.values import Array, InputError
from seatrial.data.read.layout import Layout
from seatrial.onboard.lines import Batch
from seatrial.onboard.places import wanted_places
from seatrial.onboard.sample import Sample
from seatrial.onboard.sentence import Fault, parsed, readings, stamp

ARRIVAL = "arrival"
_STAMP_WORDS = ("stamp", "time")
_DAY = 86400.0
_RELAYED = 10.0
_SAME_EPOCH = 0.25
# WGS 84 (NIMA 2000, TR8350.2): semi-major axis [m], first eccentricity squared
_A, _E2 = 6378137.0, 6.69437999014e-3


@dataclass(eq=False)
class _Group:
    """The sample that is being put together; time is NaN until it is known."""

    time: float
    values: Array = field(default_factory=lambda: np.empty(0))


class NmeaReader:
    """Sentences to samples of the wanted channels, SI; what a group of sentences does not tell is NaN.

    The layout says which channels are wanted and, by its column names, from which place (`places.wanted_places`); its
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
        self._uses = wanted_places(layout.columns)
        self._positions = {place.replace(" lon", " lat") for place in self._uses if place[-4:] in (" lat", " lon")}
        self._by_arrival = _is_by_arrival(layout)
        self._dt, self._clock = 1.0 / rate, clock
        self._best = [math.inf] * len(layout.columns)
        self._group: _Group | None = None
        self._done: list[_Group] = []
        self._arrived = -math.inf
        self.origin = origin
        self.used = self.unused = 0
        self._garbled = self._checksum = self._late = 0
        self._last = ""

    @property
    def counts(self) -> Counts:
        """garbled, checksum, late (relayed behind their time)."""
        last = self._last
        if not (self._by_arrival or self._group or self._done) and self.unused > 100:
            last = "no sentence with a time (RMC, GGA, GLL, ZDA) has come; set follow.time column = 'arrival'"
        return Counts(garbled=self._garbled, checksum=self._checksum, late=self._late, last=last)

    def samples(self, batch: Batch) -> list[Sample]:
        """The samples that these lines complete, in order."""
        for line in batch.lines:
            if line.strip():
                self._read(line)
        if self._by_arrival:
            self._set_arrival()
        done, self._done = self._done, []
        return [Sample(group.time, group.values) for group in done]

    def rest(self) -> list[Sample]:
        """The last group, which nothing will complete."""
        group, self._group = self._group, None
        return [] if group is None else [Sample(group.time, group.values)]

    def _read(self, line: bytes) -> None:
        sentence = parsed(line)
        if isinstance(sentence, Fault):
            self._count_fault(sentence, line)
            return
        try:
            told, at = readings(sentence), math.nan if self._by_arrival else stamp(sentence)
        except ValueError:
            self._count_fault(Fault.GARBLED, line)
            return
        self._set_origin(told)
        is_used = False
        if math.isfinite(at):
            if not self._stamped(at):
                self._late += 1
                self._last = f"a {sentence.kind} sentence is behind the clock of the others"
                return
            is_used = True
        for place, value in told.items():
            if math.isfinite(value) and place in self._uses:
                is_used |= self._told(place, value)
        self.used += is_used
        self.unused += not is_used

    def _count_fault(self, fault: Fault, line: bytes) -> None:
        shown = repr(line[:40])[1:]
        if fault is Fault.CHECKSUM:
            self._checksum += 1
            self._last = f"wrong checksum: {shown}"
        else:
            self._garbled += 1
            self._last = f"no sentence: {shown}"

    def _stamped(self, of_day: float) -> bool:
        """Begin a group if the stamp is a new one; whether what comes with it belongs to the group."""
        if self._group is None:
            self._begin(of_day)
            return True
        now = self._group.time
        at = of_day + _DAY * round((now - of_day) / _DAY)
        if -_RELAYED < at - now < -_SAME_EPOCH * self._dt:
            return False
        if abs(at - now) > _SAME_EPOCH * self._dt:
            self._begin(at)
        return True

    def _begin(self, at: float) -> None:
        if self._group is not None:
            self._done.append(self._group)
        self._group = _Group(at, np.full(len(self._best), np.nan))

    def _told(self, place: str, value: float) -> bool:
        if self._group is None and not self._by_arrival:
            return False
        is_used = False
        for index, rank in self._uses[place]:
            if rank > self._best[index]:
                continue
            is_better, self._best[index] = rank < self._best[index], rank
            if self._by_arrival and (self._group is None or not (is_better or np.isnan(self._group.values[index]))):
                self._begin(math.nan)
            group = self._group
            if group is not None and (is_better or np.isnan(group.values[index])):
                group.values[index] = self._converted(place, value)
                is_used = True
        return is_used

    def _converted(self, place: str, value: float) -> float:
        """Latitude and longitude to metres north and east of the origin; anything else as it is."""
        part = place.partition(" ")[2]
        if self.origin is None or part not in ("lat", "lon"):
            return value
        return north_of(value, self.origin) if part == "lat" else east_of(value, self.origin)

    def _set_origin(self, told: dict[str, float]) -> None:
        """The first position that is wanted touches the plane."""
        if self.origin is not None:
            return
        for place, latitude in told.items():
            longitude = told.get(place.replace(" lat", " lon"), math.nan)
            if place.endswith(" lat") and place in self._positions and math.isfinite(latitude + longitude):
                self.origin = (latitude, longitude)

    def _set_arrival(self) -> None:
        """Times of the groups begun in these lines: spread up to now, never further apart than the nominal step."""
        begun = [group for group in (*self._done, self._group) if group is not None and math.isnan(group.time)]
        now, before = self._clock(), self._arrived
        for number, group in enumerate(begun, start=1):
            group.time = now - (len(begun) - number) * self._dt
            if math.isfinite(before):
                group.time = max(group.time, before + (now - before) * number / len(begun))
        if begun:
            self._arrived = now


def north_of(latitude: float, origin: tuple[float, float]) -> float:
    """m north of the origin (latitude, longitude) [rad] along its meridian: Snyder 1987, USGS PP 1395, eq. 4-18."""
    return _A * (1.0 - _E2) / (1.0 - _E2 * math.sin(origin[0]) ** 2) ** 1.5 * (latitude - origin[0])


def east_of(longitude: float, origin: tuple[float, float]) -> float:
    """m east of the origin (latitude, longitude) [rad] along its parallel: ibid., eq. 4-20, 4-21."""
    radius = _A / math.sqrt(1.0 - _E2 * math.sin(origin[0]) ** 2)
    return radius * math.cos(origin[0]) * math.remainder(longitude - origin[1], 2.0 * math.pi)


def _is_by_arrival(layout: Layout) -> bool:
    source = layout.time.source
    if isinstance(source, int) or source.lower() in _STAMP_WORDS:
        return False
    if source.lower() != ARRIVAL:
        raise InputError(f"time of NMEA sentences comes from 'stamp' or '{ARRIVAL}', not from '{source}'; give one")
    return True
