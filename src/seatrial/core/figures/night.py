"""Colours of figures for a dark screen: the same hue, light and dark exchanged."""

import colorsys
from collections.abc import Iterable

# largest value of a part of a colour, 8 bits
LARGEST_PART = 255
# lightness on a dark screen of what is black and of what is white: letters are not glaring, the ground is not black
LIGHTEST, DARKEST = 0.92, 0.11
# saturation that colours keep on a dark screen; chosen
SATURATION = 0.9


def night_colour(colour: str) -> str:
    """Return a colour `#rrggbb` or `#rrggbbaa` for a dark screen; the transparency stays."""
    red, green, blue = (part / LARGEST_PART for part in bytes.fromhex(colour[1:7]))
    hue, lightness, saturation = colorsys.rgb_to_hls(red, green, blue)
    channels = colorsys.hls_to_rgb(hue, LIGHTEST + (DARKEST - LIGHTEST) * lightness, SATURATION * saturation)
    return "#" + "".join(f"{round(LARGEST_PART * c):02x}" for c in channels) + colour[7:]


def night_rules(colours: Iterable[str]) -> str:
    """Return style rules that give marks of these fills and strokes their colour for a dark screen."""
    return "".join(
        f"[{name}='{colour}']{{{name}:{night_colour(colour)}}}"
        for colour in sorted(set(colours))
        for name in ("fill", "stroke")
    )
