"""Marks of a figure in data coordinates, and their styles."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ACCENT, GREY, INK, SECOND = "#1b4f72", "#b2b2b2", "#222222", "#a33022"
# mean width of a letter over the size of the font, of Arial in mixed text
LETTER_WIDTH = 0.56
# size of the font of names and titles [px]
TEXT_SIZE = 11.0


def text_width(words: str, size: float = TEXT_SIZE) -> float:
    """Return the estimated width of words in px at a font size in px."""
    return LETTER_WIDTH * size * len(words)


class Anchor(StrEnum):
    """Which end of a text stands at its position; the values are those of SVG."""

    START = "start"
    MIDDLE = "middle"
    END = "end"


class Shape(StrEnum):
    """Outline of a marker."""

    CIRCLE = "circle"
    CROSS = "cross"
    PLUS = "plus"
    DIAMOND = "diamond"
    SQUARE = "square"
    UP = "up"
    DOWN = "down"
    RIGHT = "right"
    UPRIGHT = "upright"


@dataclass(frozen=True)
class Stroke:
    """Style of a line: colour, width in px, dash lengths in px separated by spaces as in SVG."""

    colour: str
    width: float
    dash: str = ""


@dataclass(frozen=True)
class Marker:
    """Style of a point; `size` is half its width in px, `edge_width` in px."""

    shape: Shape
    size: float
    edge: str
    fill: str = "none"
    edge_width: float = 1.2  # px, chosen


@dataclass(frozen=True)
class Line:
    """Line through points in data coordinates; NaN leaves a gap."""

    x: Array
    y: Array
    stroke: Stroke


@dataclass(frozen=True)
class Points:
    """Markers at points in data coordinates; points outside the panel and NaN are left out."""

    x: Array
    y: Array
    marker: Marker


@dataclass(frozen=True)
class Area:
    """Closed outline in data coordinates, filled; points with NaN are left out."""

    x: Array
    y: Array
    fill: str
    stroke: Stroke | None = None


@dataclass(frozen=True)
class Rectangle:
    """Filled rectangle between two corners in data coordinates; `gap` px are left free at its right and lower edge."""

    left: float
    bottom: float
    right: float
    top: float
    fill: str
    gap: float = 0.0
    edge: Stroke | None = None


@dataclass(frozen=True)
class Rule:
    """Straight line across the panel at a value of y, or of x where it is vertical."""

    value: float
    stroke: Stroke
    is_vertical: bool = False


@dataclass(frozen=True)
class Text:
    """Words at a point in data coordinates, moved by (dx, dy) px to the right and down; `turn` in degrees clockwise."""

    x: float
    y: float
    words: str
    anchor: Anchor = Anchor.START
    size: float = TEXT_SIZE
    colour: str = INK
    dx: float = 0.0
    dy: float = 0.0
    turn: float = 0.0


Mark = Line | Points | Area | Rectangle | Rule | Text
