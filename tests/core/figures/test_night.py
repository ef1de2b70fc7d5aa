"""Colours on a dark screen keep their hue and stand out from the ground as much as on a light one."""

import colorsys

import pytest

from seatrial.core.figures.marks import ACCENT, GREY, INK, SECOND
from seatrial.core.figures.night import night_colour, night_rules

GROUND = "#14191c"  # --ground of reporting/templates/dark.css


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
