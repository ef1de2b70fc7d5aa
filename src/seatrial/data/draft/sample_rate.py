"""The rate at which residuals of a ship are taken: samples far closer than a ship moves cost time and add little."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values import Record

# samples in the time of a ship length from which on a log is thinned, and how many are left at least; chosen: held-out
# errors of a tug's model with 9 were those with 36
_MANY, _ENOUGH = 25.0, 9.0


def thinned_rate(records: Sequence[Record | None], length: float, speed: float) -> float | None:
    """Return the rate [Hz] at which residuals are taken, a whole part of the records'; None: that of the records.

    length: of the ship [m]; speed: at which the runs begin [m/s].
    """
    steps = [record.dt for record in records if record is not None and len(record) > 1]
    if not steps or not length or not speed:
        return None
    step = float(np.median(steps))
    samples = length / speed / step
    return 1.0 / (step * int(samples / _ENOUGH)) if samples >= _MANY else None
