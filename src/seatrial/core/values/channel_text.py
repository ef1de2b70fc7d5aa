"""Names, letters, meanings and units of channels as people read them."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values.arrays import Array, unwrapped
from seatrial.core.values.notation import NOTATION
from seatrial.core.values.units import display_unit

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
