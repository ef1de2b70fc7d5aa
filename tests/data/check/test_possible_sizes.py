"""Readings and times that no ship shows."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.data.check import examine


def test_a_reading_of_no_possible_size_is_refused() -> None:
    time = np.arange(0.0, 20.0, 0.1)
    speed = 3.0 + np.sin(time)
    speed[50] = 1e150
    with pytest.raises(InputError, match=r"channel 'u' is 1e\+150 m/s at 5 s, which no ship shows"):
        examine(Record.from_arrays("run", time, {"u": speed}))


def test_a_time_beyond_all_dates_is_refused() -> None:
    with pytest.raises(InputError, match=r"record 'run': 1e\+15 s is no time; correct the unit"):
        Record.from_arrays("run", np.array([1e15, 1e15 + 1.0]), {"u": np.zeros(2)})
