"""NMEA 0183 sentences to samples: grouped by time stamp or arrival, position on a plane about the first fix."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from seatrial.core.results.online import Sample, SampleCounts
from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.data.read.nmea_sentence import READ, SentenceFault, SentenceReader, unit_of
from seatrial.onboard.lines import LineBatch

# Which field of which NMEA sentence gives which channel.

_TRANSDUCER_PREFIX = "XDR "
_SHAFTS = {f"RPM {source}{number}": "rps" for source in "SE" for number in range(5)}  # five shafts, five engines

# (channel, frame) -> fields, the best first
_DEFAULT_FIELDS: dict[tuple[str, str], tuple[str, ...]] = {
    ("psi", "earth"): ("HDT", "THS", "OSD heading", "PASHR heading", "HDG true", "HDM true", "VHW heading"),
    ("r", "body"): ("ROT",),
    ("delta", "body"): ("RSA", "XDR RUDDER", "RSA port"),
    ("u", "body"): ("VBW", "VHW", "OSD speed"),
    ("v", "body"): ("VBW transverse",),
    ("u", "earth"): ("VTG north", "RMC north"),
    ("v", "earth"): ("VTG east", "RMC east"),
    ("x0", "earth"): ("GGA lat", "RMC lat", "GNS lat", "GLL lat"),
    ("y0", "earth"): ("GGA lon", "RMC lon", "GNS lon", "GLL lon"),
    ("phi", "body"): ("XDR ROLL", "XDR HEEL", "PASHR roll"),
    ("theta", "body"): ("XDR PTCH", "XDR PITCH", "PASHR pitch"),
    ("z", "body"): ("XDR HEAV", "XDR HEAVE", "PASHR heave"),
    ("n", "none"): ("RPM S0", "RPM S1", "RPM S2"),
    **{(f"rpm_{k}", "none"): (f"RPM S{k}", f"RPM E{k}") for k in range(1, 5)},  # four shafts or engines
}


def columns_by_field(columns: Sequence[ColumnSpec]) -> dict[str, list[tuple[int, int]]]:
    """Return field -> (index of the column, rank, 0 the best) for each column that it can fill.

    A column named after its channel (or numbered) takes the usual fields, the best that arrives; one named after a
    field (``VBW ground``, ``XDR ROLL1``) takes that alone.

    Raises:
        InputError: no sentence contains the channel, or the field is unknown or measures something else.
    """
    ranks: dict[str, list[tuple[int, int]]] = {}
    for index, column in enumerate(columns):
        for rank, name in enumerate(_column_fields(column)):
            ranks.setdefault(name, []).append((index, rank))
    return ranks


def _column_fields(column: ColumnSpec) -> tuple[str, ...]:
    source = column.source
    if isinstance(source, int) or source == column.symbol:
        usual = _DEFAULT_FIELDS.get((column.symbol, column.declared_frame))
        if usual is None:
            raise InputError(
                f"no NMEA 0183 sentence contains channel '{column.symbol}' in frame '{column.declared_frame}'; name a "
                f"transducer, such as 'XDR NAME', or leave the channel out"
            )
        return usual
    if source.startswith(_TRANSDUCER_PREFIX):
        return (_TRANSDUCER_PREFIX + source.removeprefix(_TRANSDUCER_PREFIX).strip().upper(),)
    unit = _SHAFTS.get(source) or (unit_of(source) if source.split(" ")[0] in READ else "")
    if not unit:
        usual = {name for names in _DEFAULT_FIELDS.values() for name in names} | {*READ, *_SHAFTS}
        raise InputError(f"channel '{column.symbol}': no NMEA field '{source}'{spelling_hint(source, sorted(usual))}")
    is_place = source[-4:] in (" lat", " lon")
    if ("m" if is_place else unit) != column.quantity.unit:
        raise InputError(f"channel '{column.symbol}' cannot come from NMEA '{source}', which is in {unit}")
    return (source,)


# NMEA 0183 sentences to samples: grouped by time stamp or arrival, position on a plane about the first fix.

ARRIVAL = "arrival"
_STAMP_NAMES = ("stamp", "time")
# s by which a relayed sentence may be late; share of a step within which stamps are one, as receivers round
_RELAY_DELAY_S, _SAME_EPOCH = 10.0, 0.25
# WGS 84 (NIMA 2000, TR8350.2): semi-major axis [m], first eccentricity squared
_A, _E2 = 6378137.0, 6.69437999014e-3


@dataclass(eq=False)
class _SentenceGroup:
    """A sample under construction; time [s] is NaN until it is known."""

    time: float
    values: Array = field(default_factory=lambda: np.empty(0))


class NmeaReader:
    """Turns sentences into samples of the layout's channels, SI; a channel that a group of sentences lacks is NaN.

    The layout gives the channels and, by its column names, the field of each (`nmea_fields.columns_by_field`); its
    units, separators and header have no meaning here. With time column ``stamp``, a time stamp later than the last
    (RMC, GGA, GNS, GLL, ZDA) begins a group, which lasts until the next; of several readings of one channel the first
    counts, being nearest the stamp. Stamps a quarter of a step apart are one; sentences up to 10 s behind come
    from a relay and are late. Time is UTC in s since the midnight before the first stamp. With ``arrival``, a reading
    of a channel that the group has already begins the next, and time is the clock at which its lines arrived; groups
    that arrive together are spread at the nominal rate.

    x0 north and y0 east lie on the plane that touches the ellipsoid at the first fix (error of y0: distance north
    times tan(latitude) over 6400 km, relative), heading and rudder are positive to starboard, roll, pitch and heave
    as the transducer sends them: their sign belongs in the layout.

    Attributes:
        used, unused: numbers of sentences with a reading that was used, and of all other valid ones.
        origin: latitude and longitude [rad] of the plane; may be given, to go on after a restart.

    Raises:
        InputError: a channel that no sentence contains, or a field that does not exist.
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
            name.replace(" lon", " lat") for name in self._column_ranks if name[-4:] in (" lat", " lon")
        }
        self._by_arrival = _is_by_arrival(layout)
        self._dt, self._clock = 1.0 / rate, clock
        self._best_rank = [math.inf] * len(layout.columns)
        self._group: _SentenceGroup | None = None
        self._completed: list[_SentenceGroup] = []
        self._arrived_at = -math.inf
        self.origin = origin
        self.used = self.unused = 0
        self._sentences = SentenceReader()
        self._late = 0
        self._last_error = ""

    @property
    def counts(self) -> SampleCounts:
        """garbled, checksum, late (relayed behind their time)."""
        last = self._last_error
        if not (self._by_arrival or self._group or self._completed) and self.unused > 100:
            last = "no sentence with a time (RMC, GGA, GLL, ZDA) has arrived; set column = 'arrival' in follow.time"
        faults = self._sentences.faults
        return SampleCounts(
            garbled=faults[SentenceFault.GARBLED], checksum=faults[SentenceFault.CHECKSUM], late=self._late,
            last_problem=last,
        )  # fmt: skip

    def samples(self, batch: LineBatch) -> list[Sample]:
        """Return the samples that these lines complete, in order."""
        for line in batch.lines:
            if line.strip():
                self._read_line(line)
        if self._by_arrival:
            self._set_arrival_times()
        done, self._completed = self._completed, []
        return [Sample(group.time, group.values) for group in done]

    def flush(self) -> list[Sample]:
        """Return the last group as a sample, at the end of the input."""
        group, self._group = self._group, None
        return [] if group is None else [Sample(group.time, group.values)]

    def _read_line(self, line: bytes) -> None:
        received = self._sentences.read(line)
        if received is None:
            self._last_error = self._sentences.problem
            return
        self._set_origin(received.values)
        is_used = False
        if math.isfinite(received.stamp) and not self._by_arrival:
            if not self._accept_stamp(received.stamp):
                self._late += 1
                self._last_error = f"a {received.sentence.kind} sentence is behind the clock of the others"
                return
            is_used = True
        for name, value in received.values.items():
            if math.isfinite(value) and name in self._column_ranks:
                is_used |= self._use_reading(name, value)
        self.used += is_used
        self.unused += not is_used

    def _accept_stamp(self, stamp: float) -> bool:
        """Begin a group if the stamp is a new one, and return whether its sentence belongs to the present group."""
        if self._group is None:
            self._start_group(stamp)
            return True
        now = self._group.time
        if -_RELAY_DELAY_S < stamp - now < -_SAME_EPOCH * self._dt:
            return False
        if abs(stamp - now) > _SAME_EPOCH * self._dt:
            self._start_group(stamp)
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
        """Latitude and longitude as metres north and east of the origin; any other value unchanged."""
        part = field_name.partition(" ")[2]
        if self.origin is None or part not in ("lat", "lon"):
            return value
        return north_distance(value, self.origin) if part == "lat" else east_distance(value, self.origin)

    def _set_origin(self, field_values: dict[str, float]) -> None:
        """Put the origin of the plane at the first position of a field that is used."""
        if self.origin is not None:
            return
        for name, latitude in field_values.items():
            longitude = field_values.get(name.replace(" lat", " lon"), math.nan)
            if name.endswith(" lat") and name in self._latitude_fields and math.isfinite(latitude + longitude):
                self.origin = (latitude, longitude)

    def _set_arrival_times(self) -> None:
        """Set the times of the groups begun in these lines: spread up to now, at most a nominal step apart."""
        begun = [group for group in (*self._completed, self._group) if group is not None and math.isnan(group.time)]
        now, before = self._clock(), self._arrived_at
        for number, group in enumerate(begun, start=1):
            group.time = now - (len(begun) - number) * self._dt
            if math.isfinite(before):
                group.time = max(group.time, before + (now - before) * number / len(begun))
        if begun:
            self._arrived_at = now


def north_distance(latitude: float, origin: tuple[float, float]) -> float:
    """Return the m north of the origin (latitude, longitude) [rad]: Snyder 1987, USGS PP 1395, eq. 4-18."""
    return _A * (1.0 - _E2) / (1.0 - _E2 * math.sin(origin[0]) ** 2) ** 1.5 * (latitude - origin[0])


def east_distance(longitude: float, origin: tuple[float, float]) -> float:
    """Return the m east of the origin (latitude, longitude) [rad]: ibid., eq. 4-20, 4-21."""
    radius = _A / math.sqrt(1.0 - _E2 * math.sin(origin[0]) ** 2)
    return radius * math.cos(origin[0]) * math.remainder(longitude - origin[1], 2.0 * math.pi)


def _is_by_arrival(layout: Layout) -> bool:
    source = layout.time.source
    if isinstance(source, int) or source.lower() in _STAMP_NAMES:
        return False
    if source.lower() != ARRIVAL:
        raise InputError(f"time of NMEA sentences comes from 'stamp' or '{ARRIVAL}', not from '{source}'; give one")
    return True
