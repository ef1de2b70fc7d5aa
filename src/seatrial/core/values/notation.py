"""The one table of channel names: symbol, meaning, unit, frame, sign, LaTeX, standard name.

Axes: earth-fixed x0 north (or along the basin), y0 east, psi clockwise from x0;
body-fixed x forward, y starboard, z down (ITTC 2021 symbols; SNAME 1950; Fossen 2021, section 2.1).
"""

from dataclasses import dataclass

from seatrial.core.values.channel_names import channel_hint
from seatrial.core.values.errors import InputError


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
    Quantity("F3", "heave force of the waves", "N", "body", "up", "F_3", "wave_heave_force"),
    Quantity("M5", "pitch moment of the waves", "N m", "body", "bow down", "M_5", "wave_pitch_moment"),
    Quantity("delta_f1", "angle of the first fin", "rad", "body", "up", r"\delta_{f1}", "fin_angle_1"),
    Quantity("delta_f2", "angle of the second fin", "rad", "body", "up", r"\delta_{f2}", "fin_angle_2"),
    Quantity("alpha_w", "effective wave slope across the ship", "rad", "body", "starboard", r"\alpha_w", "wave_slope"),
    Quantity("alpha_f", "angle of the roll fins", "rad", "body", "starboard", r"\alpha_f", "roll_fin_angle"),
    Quantity("delta", "rudder or nozzle angle", "rad", "body", "starboard", r"\delta", "rudder_angle"),
    Quantity("n", "propeller rate", "rps", "none", "ahead", "n", "propeller_rate"),
    Quantity("v_j", "jet velocity", "m/s", "body", "aft", "v_j", "waterjet_velocity"),
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

REFERENCES = ("psi_ref", "r_ref", "phi_ref")
"""Channels of what a controller is ordered to hold."""

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
