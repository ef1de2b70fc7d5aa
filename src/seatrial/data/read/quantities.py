"""What a column of a log may be besides a channel of a record: measurements from which channels are derived."""

from seatrial.core.values import InputError, channel_hint, quantity
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


def log_quantity(symbol: str) -> Quantity:
    """Return the entry of a channel, or of a measurement from which channels are derived.

    Raises:
        InputError: there is none; what to write for a common name, or the nearest symbol.
    """
    if symbol in LOG_QUANTITIES:
        return LOG_QUANTITIES[symbol]
    if symbol in NOTATION:
        return quantity(symbol)
    raise InputError(f"unknown channel '{symbol}'{channel_hint(symbol, sorted({*NOTATION, *LOG_QUANTITIES}))}")
