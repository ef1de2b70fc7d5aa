"""The chapter on offsets says what a new session is expected to be off by, and on what that depends."""

from dataclasses import replace

from tests.reporting.fabricated import fabricated_fit
from tests.reporting.section_text import cells, header

from seatrial.core.results import OffsetPopulation
from seatrial.reporting.records_chapter import offset_section


def test_a_slope_within_its_error_is_said_to_be_chance() -> None:
    zero = OffsetPopulation("delta zero", "rad", 0.016, 0.0016, 0.005, "delta", -0.0023, 0.0016)
    clear = replace(zero, slope_standard_error=0.0001)
    chapter = offset_section(replace(fabricated_fit(), offset_populations=(zero, clear)))
    assert header(chapter.table)[:2] == ("", "expected")
    first, second = (row[-1] for row in cells(chapter.table))
    assert first == "delta: −0.13 ± 0.092 a standard deviation, by chance"
    assert second == "delta: −0.13 ± 0.0057 a standard deviation"
