"""Angles as navigators write them: degrees with minutes and seconds, and the side of the world."""

import re
from collections.abc import Sequence

import numpy as np

_SIXTIETH = 60.0  # minutes of a degree, seconds of a minute
_HALF_TURN, _TWO_DIGITS = 180.0, 100.0  # deg; of the minutes behind the degrees in NMEA 0183's dddmm.mmmm
_NUMBER = r"\d+(?:[.,]\d+)?"
_ANGLE = re.compile(
    rf"(?P<before>[NSEW])?\s*(?P<deg>{_NUMBER})\s*[°ºd ]?\s*"
    rf"(?:(?P<min>{_NUMBER})\s*['′’m]?\s*)?(?:(?P<sec>{_NUMBER})\s*(?:\"|″|”|''|s)?\s*)?(?P<after>[NSEW])?",
    re.IGNORECASE,
)


def degrees_of(text: str) -> float | None:
    """Return an angle with its side in decimal degrees, north and east positive; None for text that is none.

    `54°06.00049'N`, `7 54 00.2 E`, `S 12.5`, `5406.00049N`; the side, before or behind, is what marks it.
    """
    match = _ANGLE.fullmatch(text.strip())
    if match is None or bool(match["before"]) == bool(match["after"]):
        return None
    degrees, minutes, seconds = (float((match[part] or "0").replace(",", ".")) for part in ("deg", "min", "sec"))
    if degrees > _HALF_TURN and not match["min"]:
        degrees, minutes = divmod(degrees, _TWO_DIGITS)
    if max(minutes, seconds) >= _SIXTIETH:
        return None
    sign = -1.0 if (match["before"] or match["after"]).upper() in "SW" else 1.0
    return sign * (degrees + minutes / _SIXTIETH + seconds / _SIXTIETH**2)


def with_sides(cells: Sequence[Sequence | np.ndarray]) -> tuple[Sequence | np.ndarray, ...]:
    """Return the columns of a table, angles with the letters of the side that stand in the column behind each.

    ``54 48.7004`` before ``N`` becomes ``54 48.7004 N``, ``5448.7004`` before ``S`` likewise; the letters stay.
    """
    joined = list(cells)
    for k, sides in enumerate(cells[1:]):
        if isinstance(sides, np.ndarray) or not _are_sides(sides):
            continue
        angles = [f"{angle} {side}".strip() for angle, side in zip(cells[k], sides, strict=True)]
        if all(degrees_of(text) is not None for text in angles if text):
            joined[k] = angles
    return tuple(joined)


def _are_sides(cells: Sequence) -> bool:
    """Whether a column holds nothing but N and S, or E and W; a cell may be empty."""
    letters = {str(cell).strip().upper() for cell in cells} - {""}
    return bool(letters) and (letters <= {"N", "S"} or letters <= {"E", "W"})
