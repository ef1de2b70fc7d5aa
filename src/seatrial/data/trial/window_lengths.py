"""Lengths of the windows in which validation runs are predicted: of a trial file's `windows` and of `--windows`."""

import re
from dataclasses import dataclass

from seatrial.core.values import InputError


@dataclass(frozen=True)
class WindowLength:
    """Length of a window; `unit`: s, or L for the time of a ship length at the run's speed."""

    value: float
    unit: str

    def __str__(self) -> str:
        return f"{self.value:g} {self.unit}"


def window_lengths(text: str) -> tuple[WindowLength, ...]:
    """Return the lengths that a text such as ``10s,5L`` names.

    Raises:
        InputError: a part is no positive number with s or L.
    """
    lengths = []
    for part in filter(None, (p.strip() for p in text.split(","))):
        match = re.fullmatch(r"(\d+\.?\d*|\.\d+)\s*([sL])", part)
        if match is None or not float(match[1]) > 0.0:
            raise InputError(f"windows: '{part}' is no length of a window; write seconds or ship lengths, as 10s,5L")
        lengths.append(WindowLength(float(match[1]), match[2]))
    return tuple(lengths)
