"""The one table of channel names: symbol, meaning, unit, frame, sign; as people write and read them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values.arrays import Array, unwrapped
from seatrial.core.values.errors import InputError, listed

# What to write for a name that is no channel: the field's other words, else a name that is nearly the same.

ALIASES: dict[str, str] = {
    "latitude": "lat", "longitude": "lon", "lng": "lon", "hdt": "psi", "yaw": "psi", "hdm": "psi_magnetic",
    "hdg": "psi (true heading) or psi_magnetic", "heading": "psi (true heading) or psi_magnetic",
    "rot": 'r with unit = "deg/min"', "yaw_rate": "r", "course": "cog", "vtw": "stw",
    "speed": "sog (over ground) or stw (through water)", "rudder": "delta", "rud": "delta", "rsa": "delta",
    "helm": "delta", "roll": "phi", "heel": "phi", "pitch": "theta", "heave": "z", "surge": "u", "sway": "v",
    "x": "x0", "y": "y0", "rpm": 'n with unit = "rpm", or rpm_1, rpm_2 of several propellers', "azimuth": "alpha_1",
    "pwm": "command_1 with zero and span", "throttle": "command_1 with zero and span",
    **dict.fromkeys(("utc", "t", "time", "timestamp"), "time = { column = ... } beside the channels, not among them"),
    "north": 'x0 (position) or u with frame = "earth"', "east": 'y0 (position) or v with frame = "earth"',
}  # fmt: skip
"""Name that people use -> what to write for a column."""
_DERIVED = {
    "lat": "x0", "lon": "y0", "sog": "u", "cog": "v", "stw": "u", "psi_magnetic": "psi",
    **dict.fromkeys(("q_w", "q_x", "q_y", "q_z"), "psi"),
}  # fmt: skip
_TIME = "time"
_FEWEST_LETTERS, _LIKENESS = 3, 0.75  # of a name that may be meant; ours: one letter of four may differ


def channel_hint(name: str, valid_names: list[str]) -> str:
    """Return the end of a sentence on a name that is no channel: what to write, a name nearly the same, or all names.

    valid_names: the channels there are; of a measurement from which channels derive, that channel is named.
    """
    written = _spelled(name, valid_names)
    if written:
        return f"; did you mean '{written}'?"
    meant = ALIASES.get(name.lower(), name.lower())
    symbol = meant.split()[0].strip(",")
    if symbol in (*valid_names, _TIME) and meant != name.lower():
        return f"; write {meant}"
    if _DERIVED.get(symbol) in valid_names:
        return f"; a record has '{_DERIVED[symbol]}', which follows from it"
    return f"; known are {listed(valid_names)}"


def _spelled(name: str, valid_names: list[str]) -> str:
    """The valid name that differs by its capitals or by a letter or two; empty where there is none."""
    import difflib

    same = [
        valid_name
        for valid_name in valid_names
        if valid_name.lower() == name.lower().replace("-", "_").replace(" ", "_")
    ]
    if same:
        return same[0]
    long = [valid_name for valid_name in valid_names if min(len(valid_name), len(name)) >= _FEWEST_LETTERS]
    swapped = [long_name for long_name in long if sorted(long_name) == sorted(name.lower())]
    near = swapped or difflib.get_close_matches(name.lower(), long, n=1, cutoff=_LIKENESS)
    return near[0] if near and name.lower() not in ALIASES else ""


# Units at the boundary: factors to SI. Inside the package everything is SI and radians.

_DEGREE = math.pi / 180.0  # rad
# unit -> (factor to SI, SI unit); exact by definition (SI brochure 2019; 1 kn = 1852 m/h)
_UNITS: dict[str, tuple[float, str]] = {
    "1": (1.0, "1"), "percent": (0.01, "1"), "s": (1.0, "s"), "ms": (1e-3, "s"), "us": (1e-6, "s"), "ns": (1e-9, "s"),
    "min": (60.0, "s"), "h": (3600.0, "s"), "m": (1.0, "m"), "mm": (1e-3, "m"), "cm": (1e-2, "m"), "km": (1e3, "m"),
    "ft": (0.3048, "m"), "nmi": (1852.0, "m"), "rad": (1.0, "rad"), "deg": (_DEGREE, "rad"), "°": (_DEGREE, "rad"),
    "m/s": (1.0, "m/s"), "km/h": (1.0 / 3.6, "m/s"), "kn": (1852.0 / 3600.0, "m/s"), "kt": (1852.0 / 3600.0, "m/s"),
    "rad/s": (1.0, "rad/s"), "deg/s": (_DEGREE, "rad/s"), "°/s": (_DEGREE, "rad/s"),
    "deg/min": (_DEGREE / 60.0, "rad/s"), "°/min": (_DEGREE / 60.0, "rad/s"), "m/s^2": (1.0, "m/s^2"),
    "g": (9.80665, "m/s^2"), "rps": (1.0, "rps"), "rpm": (1.0 / 60.0, "rps"), "N": (1.0, "N"), "kN": (1e3, "N"),
    "MN": (1e6, "N"), "N m": (1.0, "N m"), "kN m": (1e3, "N m"), "kg": (1.0, "kg"), "t": (1e3, "kg"),
    "kg/m^3": (1.0, "kg/m^3"), "kg m^2": (1.0, "kg m^2"), "V": (1.0, "V"), "mV": (1e-3, "V"), "m^2": (1.0, "m^2"),
    "m^3": (1.0, "m^3"),
}  # fmt: skip
# unit -> spellings that people use, in small letters
_SPELLINGS = {
    "deg": "deg degs degree degrees °", "rad": "rad rads radian radians", "kn": "kn kt kts knt knts knot knots",
    "m/s": "m/s mps ms m/sec", "km/h": "km/h kmh kph", "deg/s": "deg/s deg/sec degrees/s dps °/s",
    "deg/min": "deg/min degrees/min °/min", "rad/s": "rad/s", "rpm": "rpm 1/min rev/min", "rps": "rps 1/s rev/s",
    "m": "m metre metres meter meters", "m/s^2": "m/s2", "kg/m^3": "kg/m3", "V": "v volt volts", "us": "us pwm",
    "percent": "% pct percent",
}  # fmt: skip
UNIT_WORDS: dict[str, str] = {word: unit for unit, words in _SPELLINGS.items() for word in words.split()}
"""Spelling, in small letters -> unit."""


def si_unit(unit: str) -> tuple[float, str]:
    """Return factor and SI unit of a unit.

    Raises:
        InputError: the unit is unknown; the nearest known one is named.
    """
    if unit not in _UNITS:
        raise InputError(f"unknown unit '{unit}'{_unit_hint(unit)}")
    return _UNITS[unit]


def units_like(unit: str) -> list[str]:
    """Return the units of one quantity, given its SI unit; one spelling of each."""
    return [name for name, (_, si) in _UNITS.items() if si == unit and name.isascii() and name != "kt"]


def is_unit(text: str) -> bool:
    """Return whether a text is a unit or one of its usual spellings."""
    return text in _UNITS or text.lower() in UNIT_WORDS


def _unit_hint(unit: str) -> str:
    """The end of a sentence on an unknown unit: how it is written here, else all units."""
    meant = UNIT_WORDS.get(unit.strip().lower()) or next((u for u in _UNITS if u.lower() == unit.strip().lower()), "")
    return f"; write '{meant}'" if meant else f"; known are {listed(list(_UNITS))}"


def display_unit(unit: str) -> tuple[float, str]:
    """Return the factor from SI and the unit for reading: degrees for angles, otherwise SI."""
    return {"rad": (180.0 / math.pi, "deg"), "rad/s": (180.0 / math.pi, "deg/s")}.get(unit, (1.0, unit))


# The one table of channel names: symbol, meaning, unit, frame, sign, LaTeX, standard name.


@dataclass(frozen=True)
class Quantity:
    """Defines what a symbol means: SI unit, frame (body, earth or none), positive direction, LaTeX, standard name."""

    symbol: str
    meaning: str
    unit: str
    frame: str
    positive: str
    latex: str
    standard_name: str


_INDEXED = range(1, 13)
"""Numbers of the channels that a craft has one of for each thruster: ``command_1``, ``alpha_1``, ``rpm_1``; chosen."""

_TABLE = [
    Quantity("x0", "position north", "m", "earth", "north", "x_0", "position_north"),
    Quantity("y0", "position east", "m", "earth", "east", "y_0", "position_east"),
    Quantity("psi", "heading", "rad", "earth", "starboard", r"\psi", "platform_yaw"),
    Quantity("u", "surge velocity", "m/s", "body", "forward", "u", "platform_surge_rate"),
    Quantity("v", "sway velocity", "m/s", "body", "starboard", "v", "platform_sway_rate"),
    Quantity("r", "yaw rate", "rad/s", "body", "starboard", "r", "platform_yaw_rate"),
    Quantity("phi", "roll angle", "rad", "body", "starboard", r"\phi", "platform_roll"),
    Quantity("p", "roll rate", "rad/s", "body", "starboard", "p", "platform_roll_rate"),
    Quantity("theta", "pitch angle", "rad", "body", "bow up", r"\theta", "platform_pitch"),
    Quantity("z", "heave", "m", "body", "down", "z", "platform_heave"),
    Quantity("z_dot", "heave velocity", "m/s", "body", "down", r"\dot z", "platform_heave_rate"),
    Quantity("theta_dot", "pitch rate", "rad/s", "body", "bow up", r"\dot\theta", "platform_pitch_rate"),
    Quantity("zeta", "wave elevation at the ship's origin", "m", "earth", "up", r"\zeta", "sea_surface_height"),
    *(
        Quantity(f"zeta_{k}", f"wave elevation at probe {k}", "m", "earth", "up", rf"\zeta_{k}", f"wave_elevation_{k}")
        for k in range(1, 7)  # the six probes of a towing tank
    ),
    Quantity("x_wm", "position of the wave maker", "m", "earth", "forward", "x_{wm}", "wave_maker_position"),
    Quantity("F_y", "sway force of the holding on the model", "N", "body", "starboard", "F_y", "holding_sway_force"),
    Quantity("S_1", "tension of the starboard spring", "N", "none", "tension", "S_1", "spring_tension_1"),
    Quantity("S_2", "tension of the port spring", "N", "none", "tension", "S_2", "spring_tension_2"),
    Quantity("z_ddot_1", "heave acceleration starboard", "m/s^2", "body", "down", r"\ddot z_1", "heave_acceleration_1"),
    Quantity("z_ddot_2", "heave acceleration port", "m/s^2", "body", "down", r"\ddot z_2", "heave_acceleration_2"),
    Quantity("omega_e", "frequency of encounter", "rad/s", "none", "none", r"\omega_e", "encounter_frequency"),
    Quantity("F2", "sway force of the waves", "N", "body", "starboard", "F_2", "wave_sway_force"),
    Quantity("F3", "heave force of the waves", "N", "body", "up", "F_3", "wave_heave_force"),
    Quantity("M4", "roll moment of the waves", "N m", "body", "starboard", "M_4", "wave_roll_moment"),
    Quantity("M5", "pitch moment of the waves", "N m", "body", "bow down", "M_5", "wave_pitch_moment"),
    Quantity("delta_f1", "angle of the first fin", "rad", "body", "up", r"\delta_{f1}", "fin_angle_1"),
    Quantity("delta_f2", "angle of the second fin", "rad", "body", "up", r"\delta_{f2}", "fin_angle_2"),
    Quantity("alpha_w", "effective wave slope across the ship", "rad", "body", "starboard", r"\alpha_w", "wave_slope"),
    Quantity("alpha_f", "angle of the roll fins", "rad", "body", "starboard", r"\alpha_f", "roll_fin_angle"),
    Quantity("delta", "rudder or nozzle angle", "rad", "body", "starboard", r"\delta", "rudder_angle"),
    Quantity("n", "propeller rate", "rps", "none", "ahead", "n", "propeller_rate"),
    Quantity("v_j", "jet velocity", "m/s", "body", "aft", "v_j", "waterjet_velocity"),
    Quantity("bucket", "share of the jet that the reversing bucket sends forward", "1", "none", "astern", "b",
             "bucket_share"),
    *(
        Quantity(f"{symbol}_difference", f"{meaning}, port less starboard", unit, "body", positive, rf"\Delta {latex}",
                 f"{name}_difference")
        for symbol, meaning, unit, positive, latex, name in (
            ("delta", "rudder or nozzle angle", "rad", "none", r"\delta", "rudder_angle"),
            ("n", "propeller rate", "rps", "starboard", "n", "propeller_rate"),
            ("v_j", "jet velocity", "m/s", "starboard", "v_j", "waterjet_velocity"),
            ("bucket", "share of the jet sent forward", "1", "port", "b", "bucket_share"),
        )
    ),
    Quantity("depth", "depth of the water at rest", "m", "none", "down", "h", "sea_floor_depth_below_sea_surface"),
    Quantity("thrust", "propeller thrust", "N", "body", "forward", "T_P", "propeller_thrust"),
    Quantity("torque", "propeller torque", "N m", "none", "ahead", "Q_P", "propeller_torque"),
    Quantity("u_dot", "surge acceleration", "m/s^2", "body", "forward", r"\dot u", "platform_surge_acceleration"),
    Quantity("v_dot", "sway acceleration", "m/s^2", "body", "starboard", r"\dot v", "platform_sway_acceleration"),
    Quantity("wind_speed", "true wind speed", "m/s", "earth", "none", "V_w", "wind_speed"),
    Quantity("wind_direction", "direction the true wind comes from, as a heading", "rad", "earth", "starboard",
             r"\gamma_w", "wind_from_direction"),
    Quantity("wind_speed_relative", "apparent wind speed", "m/s", "body", "none", "V_A", "apparent_wind_speed"),
    Quantity("wind_direction_relative", "direction the apparent wind comes from, off the bow", "rad", "body",
             "starboard", r"\gamma_A", "apparent_wind_from_direction"),
    Quantity("psi_ref", "ordered heading", "rad", "earth", "starboard", r"\psi_{ref}", "ordered_heading"),
    Quantity("r_ref", "ordered yaw rate", "rad/s", "body", "starboard", "r_{ref}", "ordered_yaw_rate"),
    Quantity("phi_ref", "ordered roll angle", "rad", "body", "starboard", r"\phi_{ref}", "ordered_roll_angle"),
    Quantity("delta_ref", "ordered rudder or nozzle angle", "rad", "body", "starboard", r"\delta_{ref}",
             "ordered_rudder_angle"),
    Quantity("alpha_f_ref", "ordered angle of the roll fins", "rad", "body", "starboard", r"\alpha_{f,ref}",
             "ordered_roll_fin_angle"),
    Quantity("voltage", "voltage of the batteries", "V", "none", "none", "V", "battery_voltage"),
    *(
        Quantity(f"{letter}_{k}", f"{meaning} {k}", unit, frame, positive, rf"{latex}_{{{k}}}", f"{name}_{k}")
        for letter, meaning, unit, frame, positive, latex, name in (
            ("command", "command of thruster", "1", "none", "ahead", "c", "thruster_command"),
            ("alpha", "direction of the thrust of thruster", "rad", "body", "starboard", r"\alpha", "thruster_angle"),
            ("rpm", "rate of the propeller of thruster", "rps", "none", "ahead", "n", "thruster_rate"),
        )
        for k in _INDEXED
    ),
]  # fmt: skip

COMMANDS = tuple(f"{letter}_{k}" for letter in ("command", "alpha", "rpm") for k in _INDEXED)
"""Channels of thrusters: what is ordered or follows an order, never a measurement to be smoothed."""

TWIN_DIFFERENCES: dict[str, str] = {s: f"{s}_difference" for s in ("delta", "n", "v_j", "bucket")}
"""Channel of the mean of two rudders, screws, nozzles or buckets -> that of their difference, port less starboard."""

REFERENCES = ("psi_ref", "r_ref", "phi_ref", "delta_ref", "alpha_f_ref")
"""Channels of what a controller, a steering gear or fins are ordered to hold."""

# positive direction -> its opposite, both ways
_PAIRS = {
    "starboard": "port", "north": "south", "east": "west", "forward": "aft", "up": "down", "bow up": "bow down",
    "ahead": "astern",
}  # fmt: skip
OPPOSITE: dict[str, str] = _PAIRS | {other: first for first, other in _PAIRS.items()}
_POSITIVE_ON_EARTH = {"u": "north", "v": "east", "u_dot": "north", "v_dot": "east"}

NOTATION: dict[str, Quantity] = {quantity.symbol: quantity for quantity in _TABLE}


def quantity(symbol: str) -> Quantity:
    """Return the entry of a symbol.

    Raises:
        InputError: the symbol is not in the table; the nearest one is named.
    """
    if symbol not in NOTATION:
        raise InputError(f"unknown channel '{symbol}'{channel_hint(symbol, sorted(NOTATION))}")
    return NOTATION[symbol]


def positive_direction(symbol: str, frame: str) -> str:
    """Return the positive direction of a channel in a frame: north or east for earth-fixed velocities.

    Raises:
        InputError: as `quantity`.
    """
    if frame == "earth" and symbol in _POSITIVE_ON_EARTH:
        return _POSITIVE_ON_EARTH[symbol]
    return quantity(symbol).positive


# Names, letters, meanings and units of channels as people read them.

# channels whose letter differs from their name
_LETTERS = {
    "psi": "ψ", "delta": "δ", "delta_f1": "δ₁", "delta_f2": "δ₂", "phi": "φ", "theta": "θ", "alpha_f": "α",
    "x0": "x₀", "y0": "y₀", "v_j": "vⱼ",
    "wind_speed": "wind", "wind_direction": "wind from", "wind_speed_relative": "app. wind",
    "wind_direction_relative": "app. wind from",
}  # fmt: skip
POSITIONS = ("x0", "y0")
READING_ORDER = (
    "psi", "r", "u", "v", "phi", "p", "thrust", "torque", "delta", "n", "v_j", "wind_speed", "wind_direction",
)  # fmt: skip


def unit_text(si: str) -> str:
    """Return the unit people read for an SI unit, with raised powers; empty for numbers."""
    unit = display_unit(si)[1]
    return "" if unit == "1" else unit.replace("^2", "²").replace("^3", "³")


def channel_unit(channel: str) -> str:
    """Return the SI unit of a channel of the notation table, ``1`` for others."""
    return NOTATION[channel].unit if channel in NOTATION else "1"


def channel_meaning(channel: str) -> str:
    """Return what a channel is: ``psi`` -> heading; the name itself for others."""
    return NOTATION[channel].meaning if channel in NOTATION else channel


def channel_letter(channel: str) -> str:
    """Return the letter of a channel: ``psi`` -> ψ."""
    return _LETTERS.get(channel, channel)


def channel_label(channel: str, si: str) -> str:
    """Return the letter of a channel with the unit people read: ``ψ [deg]``."""
    unit = display_unit(si)[1]
    return channel_letter(channel) if unit == "1" else f"{channel_letter(channel)} [{unit}]".strip()


def display_values(channel: str, values: Array, si: str) -> Array:
    """Return values in the unit people read; headings without wrap, from within a half turn of north."""
    if channel == "psi" and np.isfinite(values).any():
        values = unwrapped(values)
        values = values - 2.0 * np.pi * np.round(values[np.isfinite(values)][0] / (2.0 * np.pi))
    return values * display_unit(si)[0]


def reading_order(channels: Sequence[str]) -> list[str]:
    """Return channels in the order of reading, positions left out."""
    names = [s for s in dict.fromkeys(channels) if s not in POSITIONS]
    return sorted(names, key=lambda s: (READING_ORDER.index(s) if s in READING_ORDER else len(READING_ORDER), s))
