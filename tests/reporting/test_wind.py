"""The sentence on the recorded wind: mean vector, compass direction it comes from, range over the runs."""

import numpy as np

from seatrial.core.values import Record
from seatrial.reporting.wind import wind_sentence


def run(speed: float, direction_deg: float) -> Record:
    time = np.arange(50.0)
    values = {"wind_speed": speed + 0.0 * time, "wind_direction": np.radians(direction_deg) + 0.0 * time}
    return Record.from_arrays("run", time, values)


def test_the_mean_is_that_of_the_vector_and_the_direction_that_it_comes_from() -> None:
    """By hand: 4 and 6 m/s from 350 and 010 degrees, mean (5 cos 10, -4 sin 10 / 2 + 6 sin 10 / 2)."""
    north, east = 5.0 * np.cos(np.radians(10.0)), np.sin(np.radians(10.0))
    assert round(float(np.degrees(np.arctan2(east, north)))) == 2
    text = wind_sentence([run(4.0, 350.0), run(6.0, 10.0)])
    assert text == "Wind as recorded, mean over the runs: 4.9 m/s from 002°, 4.0 to 6.0 m/s in single runs."
    assert wind_sentence([run(6.5, -115.0)]) == "Wind as recorded, mean over the runs: 6.5 m/s from 245°."
    assert wind_sentence([run(6.5, 0.0).without("wind_speed")]) == ""
