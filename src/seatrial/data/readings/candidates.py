"""What a column, or a pair of columns, may be: units, frames, signs, zeros, each with its share among logs."""

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import product
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, si_unit
from seatrial.core.values.notation import NOTATION, OPPOSITE, positive_direction
from seatrial.data.readings.grids import Grid, Samples, Signal

ROLES = {
    ("lat", "lon"): "fixes", ("x0", "y0"): "place", ("u", "v"): "velocity", ("q_w", "q_x", "q_y", "q_z"): "heading",
    ("wind_speed", "wind_direction"): "wind", ("wind_speed_relative", "wind_direction_relative"): "apparent wind",
    ("psi",): "heading", ("psi_magnetic",): "heading",
}  # fmt: skip
"""Columns that are read together -> what they show; a column by itself shows its symbol."""
# nats against a unit or sign that the heading or the logger's documentation contradicts, and against a size beyond
# what is possible, or numbers too coarse, or a wrap at another turn; chosen as in docs/logs.md
CONTRADICTED, IMPOSSIBLE, COARSE, OTHER_TURN = 8.0, 14.0, 7.0, 16.0
STATED = 5.0  # nats against a reading that a trial file contradicts: 1 statement in 150 is wrong; chosen
SAME_TURN = 4.0  # nats for the unit in whose full turn an angle jumps; chosen
_COARSEST = 0.05  # step from which numbers are degrees rather than radians; chosen
_ROUNDING = 1e-3  # of a step, by which it may miss a round number; chosen
_TURN_SLACK = 1.001  # of a full turn, by which rounded numbers may miss it; chosen
_EARTH_RADIUS = 6371000.8  # m, mean of the ellipsoid of WGS 84 (NIMA TR 8350.2, 3rd ed., table 3.2-1)


@dataclass(frozen=True)
class ColumnReading:
    """How one column is read: the number in its unit is cell * factor + offset, positive as said in its frame."""

    symbol: str
    unit: str = ""
    frame: str = ""
    positive: str = ""
    offset: float = 0.0
    factor: float = 1.0


@dataclass(frozen=True, eq=False)
class NamedColumn:
    """A column with what its heading says of it; empty words are not said.

    is_documented: whether the documentation of its logger says so.
    is_side_said: whether sentences above the table say the side.
    is_stated: whether a trial file states all of the reading, by which the numbers have come to SI units.
    offsets: zeros that are tried beside the usual ones.
    """

    reading: ColumnReading
    samples: Samples
    is_documented: bool = False
    is_side_said: bool = False
    is_stated: bool = False
    offsets: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class JointReading:
    """One way to read the columns of a variable together.

    Attributes:
        readings: of its columns, in order.
        parts: why -> nats for it, by itself.
        slots: what it shows, on each grid.
        contradicts: what the heading says otherwise; empty: nothing.
    """

    readings: tuple[ColumnReading, ...]
    parts: Mapping[str, float]
    slots: Mapping[str, tuple[Signal, ...]] = field(default_factory=dict)
    contradicts: str = ""

    @cached_property
    def own_nats(self) -> float:
        """Nats of its parts."""
        return sum(self.parts.values())

    @cached_property
    def system(self) -> str:
        """Its unit of angles, deg or rad; empty where it has none."""
        return next((r.unit.partition("/")[0] for r in self.readings if r.unit[:3] in ("deg", "rad")), "")


@dataclass(frozen=True, eq=False)
class ColumnGroup:
    """Columns that are read together, what they show, and their candidates; first of them what a trial file states."""

    role: str
    columns: tuple[NamedColumn, ...]
    candidates: tuple[JointReading, ...]


_Readings = tuple[ColumnReading, ...]
_TURN_DEG = 360.0  # deg, of a turn: 360 lies beside 0
_JUMPS_OVER_STEPS = 5.0  # of the largest of a hundred steps, by which readings jump to a code; chosen


@cache
def shares() -> Mapping[str, Mapping]:
    """Return the table of shares and sizes."""
    return tomllib.loads(Path(__file__).with_name("shares.toml").read_text(encoding="utf-8"))


@cache
def name_table() -> Mapping[str, Mapping]:
    """Return the table of names."""
    return tomllib.loads(Path(__file__).with_name("names.toml").read_text(encoding="utf-8"))


def without_codes(symbol: str, cells: Array) -> Array:
    """Return numbers of a column (n,) with those empty that mean no reading in a standard.

    A code lies beyond all other numbers, and readings jump to it: a heading of 360.0 between 359 and 1 is none.
    """
    for code in name_table()["codes"].get(symbol, ()):
        rows = cells == code
        numbers = cells[np.isfinite(cells) & ~rows]
        if not rows.any() or (numbers.size and np.min(numbers) <= code <= np.max(numbers)):
            continue
        before = np.flatnonzero(np.isfinite(cells[:-1]) & ~rows[:-1] & rows[1:])
        usual = np.percentile(np.abs(np.diff(numbers)), 99.0) if numbers.size > 1 else 0.0  # of a hundred steps
        jumps = np.abs(cells[before] - code)
        jumps = np.minimum(jumps, np.abs(_TURN_DEG - jumps)) if code == _TURN_DEG else jumps
        if np.median(jumps) > _JUMPS_OVER_STEPS * usual if before.size else abs(code) != _TURN_DEG:
            cells = np.where(rows, np.nan, cells)
    return cells


def variable(columns: Sequence[NamedColumn], on: Sequence[Grid]) -> ColumnGroup:
    """Return columns that are read together with all their candidates."""
    symbols = tuple(entry.reading.symbol for entry in columns)
    role = ROLES.get(symbols, symbols[0])
    options = []
    for readings, parts in _combined(role, columns):
        sizes = [_fit(entry, column.samples) for entry, column in zip(readings, columns, strict=True)]
        own_nats = {**parts, **{why: sum(size.get(why, 0.0) for size in sizes) for why in ("size", "turn", "step")}}
        own_nats["stated"] = -STATED * _departures(columns, readings) if columns[0].is_stated else 0.0
        pairs = zip(columns, readings, strict=True)
        contradicts = next((text for pair in pairs if (text := _contradicted(*pair))), "")
        options.append(JointReading(readings, own_nats, _slots(role, readings, columns, on), contradicts))
    return ColumnGroup(role, tuple(columns), tuple(options))


def _departures(columns: Sequence[NamedColumn], readings: _Readings) -> int:
    """How many of unit, frame, side and zero are not as they are stated."""
    pairs = [(column.reading, reading) for column, reading in zip(columns, readings, strict=True)]
    keys = ("factor", "frame", "positive", "offset")
    return sum(any(getattr(stated, key) != getattr(read, key) for stated, read in pairs) for key in keys)


def is_impossible(reading: ColumnReading, samples: Samples) -> bool:
    """Return whether the numbers so read are beyond what the quantity can be."""
    return _fit(reading, samples).get("size", 0.0) <= -IMPOSSIBLE


def _contradicted(column: NamedColumn, reading: ColumnReading) -> str:
    stated = column.reading
    if column.is_side_said and stated.positive != reading.positive:
        return f'positive = "{stated.positive}"'
    return f'unit = "{stated.unit}"' if stated.unit and stated.unit != reading.unit else ""


def _combined(role: str, columns: Sequence[NamedColumn]) -> Iterator[tuple[_Readings, dict[str, float]]]:
    """The readings of all columns together: one unit for a pair, frames alike."""
    lead = columns[0]
    for (unit, factor, unit_share), (frame, frame_share) in product(_units(lead), _frames(role, lead)):
        plain = [replace(column.reading, frame=frame or column.reading.frame) for column in columns]
        plain[0] = replace(plain[0], unit=unit, factor=factor)
        plain[1:] = [
            replace(entry, unit=unit, factor=factor) if _kind(entry.symbol) == _kind(plain[0].symbol) else
            replace(entry, unit=entry.unit or _units(column)[0][0])
            for entry, column in zip(plain[1:], columns[1:], strict=True)
        ]  # fmt: skip
        for signed, sign_share in _signed(plain, columns):
            for zeroed, zero_share in _zeroed(role, signed, lead.offsets):
                parts = {"unit": unit_share, "frame": frame_share, "sign": sign_share, "zero": zero_share}
                yield zeroed, parts


def _kind(symbol: str) -> str:
    if symbol in NOTATION:
        return NOTATION[symbol].unit
    return {"sog": "m/s", "stw": "m/s"}.get(symbol, "1" if symbol.startswith("q_") else "rad")


def quantity_frame(symbol: str) -> str:
    """Return the frame of a quantity where none is said."""
    return NOTATION[symbol].frame if symbol in NOTATION else "earth"


def _units(column: NamedColumn) -> list[tuple[str, float, float]]:
    """Unit, factor and nats; parts of a unit where the numbers are beyond all plain ones."""
    stated = column.reading
    usual = shares()["units"].get(_kind(stated.symbol), {_kind(stated.symbol): 1.0})
    if column.is_stated:
        mistaken = ((factor, math.log(share)) for (_, _, factor), share in mistaken_units(stated.symbol).items())
        return [(stated.unit, 1.0, 0.0), *((stated.unit, *entry) for entry in mistaken)]
    if stated.unit:
        against = [(unit, stated.factor, -CONTRADICTED) for unit in usual if unit != stated.unit]
        options = [(stated.unit, stated.factor, 0.0), *(against if not column.is_documented else [])]
    else:
        options = [(unit, stated.factor, math.log(share)) for unit, share in usual.items()]
    if stated.factor != 1.0 or not all(
        is_impossible(replace(stated, unit=unit), column.samples) for unit, _, _ in options if unit in usual
    ):
        return options
    scales = shares()["scales"]
    scaled = [(options[0][0], factor, math.log(scales["share"])) for factor in scales.get(stated.symbol, ())]
    return [*options, *scaled]


def mistaken_units(symbol: str) -> dict[tuple[str, str, float], float]:
    """Return (stated unit, true unit, factor from numbers by the first to those by the second) -> share among logs."""
    usual = shares()["units"].get(_kind(symbol), {})
    units = {
        (stated, unit, si_unit(unit)[0] / si_unit(stated)[0]): share
        for stated in usual for unit, share in usual.items() if stated != unit
    }  # fmt: skip
    scales = shares()["scales"]
    return units | {(_kind(symbol), "", factor): scales["share"] for factor in scales.get(symbol, ())}


def _frames(role: str, lead: NamedColumn) -> list[tuple[str, float]]:
    """Frames of a role with nats; empty: the one that is said."""
    stated, other = lead.reading, shares()["frames"]
    match role if not lead.is_documented else "":
        case "velocity" if stated.frame != "enu":
            first, second = ("earth", "body") if stated.frame == "earth" else ("body", "earth")
            share = other["named velocity" if stated.frame and not lead.is_stated else "velocity"]
            return [(first, math.log(1.0 - share)), (second, math.log(share))]
        case "place" | "heading" if stated.frame == "enu":
            return [("enu", 0.0), ("earth", 0.0)]  # of a pose of ROS, which recommends the first (REP 103)
        case "place":
            share = other["named axes" if stated.frame and not lead.is_stated else "axes"]
            return [(stated.frame, math.log(1.0 - share)), ("enu", math.log(share))]
        case "heading" if stated.symbol == "psi":
            return [("", math.log(1.0 - other["heading"])), ("enu", math.log(other["heading"]))]
        case _:
            return [("", 0.0)]


def _signed(readings: Sequence[ColumnReading], columns: Sequence[NamedColumn]) -> list[tuple[_Readings, float]]:
    """The readings with each combination of signs, with nats."""
    options: list[tuple[_Readings, float]] = [((), 0.0)]
    for reading, column in zip(readings, columns, strict=True):
        share = shares()["opposite"].get(reading.symbol, 0.0)
        is_by_lever = column.is_stated and reading.symbol == "v"  # of another point sway turns round: `closure` decides
        if reading.frame == "enu" or not share or reading.symbol not in NOTATION or is_by_lever:
            choices = [(reading, 0.0)]
        else:
            opposite = reversed_reading(reading)
            share = shares()["opposite"]["of stated"] if column.reading.positive else share
            share = shares()["opposite"]["of sentences"] if column.is_side_said else share
            share = math.exp(-CONTRADICTED) if column.is_documented else share
            choices = [(reading, math.log(1.0 - share)), (opposite, math.log(share))]
        options = [((*before, entry), nats + more) for before, nats in options for entry, more in choices]
    return options


def reversed_reading(reading: ColumnReading) -> ColumnReading:
    """Return the reading that counts to the other side."""
    opposite = OPPOSITE[positive_direction(reading.symbol, reading.frame)]
    return replace(reading, positive="" if reading.positive == opposite else opposite)


def _zeroed(role: str, readings: _Readings, offsets: Sequence[float]) -> list[tuple[_Readings, float]]:
    """The readings with each zero, with nats."""
    zeros = shares()["zeros"].get(readings[0].symbol, {}) if len(readings) == 1 else {}
    if not zeros or readings[0].frame == "enu" or role == "place":
        return [(readings, 0.0)]
    unit = si_unit("deg")[0] if readings[0].unit == "rad" else 1.0
    by_offset = [(float(zero) * unit, share) for zero, share in zeros.items()]
    by_offset += [(offset, min(zeros.values())) for offset in offsets]
    plain = (readings, math.log(1.0 - sum(zeros.values())))
    return [plain, *(((replace(readings[0], offset=offset),), math.log(share)) for offset, share in by_offset)]


def _fit(reading: ColumnReading, samples: Samples) -> dict[str, float]:
    """Nats for the size of the numbers, for the turn at which they jump and for their steps."""
    kind, (factor, _) = _kind(reading.symbol), si_unit(reading.unit or "1")
    parts: dict[str, float] = {}
    sized = reading.unit if kind == "rps" else reading.symbol.partition("_")[0]
    sized = sized if sized in ("alpha", "rpm", "rps") else reading.symbol
    if sized in shares()["sizes"] and samples.readings[1].size:
        usual, spread, limit = shares()["sizes"][sized]
        factor = 1.0 if kind == "rps" else factor
        about = _level(samples) if reading.symbol in ("phi", "theta") else samples.readings[1]
        largest = float(np.max(np.abs(about * reading.factor + reading.offset))) * factor
        nats = -0.5 * (math.log(max(largest, 1e-6) / usual) / spread) ** 2  # a log-normal's; never log of zero
        parts["size"] = -IMPOSSIBLE if largest > limit * _TURN_SLACK else max(nats, -IMPOSSIBLE / 2.0)
    if kind == "rad":
        turn = math.tau / factor / reading.factor
        if samples.turn:
            parts["turn"] = SAME_TURN if abs(samples.turn / turn - 1.0) < _TURN_SLACK - 1.0 else -OTHER_TURN
        step = samples.resolution * reading.factor
        if step and reading.unit in ("deg", "rad"):
            is_other = step >= _COARSEST if reading.unit == "rad" else _is_of_degrees(step)
            parts["step"] = -COARSE if is_other else 0.0
    return parts


def _is_of_degrees(step: float) -> bool:
    """Whether a step is a round part of a degree in radians, and no round number itself."""
    return _is_round(math.degrees(step)) and not _is_round(step)


def _is_round(step: float) -> bool:
    """Whether a step is 1, 2 or 5 times a power of ten, as numbers are rounded to."""
    mantissa = step / 10.0 ** math.floor(math.log10(step) + _ROUNDING)
    return any(abs(mantissa / digit - 1.0) < _ROUNDING for digit in (1.0, 2.0, 5.0))  # leading digits of steps


def _level(samples: Samples) -> Array:
    """The unwrapped readings, by whole turns as near zero as can be."""
    cells = samples.unwrapped
    return cells - samples.turn * np.round(np.mean(cells) / samples.turn) if samples.turn else cells


def in_si(reading: ColumnReading, cells: Array) -> Array:
    """Return numbers of a column in SI units and the notation table's sign, angles from north or upright."""
    values = (cells * reading.factor + reading.offset) * si_unit(reading.unit or "1")[0]
    if reading.symbol not in NOTATION or reading.frame == "enu":
        return values
    is_reversed = reading.positive not in ("", positive_direction(reading.symbol, reading.frame))
    return -values if is_reversed else values


def _slots(
    role: str, readings: Sequence[ColumnReading], columns: Sequence[NamedColumn], on: Sequence[Grid]
) -> dict[str, tuple[Signal, ...]]:
    """What the readings show on each grid."""
    by_grid: list[dict[str, Signal]] = []
    for grid in on:
        pairs = zip(readings, columns, strict=True)
        values = [in_si(reading, grid.means(column.samples)) for reading, column in pairs]
        by_grid.append(dict(_slot_values(role, readings, values)))
    return {slot: tuple(entry[slot] for entry in by_grid) for slot in (by_grid[0] if by_grid else ())}


def _slot_values(role: str, readings: Sequence[ColumnReading], values: Sequence[Array]) -> Iterator[tuple[str, Signal]]:
    is_enu = readings[0].frame == "enu"
    match role:
        case "fixes":
            lat, lon = (
                float(np.mean(angles[np.isfinite(angles)])) if np.isfinite(angles).any() else 0.0 for angles in values
            )
            north = _EARTH_RADIUS * (values[0] - lat)
            east = _EARTH_RADIUS * math.cos(lat) * (values[1] - lon)
            yield "track", north + 1j * east
        case "place":
            yield "track", values[1] + 1j * values[0] if is_enu else values[0] + 1j * values[1]
        case "velocity":
            pair = values[1] + 1j * values[0] if is_enu else values[0] + 1j * values[1]
            yield "over ground" if readings[0].frame in ("earth", "enu") else "along the hull", pair
        case "heading" if len(values) > 1:
            w, x, y, z = values
            yaw = np.unwrap(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))  # Fossen 2021, eq. 2.79
            yield "psi", np.pi / 2.0 - yaw if is_enu else yaw
        case "heading":
            yield "psi", np.pi / 2.0 - values[0] if is_enu else values[0]
        case "wind" | "apparent wind":
            yield role, values[0] * np.exp(1j * values[1])
        case _:
            yield role, values[0]
