"""The wind of the day, as it was recorded beside the runs."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.values import Record

_WIND = {"wind_speed", "wind_direction"}


def wind_sentence(records: Sequence[Record]) -> str:
    """Return the mean of the recorded true wind over all samples, and the range over the runs; empty without any.

    The mean is that of the velocity towards north and east; directions are those that the wind comes from.
    """
    winds = [r["wind_speed"] * np.exp(1j * r["wind_direction"]) for r in records if set(r.channels) >= _WIND]
    means = [complex(np.nanmean(wind)) for wind in winds if np.isfinite(wind).any()]
    if not means:
        return ""
    mean = complex(np.nanmean(np.concatenate(winds)))
    course = round(math.degrees(math.atan2(mean.imag, mean.real))) % 360
    text = f"Wind as recorded, mean over the runs: {significant(abs(mean), 2)} m/s from {course:03d}°"
    if len(means) == 1:
        return f"{text}."
    low, high = (significant(f(abs(one) for one in means), 2) for f in (min, max))
    return f"{text}, {low} to {high} m/s in single runs."
