"""Colours on a dark screen keep their hue and stand out from the ground as much as on a light one."""

import colorsys

import numpy as np
import pytest

from seatrial.core.figures.marks import ACCENT, GREY, INK, SECOND, Array
from seatrial.core.figures.night import night_colour, night_rules

GROUND = "#14191c"  # --ground of core/pages/templates/dark.css


def luminance(colour: str) -> float:
    """Relative luminance (W3C, Web Content Accessibility Guidelines 2.1, definition)."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """Contrast ratio (same source)."""
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("colour", [ACCENT, INK, SECOND])
def test_lines_and_letters_are_read_on_either_ground(colour: str) -> None:
    assert contrast(colour, "#ffffff") > 4.5 and contrast(night_colour(colour), GROUND) > 4.5


def test_curves_differ_from_the_broad_grey_line_below_them() -> None:
    for pair in ((ACCENT, GREY), (night_colour(ACCENT), night_colour(GREY))):
        assert contrast(*pair) > 2.0


def test_hue_and_transparency_stay() -> None:
    hue = [colorsys.rgb_to_hls(*(int(c[k : k + 2], 16) / 255 for k in (1, 3, 5)))[0] for c in
           (ACCENT, night_colour(ACCENT))]  # fmt: skip
    assert hue[0] == pytest.approx(hue[1], abs=0.02)
    assert night_colour("#1b4f7230").endswith("30") and len(night_colour("#1b4f7230")) == 9
    assert luminance(night_colour("#ffffff")) < 0.02 < 0.7 < luminance(night_colour("#000000"))


def test_a_rule_is_written_once_for_a_colour() -> None:
    rules = night_rules(["#1b4f72", "#1b4f72"])
    assert rules.count("[fill='#1b4f72']") == rules.count("[stroke='#1b4f72']") == 1


# linear RGB as seen without red-sensitive and without green-sensitive cones (Machado, Oliveira & Fernandes 2009,
# IEEE Trans. Vis. Comput. Graph. 15, 1291-1298, severity 1.0)
PROTANOPIA = ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998))
DEUTERANOPIA = ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881))
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])  # IEC 61966-2-1
WHITE = TO_XYZ.sum(axis=1)


def lab_as_seen(colour: str, sight: tuple[tuple[float, ...], ...]) -> Array:
    """CIELAB (ISO/CIE 11664-4) of a colour as such a reader sees it."""
    parts = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    x = TO_XYZ @ np.clip(np.array(sight) @ linear, 0.0, 1.0) / WHITE
    f = np.where(x > (6 / 29) ** 3, np.cbrt(x), x / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("sight", [PROTANOPIA, DEUTERANOPIA])
def test_lines_differ_for_readers_who_see_no_red_or_no_green(sight: tuple[tuple[float, ...], ...]) -> None:
    """Ten units of CIELAB are ten times what is just seen (CIE 1976)."""
    for colours in ((ACCENT, GREY, SECOND, INK), tuple(map(night_colour, (ACCENT, GREY, SECOND, INK)))):
        seen = [lab_as_seen(colour, sight) for colour in colours]
        for k, one in enumerate(seen):
            assert all(np.linalg.norm(one - other) > 10.0 for other in seen[:k])
