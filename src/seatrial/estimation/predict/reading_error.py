"""How exactly a measure is read from a run: what the noise of its sensors leaves open."""

import numpy as np

from seatrial.core.values import Record
from seatrial.data.check.motion import sample_noise
from seatrial.physics.manoeuvres import measures
from seatrial.physics.manoeuvres.recognition import ObservedManoeuvre

MEASURE_CHANNELS = ("psi", "x0", "y0", "u", "v", "r")
"""Channels that measures are read from."""
READINGS = 60
"""Readings drawn; chosen: their scatter is then known to a tenth."""


def reading_errors(record: Record, length: float, rng: np.random.Generator) -> dict[str, float]:
    """Return the standard deviation of each measure of a run that white noise of its sensors leaves, in its unit.

    The noise of each channel is that of its third differences; the run is read again with as much added, which to first
    order scatters as the reading itself does. What a second run would do differently is not in it.

    Args:
        length: of the ship [m].

    Raises:
        InputError: the record is no manoeuvre.
    """
    reference = ObservedManoeuvre.from_record(record)
    centre = measures(record, length, reference=reference)
    noise = {c: sample_noise(record.channel(c).readings) for c in MEASURE_CHANNELS if c in record}
    values: dict[str, list[float]] = {name: [] for name in centre}
    for _ in range(READINGS):
        again = record
        for channel, size in noise.items():
            read = record[channel] + size * rng.standard_normal(len(record[channel]))
            again = again.with_channel(channel, record.channel(channel).with_values(read))
        for name, value in measures(again, length, reference=reference).items():
            if name in values:
                values[name].append(value - centre[name])
    return {name: float(np.sqrt(np.mean(np.square(v)))) for name, v in values.items() if 2 * len(v) > READINGS}
