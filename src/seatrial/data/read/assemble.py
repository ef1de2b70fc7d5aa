"""From the cells of logs to a record in SI units, conventions as declared."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, Channel, InputError, Provenance, Record, frozen
from seatrial.core.values.arrays import EMPTIED, Mask, sentinel_value, unwrapped
from seatrial.core.values.files import plain_name
from seatrial.core.values.record import froude_scaled
from seatrial.data.held_readings import between_readings, held_text, slower_channels
from seatrial.data.read.clock import Series, common_time, moment_text, ordered_series, stamps, values_at
from seatrial.data.read.layout import LOG_QUANTITIES, ColumnSpec, Geometry, Layout
from seatrial.data.read.log import Log, RawTable
from seatrial.data.readings import without_codes

# Channels of a record out of what a log measures: positions on a plane, velocities, headings.

_QUATERNION = ("q_w", "q_x", "q_y", "q_z")
_ENU_PAIRS = (("x0", "y0"), ("u", "v"), ("u_dot", "v_dot"))


@dataclass(frozen=True, eq=False)
class Measured:
    """A column in SI units, shape (n,), with what is declared about it.

    emptied: what readings were made empty that a standard's code marks; empty: none.
    is_measured: shape (n,), False in rows that repeat an earlier reading; None: every row is a reading.
    """

    column: ColumnSpec
    values: Array
    label: str
    is_measured: Mask | None = None
    emptied: str = ""

    def turned_into(self, symbol: str, values: Array, *, frame: str = "", reference_point: float = 0.0) -> "Measured":
        """Return a channel derived from this one, in the notation table's sign."""
        column = ColumnSpec(symbol, self.column.source, "", frame, "", reference_point)
        return Measured(column, values, self.label, self.is_measured)


_Measurements = dict[str, Measured]


def derived_channels(measured: _Measurements, geometry: Geometry, name: str) -> _Measurements:
    """Return the channels: those that were measured, and those that follow from the rest, which is left out.

    lat, lon -> x0, y0 on the plane that touches the ellipsoid at the origin; sog, cog -> u, v over ground; stw -> u;
    psi_magnetic and the variation -> psi; an apparent wind with sog, cog and psi -> the true one; a quaternion -> psi,
    phi, theta; ENU axes -> north, east.

    Raises:
        InputError: one of a pair is missing, a channel comes from two measurements, no variation for a magnetic
            heading.
    """
    present = dict(measured)
    steps: tuple[Callable[[_Measurements, Geometry], _Measurements], ...] = (
        _attitude, _magnetic_heading, _in_north_east, _position, _true_wind, _ground_velocity,
        _water_speed, _from_antenna,
    )  # fmt: skip
    try:
        for step in steps:
            new = step(present, geometry)
            for symbol in new:
                if symbol in measured and measured[symbol].column.frame != "enu" and step is not _from_antenna:
                    raise InputError(
                        f"channel '{symbol}' is given, and follows from other columns as well; keep one of them"
                    )
            present |= new
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    return {symbol: one for symbol, one in present.items() if symbol not in LOG_QUANTITIES}


def _pair(present: _Measurements, one: str, other: str) -> tuple[Measured, Measured] | None:
    if (one in present) != (other in present):
        lone, missing = (one, other) if one in present else (other, one)
        raise InputError(f"channel '{lone}' needs '{missing}' as well; add it, or leave '{lone}' out")
    return (present[one], present[other]) if one in present else None


def _to_starboard(measured: Measured) -> Array:
    """Angles or rates that count to starboard, whichever way the column does."""
    return -measured.values if measured.column.positive == "port" else measured.values


def _position(present: _Measurements, geometry: Geometry) -> _Measurements:
    """East and north on the tangent plane (pymap3d; WGS 84); altitude is ignored."""
    pair = _pair(present, "lat", "lon")
    if pair is None:
        return {}
    import pymap3d

    lat, lon = pair
    known = np.flatnonzero(np.isfinite(lat.values) & np.isfinite(lon.values))
    if known.size == 0:
        raise InputError("there is no fix: 'lat' and 'lon' are never given together; leave them out")
    first = int(known[0])
    origin = geometry.origin or (float(lat.values[first]), float(lon.values[first]))
    east, north, _ = pymap3d.geodetic2enu(lat.values, lon.values, 0.0, origin[0], origin[1], 0.0, deg=False)
    place = geometry.antenna_x
    return {
        "x0": lat.turned_into("x0", np.asarray(north, dtype=float), reference_point=place),
        "y0": lon.turned_into("y0", np.asarray(east, dtype=float), reference_point=place),
    }


def _ground_velocity(present: _Measurements, geometry: Geometry) -> _Measurements:
    pair = _pair(present, "sog", "cog")
    if pair is None:
        return {}
    speed, course = pair
    place = geometry.antenna_x
    return {
        "u": speed.turned_into("u", speed.values * np.cos(course.values), frame="earth", reference_point=place),
        "v": course.turned_into("v", speed.values * np.sin(course.values), frame="earth", reference_point=place),
    }


def _true_wind(present: _Measurements, geometry: Geometry) -> _Measurements:  # noqa: ARG001
    """The apparent wind without the craft's own velocity over ground, both as where they come from (north + i east).

    W exp(i direction) = V_A exp(i (psi + angle)) - U exp(i chi) (Fossen 2021, section 10.1, eq. 10.2 to 10.4).
    """
    if not {"wind_speed_relative", "wind_direction_relative", "sog", "cog", "psi"} <= set(present):
        return {}
    if {"wind_speed", "wind_direction"} & set(present):
        return {}
    direction = _to_starboard(present["psi"]) + _to_starboard(present["wind_direction_relative"])
    air = present["wind_speed_relative"].values * np.exp(1j * direction)
    wind = air - present["sog"].values * np.exp(1j * _to_starboard(present["cog"]))
    return {
        "wind_speed": present["wind_speed_relative"].turned_into("wind_speed", np.abs(wind)),
        "wind_direction": present["wind_direction_relative"].turned_into("wind_direction", np.angle(wind)),
    }


def _water_speed(present: _Measurements, geometry: Geometry) -> _Measurements:  # noqa: ARG001
    if {"stw", "sog"} <= set(present):
        raise InputError("'stw' and 'sog' both give the speed 'u', through the water and over ground; leave one out")
    return {"u": present["stw"].turned_into("u", present["stw"].values)} if "stw" in present else {}


def _magnetic_heading(present: _Measurements, geometry: Geometry) -> _Measurements:
    if "psi_magnetic" not in present:
        return {}
    magnetic = present["psi_magnetic"]
    if "variation" in present:
        variation: Array | float = present["variation"].values
    elif geometry.variation is not None:
        variation = geometry.variation
    else:
        raise InputError(
            "a magnetic heading needs the variation of the place, positive to the east; add it, such as "
            'variation = { value = 3.4, unit = "deg" }'
        )
    return {"psi": magnetic.turned_into("psi", magnetic.values + variation)}


def _attitude(present: _Measurements, geometry: Geometry) -> _Measurements:  # noqa: ARG001
    """Euler angles of a unit quaternion, z-y-x (Fossen 2021, eq. 2.77-2.79).

    In ENU axes with the body's x forward, y to port, z up, psi = pi/2 - yaw and theta = -pitch.
    """
    components = [symbol for symbol in _QUATERNION if symbol in present]
    if not components:
        return {}
    if len(components) < len(_QUATERNION):
        missing = next(symbol for symbol in _QUATERNION if symbol not in present)
        raise InputError(f"the quaternion lacks '{missing}'; give q_w, q_x, q_y and q_z")
    w, x, y, z = (present[symbol].values for symbol in _QUATERNION)
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    source = present["q_w"]
    is_enu = source.column.frame == "enu"
    angles = {"psi": np.pi / 2.0 - yaw if is_enu else yaw, "phi": roll, "theta": -pitch if is_enu else pitch}
    # a pose in the plane shows neither roll nor pitch: its zeros are no measurement
    shown = {s: angle for s, angle in angles.items() if s == "psi" or np.any(np.isfinite(angle) & (angle != 0.0))}
    return {symbol: source.turned_into(symbol, angle) for symbol, angle in shown.items() if symbol not in present}


def _in_north_east(present: _Measurements, geometry: Geometry) -> _Measurements:  # noqa: ARG001
    """Columns in ENU axes: x is east, y north; headings count from east to north, yaw rates to port."""
    turned: _Measurements = {}
    for one, other in _ENU_PAIRS:
        frames = {present[symbol].column.frame for symbol in (one, other) if symbol in present}
        if "enu" not in frames:
            continue
        pair = _pair(present, one, other)
        if pair is None or frames != {"enu"}:
            raise InputError(f"frame = \"enu\" must be declared for both of '{one}' and '{other}'; add it")
        for symbol, read, kept in ((one, pair[1], pair[0]), (other, pair[0], pair[1])):
            column = replace(kept.column, frame="earth")
            turned[symbol] = Measured(column, read.values, kept.label, read.is_measured)
    for symbol in ("psi", "r"):
        if symbol in present and present[symbol].column.frame == "enu":
            one = present[symbol]
            values = np.pi / 2.0 - one.values if symbol == "psi" else -one.values
            turned[symbol] = replace(one, column=replace(one.column, frame="", positive=""), values=values)
    return turned


def _from_antenna(present: _Measurements, geometry: Geometry) -> _Measurements:
    """Positions on a plane as the antenna's, and all that is of one beside the centre line moved to it.

    An antenna b m to starboard (Fossen 2021, section 2.3): north + b sin psi, east - b cos psi; earth-fixed velocities
    + b r (cos psi, sin psi).
    """
    moved = _plane_of_antenna(present, geometry)
    b = geometry.antenna_y
    if b == 0.0 or not ({"lat", "sog"} & set(present) or moved):
        return moved
    if "psi" not in present:
        raise InputError("an antenna beside the centre line needs the heading 'psi'; add it")
    psi = _to_starboard(present["psi"])
    if moved or "lat" in present:
        north, east = (moved.get(symbol, present[symbol]) for symbol in ("x0", "y0"))
        moved["x0"] = replace(north, values=north.values + b * np.sin(psi))
        moved["y0"] = replace(east, values=east.values - b * np.cos(psi))
    if "sog" in present:
        if "r" not in present:
            raise InputError("velocities of an antenna beside the centre line need the yaw rate 'r'; add it")
        rate = _to_starboard(present["r"])
        moved["u"] = replace(present["u"], values=present["u"].values + b * rate * np.cos(psi))
        moved["v"] = replace(present["v"], values=present["v"].values + b * rate * np.sin(psi))
    return moved


def _plane_of_antenna(present: _Measurements, geometry: Geometry) -> _Measurements:
    """Columns x0 and y0 at the antenna, unless they state a place; not those of a pose that comes with velocities."""
    is_of_receiver = bool({"sog", "stw"} & set(present)) or not {"u", "v"} & set(present)
    if "lat" in present or not {"x0", "y0"} <= set(present) or not is_of_receiver:
        return {}
    if geometry.antenna_x == geometry.antenna_y == 0.0 or present["x0"].column.reference_point != 0.0:
        return {}
    pair = {symbol: present[symbol] for symbol in ("x0", "y0")}
    return {
        symbol: replace(one, column=replace(one.column, reference_point=geometry.antenna_x))
        for symbol, one in pair.items()
    }


# Readings that stand for none: fixes at 0/0, and values such as -999; emptied before anything is joined or derived.


def without_fixes_at_zero(measured: dict[str, Measured], time: Array) -> tuple[dict[str, Measured], str]:
    """Return columns of one table (n,) without fixes at latitude 0, longitude 0, and a sentence; empty: none.

    time: stamps (n,) [s]. Receivers write 0/0 where they have no fix.
    """
    if not {"lat", "lon"} <= set(measured):
        return measured, ""
    rows = (measured["lat"].values == 0.0) & (measured["lon"].values == 0.0)
    if not rows.any():
        return measured, ""
    emptied = {s: replace(measured[s], values=np.where(rows, np.nan, measured[s].values)) for s in ("lat", "lon")}
    text = f"'lat', 'lon': {rows.sum()} of {rows.size} fixes lie at 0/0, {_times(time[rows])}, and {EMPTIED}"
    return measured | emptied, text


def without_sentinel(one: Measured, time: Array) -> tuple[Measured, str]:
    """Return a measured column (n,) without the value that stands for no reading, and a sentence; empty: none.

    time: stamps (n,) [s]. Commands are left alone.
    """
    sentinel = None if one.column.is_held else sentinel_value(one.values, one.column.quantity.unit)
    if sentinel is None:
        return one, ""
    rows = one.values == sentinel
    text = f"'{one.column.symbol}': {rows.sum()} of {rows.size} readings are {sentinel:.6g} {one.column.quantity.unit}"
    return replace(one, values=np.where(rows, np.nan, one.values)), f"{text}, {_times(time[rows])}, and {EMPTIED}"


def _times(stamps: Array) -> str:
    """The first and the last of the times, as findings state times of the logger's clock."""
    return f"the first and the last at t = {stamps[0]:.12g} to {stamps[-1]:.12g} s"


# From the cells of logs to a record in SI units, conventions as declared.


@dataclass(frozen=True, eq=False)
class LogSource:
    """A log with the layout of what is wanted of it, and its digest."""

    log: Log
    layout: Layout
    sha256: str = ""


def assemble_record(log: Log, layout: Layout, sha256: str) -> Record:
    """The record of one log; empty cells stay NaN, frames and signs stay as declared.

    Columns of one topic keep its time stamps; those of several are joined as in `record_of_sources`.

    Raises:
        InputError: time runs backwards, fewer than two samples, a channel without any number, wrong unit.
    """
    tables = [log.table_of(column) for column in layout.columns or (layout.time,)]
    if any(table is not tables[0] for table in tables):
        return record_of_sources(record_name(log.file), [LogSource(log, layout, sha256)])
    table = tables[0]
    read = stamps(table, _time_column(layout, table))
    _require_increasing_time(read.seconds, table, layout)
    measured = {column.symbol: _measured(column, table) for column in layout.columns}
    codes = [entry.emptied for entry in measured.values()]
    measured, emptied = without_fixes_at_zero(measured, read.seconds)
    measured, held = _once_each(measured, read.seconds)
    channels = derived_channels(measured, layout.geometry, log.file)
    provenance = Provenance(
        plain_name(log.file), sha256, _notes(f"read as {layout.format}", read.note, *codes, emptied, held)
    )
    return _record(record_name(log.file), read.seconds, channels, layout.scale, provenance)


def record_of_sources(name: str, sources: Sequence[LogSource]) -> Record:
    """The record of several logs or topics, each with its own clock and rate, on one even time base.

    Commands are held, angles unwrapped, the rest is interpolated linearly; what lies in a gap longer than the layout's
    five steps stays NaN. Rate, gaps, geometry and scale are those of the first source.

    Raises:
        InputError: as `assemble_record`; a channel is given twice, or the sources do not overlap in time.
    """
    read = [_series(source) for source in sources]
    series = [one for part in read for one in part.series]
    symbols = [one.column.symbol for one in series]
    for symbol in symbols:
        if symbols.count(symbol) > 1:
            raise InputError(f"run '{name}': channel '{symbol}' is given by two sources; keep one")
    layout = sources[0].layout
    time = common_time(series, layout.rate)
    measured = {one.column.symbol: Measured(one.column, values_at(one, time), one.label) for one in series}
    channels = derived_channels(measured, layout.geometry, name)
    files = ", ".join(dict.fromkeys(plain_name(source.log.file) for source in sources))
    topics = len({one.topic for one in series})
    step = f"{topics} topics of {len(files.split(', '))} files joined every {time[1] - time[0]:.6g} s"
    digest = sources[0].sha256 if len(sources) == 1 else " ".join(source.sha256 for source in sources)
    emptied = [text for part in read for text in part.emptied]
    record = _record(name, time, channels, 1.0, Provenance(files, digest, (*emptied, step)))
    return froude_scaled(_with_source_steps(record, series), layout.scale)


def _with_source_steps(record: Record, series: Sequence[Series]) -> Record:
    """Return the record with the sample interval of its own source in each channel that is one column."""
    steps = {one.column.symbol: one.step for one in series if np.isfinite(one.step) and one.column.symbol in record}
    timed = {symbol: replace(record.channel(symbol), sample_s=step) for symbol, step in steps.items()}
    return replace(record, channels={**record.channels, **timed})


@dataclass(frozen=True, eq=False)
class _SourceSeries:
    """The columns of a source, each with the stamps of its topic, and what was emptied in them."""

    series: list[Series]
    emptied: tuple[str, ...]


def _series(source: LogSource) -> _SourceSeries:
    """Readings that stand for none are emptied here: interpolated with their neighbours nothing would show them."""
    log, layout = source.log, source.layout
    series, emptied = [], []
    tables = {id(table): table for table in (log.table_of(column) for column in layout.columns)}
    for table in tables.values():
        time = stamps(table, _time_column(layout, table)).seconds
        columns = [column for column in layout.columns if log.table_of(column) is table]
        measured, fixes = without_fixes_at_zero({c.symbol: _measured(c, table) for c in columns}, time)
        emptied += [*(entry.emptied for entry in measured.values()), fixes]
        for symbol, one in measured.items():
            measured[symbol], text = without_sentinel(one, time)
            emptied.append(text)
        measured, held = _once_each(measured, time)
        emptied.append(held)
        topic = f"{log.file} {table.topic}"
        series += [ordered_series(one.column, time, _readings(one), one.label, topic) for one in measured.values()]
    order = [column.symbol for column in layout.columns]
    return _SourceSeries(sorted(series, key=lambda one: order.index(one.column.symbol)), _notes(*emptied))


def _time_column(layout: Layout, table: RawTable) -> ColumnSpec:
    """The layout's time column; where it names the one of another topic, that of the table itself."""
    source = layout.time.source
    if isinstance(source, str) and table.time_name and source not in table.names:
        topic, _, name = source.rpartition("/")
        if topic != table.topic and (not topic or name == table.time_name):
            return ColumnSpec("time", "", "s")
    return layout.time


def _measured(column: ColumnSpec, table: RawTable) -> Measured:
    cells = table.numbers(column)
    readings = without_codes(column.symbol, cells)
    values = column.in_si(readings)
    if np.isnan(values[:1]).all() and np.isnan(values).all():
        raise InputError(
            f"{table.title}: {column.display_name} (channel '{column.symbol}') holds no number at all; leave it out"
        )
    count = int(np.sum(np.isfinite(cells) & np.isnan(readings)))
    text = f"'{column.symbol}': {count} of {len(cells)} readings are codes of a standard for none, and {EMPTIED}"
    return Measured(column, values, table.label(column), emptied=text if count else "")


def _once_each(measured: dict[str, Measured], time: Array) -> tuple[dict[str, Measured], str]:
    """The columns of a table with what slower ones repeat marked, and straight between their readings; a sentence."""
    cells = {
        symbol: (unwrapped(one.values) if one.column.quantity.unit == "rad" else one.values)
        / one.column.si_factor(one.column.quantity.unit)
        for symbol, one in measured.items()
        if not one.column.is_held and one.column.span == 1.0
    }
    masks = slower_channels(cells, time)
    slower = {
        symbol: replace(
            measured[symbol],
            values=between_readings(
                measured[symbol].values, mask, is_angle=measured[symbol].column.quantity.unit == "rad"
            ),
            is_measured=mask,
        )
        for symbol, mask in masks.items()
    }
    return measured | slower, held_text(masks, time)


def _readings(one: Measured) -> Array:
    """The values of a column, NaN where it repeats an earlier reading."""
    return one.values if one.is_measured is None else np.where(one.is_measured, one.values, np.nan)


def _notes(*notes: str) -> tuple[str, ...]:
    return tuple(note for note in notes if note)


def _record(name: str, time: Array, measured: dict[str, Measured], scale: float, provenance: Provenance) -> Record:
    channels = {symbol: _channel(one.column, _readings(one), one.label) for symbol, one in measured.items()}
    return froude_scaled(Record(name, time, channels, provenance=provenance), scale)


def _channel(column: ColumnSpec, values: Array, label: str) -> Channel:
    return Channel(
        frozen(values),
        column.quantity.unit,
        column.declared_frame,
        column.declared_positive,
        column.reference_point,
        label,
        kind=column.kind,
        between=column.between,
    )


def record_from_values(
    name: str,
    layout: Layout,
    time: Array,
    values: Array,
    labels: tuple[str, ...] = (),
    provenance: Provenance | None = None,
) -> Record:
    """The record of rows that are numbers already: time (n,) [s], the layout's columns (n, k) [SI], as declared."""
    named = labels or tuple(column.label or column.display_name for column in layout.columns)
    measured = {column.symbol: Measured(column, values[:, k], named[k]) for k, column in enumerate(layout.columns)}
    return _record(name, time, measured, layout.scale, provenance or Provenance(name))


def record_name(file: str) -> str:
    """The record's name: the file's without its ending, ``.gz`` included."""
    return plain_name(Path(file.removesuffix(".gz")).stem)


def _require_increasing_time(time: Array, table: RawTable, layout: Layout) -> None:
    if len(time) > 1 and time[0] < time[-1] and np.all(time[1:] >= time[:-1]):  # usual, at a tenth of the cost
        return
    stamped = np.flatnonzero(np.isfinite(time))
    if stamped.size < 2:
        count = "no time stamp" if stamped.size == 0 else "one sample"
        raise InputError(f"{table.title} has {count} in {layout.time.display_name}; a record needs at least two")
    back = np.flatnonzero(np.diff(time[stamped]) < 0)
    if back.size:
        before, row = stamped[back[0]], stamped[back[0] + 1]
        ends = f"from {moment_text(float(time[before]))} to {moment_text(float(time[row]))}"
        raise InputError(
            f"{table.title}: row {table.first_row + row}: time runs backwards {ends}{_more(back.size)} "
            f"({time[row] - time[before]:.6g} s); sort or split the file"
        )
    if time[stamped[0]] == time[stamped[-1]]:
        raise InputError(
            f"{table.title}: the clock stands still: all {stamped.size} stamps are "
            f"{moment_text(float(time[stamped[0]]))}; write the time by the row, or leave the file out"
        )


def _more(count: int) -> str:
    return f", and {count - 1} times more" if count > 1 else ""
