"""Channels of a record out of what a log measures: positions on a plane, velocities, headings."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.core.values.arrays import Mask
from seatrial.data.read.layout import ColumnSpec, Geometry
from seatrial.data.read.quantities import LOG_QUANTITIES

_QUATERNION = ("q_w", "q_x", "q_y", "q_z")
_ENU_PAIRS = (("x0", "y0"), ("u", "v"), ("u_dot", "v_dot"))


@dataclass(frozen=True, eq=False)
class Measured:
    """A column in SI units, shape (n,), with what is declared about it.

    is_measured: shape (n,), False in rows that repeat an earlier reading; None: every row is a reading.
    """

    column: ColumnSpec
    values: Array
    label: str
    is_measured: Mask | None = None

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
