"""The chapter on offsets says what a new session is expected to be off by, and on what that depends."""

from dataclasses import replace

import numpy as np
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.section_text import cells, header

from seatrial.core.results import OffsetPopulation
from seatrial.core.values import Record
from seatrial.reporting.records_chapter import offset_section, wind_sentence


def test_a_slope_within_its_error_is_said_to_be_chance() -> None:
    zero = OffsetPopulation("delta zero", "rad", 0.016, 0.0016, 0.005, "delta", -0.0023, 0.0016)
    clear = replace(zero, slope_standard_error=0.0001)
    chapter = offset_section(replace(fabricated_fit(), offset_populations=(zero, clear)))
    assert header(chapter.table)[:2] == ("", "expected")
    first, second = (row[-1] for row in cells(chapter.table))
    assert first == "delta: −0.13 ± 0.092 a standard deviation, by chance"
    assert second == "delta: −0.13 ± 0.0057 a standard deviation"


def windy_run(speed: float, direction_deg: float) -> Record:
    time = np.arange(50.0)
    values = {"wind_speed": speed + 0.0 * time, "wind_direction": np.radians(direction_deg) + 0.0 * time}
    return Record.from_arrays("run", time, values)


def test_the_mean_is_that_of_the_vector_and_the_direction_that_it_comes_from() -> None:
    """By hand: 4 and 6 m/s from 350 and 010 degrees, mean (5 cos 10, -4 sin 10 / 2 + 6 sin 10 / 2)."""
    north, east = 5.0 * np.cos(np.radians(10.0)), np.sin(np.radians(10.0))
    assert round(float(np.degrees(np.arctan2(east, north)))) == 2
    text = wind_sentence([windy_run(4.0, 350.0), windy_run(6.0, 10.0)])
    assert text == "Wind as recorded, mean over the runs: 4.9 m/s from 002°, 4.0 to 6.0 m/s in single runs."
    assert wind_sentence([windy_run(6.5, -115.0)]) == "Wind as recorded, mean over the runs: 6.5 m/s from 245°."
    assert wind_sentence([windy_run(6.5, 0.0).without("wind_speed")]) == ""
