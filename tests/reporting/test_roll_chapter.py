"""The chapter on roll says what its values say."""

from dataclasses import replace

from tests.reporting.section_text import cells, header

from seatrial.core.results import Fit, IntervalEstimate, RollCharacteristics
from seatrial.reporting.page import html
from seatrial.reporting.seakeeping_chapter import roll_section

AMPLITUDE = tuple(0.02 * k for k in range(1, 11))
KNOWN = RollCharacteristics(
    natural_period=IntervalEstimate(2.5512, 2.5475, 2.5550),
    damping_ratio=IntervalEstimate(0.005, 0.001, 0.009),
    gyradius=IntervalEstimate(0.34, 0.34, 0.34),
    gyradius_source="k_xx_prime of the ship, 0.34 m, taken as exact",
    metacentric_height=IntervalEstimate(0.072, 0.071, 0.073),
    amplitude=AMPLITUDE,
    damping=tuple(0.02 + a / 10 for a in AMPLITUDE),
    damping_lower=tuple(0.015 + a / 10 for a in AMPLITUDE),
    damping_upper=tuple(0.025 + a / 10 for a in AMPLITUDE),
    period=tuple(2.55 - a / 10 for a in AMPLITUDE),
    period_lower=tuple(2.54 - a / 10 for a in AMPLITUDE),
    period_upper=tuple(2.56 - a / 10 for a in AMPLITUDE),
    swings=((0.1, 0.031, 2.541), (0.05, 0.024, 2.546)),
)


def test_tables_have_digits_by_the_interval_and_full_scale_by_froude() -> None:
    """Period times the root of the scale, GM times the scale; an exact radius has no interval."""
    chapter = roll_section(KNOWN, 64.0)
    rows = cells(chapter.table)
    assert rows[0] == ("natural period at small angles, s", "2.5512", "2.5475", "2.5550", "20.410")
    assert rows[1][1:] == ("0.50", "0.10", "0.90", "0.50")
    assert rows[2][-1] == "4.608"
    assert rows[3][2:4] == ("\u2013", "\u2013")
    assert "taken as exact" in chapter.note
    assert len(header(roll_section(KNOWN, 1.0).table)) == 4
    assert cells(chapter.parts[0].table)[-1][0] == "11.5"


def test_the_note_explains_the_dots_where_there_are_any() -> None:
    """A driven ship has none."""
    (dotted,), (plain,) = (roll_section(roll, 1.0).pictures for roll in (KNOWN, replace(KNOWN, swings=())))
    assert ">one recorded swing<" in dotted.draw() and "Dots" in dotted.caption
    assert ">one recorded swing<" not in plain.draw() and "Dots" not in plain.caption


def test_the_page_has_the_chapter_and_the_answer_its_sentence(fit: Fit) -> None:
    """Only where there is one."""
    page = html(replace(fit, roll=KNOWN))
    assert "Roll: period, damping, metacentric height" in page
    assert "natural period at small angles is 2.5512 s (2.5475 to 2.5550 s)" in page
    assert "metacentric height" not in html(fit)
