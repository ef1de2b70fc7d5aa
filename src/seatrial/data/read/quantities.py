"""What a column of a log may be besides a channel of a record: measurements from which channels are derived."""

from seatrial.core.values import InputError, quantity, spelling_hint
from seatrial.core.values.notation import NOTATION, Quantity

_TABLE = (
    Quantity("lat", "latitude", "rad", "earth", "north", r"\varphi", "latitude"),
    Quantity("lon", "longitude", "rad", "earth", "east", r"\lambda", "longitude"),
    Quantity("sog", "speed over ground", "m/s", "earth", "none", "U_g", "platform_speed_wrt_ground"),
    Quantity("cog", "course over ground", "rad", "earth", "starboard", r"\chi", "platform_course"),
    Quantity("stw", "speed through water", "m/s", "body", "forward", "u_w", "platform_speed_wrt_sea_water"),
    Quantity("psi_magnetic", "heading from magnetic north", "rad", "earth", "starboard", r"\psi_m", "platform_yaw"),
    Quantity("variation", "magnetic variation", "rad", "earth", "east", "V", "magnetic_variation"),
    *(Quantity(f"q_{k}", f"component {k} of the attitude quaternion", "1", "earth", "none", f"q_{k}", f"quaternion_{k}")
      for k in "wxyz"),
)  # fmt: skip
LOG_QUANTITIES: dict[str, Quantity] = {one.symbol: one for one in _TABLE}
# name that people use -> what to write
_ALIASES = {
    "latitude": "lat", "longitude": "lon", "lng": "lon", "hdt": "psi", "yaw": "psi", "hdm": "psi_magnetic",
    "hdg": "psi (true heading) or psi_magnetic", "heading": "psi (true heading) or psi_magnetic",
    "rot": 'r with unit = "deg/min"', "yaw_rate": "r", "course": "cog", "vtw": "stw",
    "speed": "sog (over ground) or stw (through water)", "rudder": "delta", "rsa": "delta", "roll": "phi",
    "heel": "phi", "pitch": "theta", "heave": "z", "surge": "u", "sway": "v", "x": "x0", "y": "y0",
    "rpm": 'n with unit = "rpm", or rpm_1, rpm_2 of several propellers', "azimuth": "alpha_1",
    "pwm": "command_1 with zero and span", "throttle": "command_1 with zero and span",
    "utc": "time, the key beside channels", "t": "time, the key beside channels",
    "timestamp": "time, the key beside channels",
    "north": 'x0 (position) or u with frame = "earth"', "east": 'y0 (position) or v with frame = "earth"',
}  # fmt: skip


def log_quantity(symbol: str) -> Quantity:
    """Return the entry of a channel, or of a measurement from which channels are derived.

    Raises:
        InputError: there is none; what to write for a common name, or the nearest symbol.
    """
    if symbol in LOG_QUANTITIES:
        return LOG_QUANTITIES[symbol]
    if symbol in NOTATION:
        return quantity(symbol)
    if symbol.lower() in _ALIASES:
        raise InputError(f"unknown channel '{symbol}'; write {_ALIASES[symbol.lower()]}")
    raise InputError(f"unknown channel '{symbol}'{spelling_hint(symbol, sorted({*NOTATION, *LOG_QUANTITIES}))}")
