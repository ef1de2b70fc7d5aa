"""Sizes of the craft and its speed that stand in the header of a text log."""

import re
from dataclasses import dataclass, fields

from seatrial.core.values import InputError, si_unit
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.draft.survey import LogSurvey
from seatrial.data.read.formats.text import decoded_text

# names of main dimensions in the headers of towing tanks and trial reports; a letter as it is, D is a diameter; ours
_NAMES = {
    "length": (r"L|(?i:L[ _]?pp|length(?: between perpendiculars)?)", "m"),
    "beam": (r"B|(?i:B[ _]?wl|beam|breadth)", "m"),
    "draught": (r"T|d|(?i:draught|draft)", "m"),
    "mass": (r"(?i:displ(?:acement|\.)|mass)", "kg"),
    "gm": (r"(?i:GM(?:[ _]?[0tT])?)", "m"),
}
_UNITS = {"m": "mm|cm|m", "kg": "kg|t"}
# the speed of a carriage or craft, as headers have it
_SPEED = re.compile(r"(?:(?i:speed)|(?<![\w.])V(?=[ \t]*[=:]))[ \t]*[=:]?[ \t]*(\d+(?:\.\d+)?)[ \t]*(m/s|kn)\b")
_SCALE = re.compile(r"(?<![\d:])1\s?:\s?(\d+(?:\.\d+)?)(?![\d:])")


@dataclass(frozen=True)
class HeaderSize:
    """A size as a header has it, and the option of init that states it."""

    text: str
    option: str


def sizes_in_header(survey: LogSurvey, size: StatedSize) -> tuple[HeaderSize, ...]:
    """Return what the header of a text log says of the craft's size and what is not stated; nothing of other logs."""
    header = _header(survey)
    stated = {field.name for field in fields(size) if getattr(size, field.name)}
    return tuple(one for name, one in _sizes(header).items() if name not in stated)


def speed_in_header(survey: LogSurvey) -> float | None:
    """Return the speed [m/s] that the header of a text log states once; None where it states none."""
    matches = _SPEED.findall(_header(survey))
    if len(matches) != 1:
        return None
    number, unit = matches[0]
    return float(number) * si_unit(unit)[0]


def _header(survey: LogSurvey) -> str:
    """The lines above the numbers of a text log; empty of other logs, and where they are column names alone."""
    lines = survey.layout.header_lines if survey.layout.format == "text" else 0
    if lines < 2:  # a line of column names alone
        return ""
    try:
        return "\n".join(decoded_text(survey.path, survey.layout.encoding).splitlines()[:lines])
    except InputError:
        return ""


def _sizes(header: str) -> dict[str, HeaderSize]:
    """Each size that is named once in a header."""
    sizes = dict[str, HeaderSize]()
    for name, (words, unit) in _NAMES.items():
        pattern = rf"(?<![\w.])(?:{words})[ \t]*[=:]?[ \t]*(\d+(?:\.\d+)?)[ \t]*({_UNITS[unit]})\b"
        matches = list(re.finditer(pattern, header))
        if len(matches) == 1:
            value = float(matches[0][1]) * si_unit(matches[0][2])[0]
            sizes[name] = HeaderSize(" ".join(matches[0][0].split()), f"--{name} {value:g}")
    scales = list(_SCALE.finditer(header))
    if len(scales) == 1:
        sizes["scale"] = HeaderSize(scales[0][0], f"--scale {float(scales[0][1]):g}")
    return sizes
