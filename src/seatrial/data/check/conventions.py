"""Declared conventions to the notation table's: sign, frame, reference point, unwrapped angles."""

from dataclasses import replace

import numpy as np

from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Channel, InputError, Record, quantity
from seatrial.core.values.arrays import unwrapped
from seatrial.core.values.notation import COMMANDS, NOTATION, OPPOSITE, positive_direction

_VELOCITY_PAIRS = (("u", "v"), ("u_dot", "v_dot"))
_UNWRAPPED_CHANNELS = (
    "psi", "wind_direction", "wind_direction_relative", *(c for c in COMMANDS if c.startswith("alpha"))
)  # fmt: skip


def canonical_record(record: Record, reference_point: float = 0.0) -> Record:
    """Return the record in the notation table's conventions, by its declared metadata only.

    Every channel points in the table's positive direction (positive rudder turns to starboard), u and v are body-fixed,
    v, x0 and y0 refer to the point `reference_point` metres forward of midship, headings and wind angles are
    unwrapped. Applying it twice changes nothing.

    Raises:
        InputError: a positive direction is unknown, or the heading or yaw rate a conversion needs is missing.
    """
    return _moved_to_reference_point(_in_body_axes(with_standard_signs(record)), reference_point)


def with_standard_signs(record: Record) -> Record:
    """Return the record with the table's signs and angles unwrapped; frames and reference points as they were.

    Raises:
        InputError: a positive direction is neither the notation table's nor its opposite.
    """
    flipped = [s for s, c in record.channels.items() if _has_opposite_sign(s, c, record.name)]
    channels = {s: _with_standard_sign(s, c, flip=s in flipped) for s, c in record.channels.items()}
    record = replace(record, channels=channels)
    return record.with_step(f"sign of {', '.join(flipped)} turned") if flipped else record


def _has_opposite_sign(symbol: str, channel: Channel, record: str) -> bool:
    if symbol not in NOTATION:
        return False
    wanted = positive_direction(symbol, channel.frame)
    if channel.positive == wanted:
        return False
    if channel.positive != OPPOSITE.get(wanted):
        either = f"'{wanted}' or '{OPPOSITE[wanted]}'" if wanted in OPPOSITE else f"'{wanted}'"
        raise InputError(f"record '{record}', channel '{symbol}': positive must be {either}, not '{channel.positive}'")
    return True


def _with_standard_sign(symbol: str, channel: Channel, *, flip: bool) -> Channel:
    values = -channel.values if flip else channel.values
    if symbol in _UNWRAPPED_CHANNELS:
        values = unwrapped(values)
    positive = positive_direction(symbol, channel.frame) if symbol in NOTATION else channel.positive
    return replace(channel.with_values(values), positive=positive)


def _in_body_axes(record: Record) -> Record:
    """u = x0' cos(psi) + y0' sin(psi), v = -x0' sin(psi) + y0' cos(psi) (Fossen 2021, eq. 2.42 inverted)."""
    for a, b in _VELOCITY_PAIRS:
        frames = {s: record.channel(s).frame for s in (a, b) if s in record}
        if "earth" not in frames.values():
            continue
        if set(frames.values()) != {"earth"} or len(frames) < 2 or "psi" not in record:
            raise InputError(
                f"record '{record.name}': turning earth-fixed {a}, {b} into the ship's axes needs both of them "
                "and the heading 'psi'"
            )
        c, s = np.cos(record["psi"]), np.sin(record["psi"])
        north, east = record.channel(a), record.channel(b)
        ahead = _body_fixed_channel(a, north, north.values * c + east.values * s)
        aside = _body_fixed_channel(b, east, east.values * c - north.values * s)
        record = record.with_channel(a, ahead).with_channel(b, aside, f"{a}, {b} turned into the ship's axes")
    return record


def _body_fixed_channel(symbol: str, channel: Channel, values: Array) -> Channel:
    return replace(channel.with_values(values), frame="body", positive=quantity(symbol).positive)


def _moved_to_reference_point(record: Record, reference_point: float) -> Record:
    """v_P = v + d r, x_P = x + d cos(psi), y_P = y + d sin(psi), d = distance to P (Fossen 2021, section 2.3)."""
    moved, places = [], list[str]()
    for symbol, needed in (("v", "r"), ("v_dot", "r"), ("x0", "psi"), ("y0", "psi")):
        if symbol not in record:
            continue
        channel = record.channel(symbol)
        distance = reference_point - channel.reference_point
        if distance != 0.0:
            if needed not in record:
                raise InputError(
                    f"record '{record.name}': moving '{symbol}' to a point {distance:+g} m off needs channel '{needed}'"
                )
            values = channel.values + distance * _lever(symbol, record)
            record = record.with_channel(symbol, replace(channel.with_values(values), reference_point=reference_point))
            moved.append(symbol)
            places.append(f"{channel.reference_point:g} m")
    same = {s: replace(record.channel(s), reference_point=reference_point) for s in ("u", "u_dot") if s in record}
    record = replace(record, channels={**record.channels, **same})
    if not moved:
        return record
    origin = enumeration(list(dict.fromkeys(places)))
    return record.with_step(f"{', '.join(moved)} moved from x = {origin} to {reference_point:g} m from midship")


def _lever(symbol: str, record: Record) -> Array:
    if symbol in ("x0", "y0"):
        return (np.cos if symbol == "x0" else np.sin)(record["psi"])
    return record["r"] if symbol == "v" else np.gradient(record["r"], record.time)
