"""Memory of the estimator on board over millions of samples: voyages of an hour, one after another.

`python benchmarks/follow_memory.py 278` feeds 10 million samples of heave and pitch (a window of 600 s,
then the filter, then a gap) and prints the resident memory (Linux) as it goes; some six minutes.
"""

import sys
import time
from pathlib import Path

import numpy as np

from seatrial.core.results.online import Sample
from seatrial.core.values import NOTATION
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.data.trial.trial import Trial
from seatrial.estimation.identify.online import OnlineEstimator
from seatrial.physics.models.published import QI2025_SHIP
from seatrial_studies.heave_pitch_search import with_physics_start
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE, SeawayScenario, simulate_seaway_run

CHANNELS = ("F3", "M5", "delta_f1", "z", "theta")
HOUR, GAP, EVERY = 3600.0, 3700.0, 25


def main(voyages: int) -> None:
    """Print samples, phase, memory and rate every 25 voyages."""
    voyage = SeawayScenario(135, duration=HOUR)
    made = simulate_seaway_run(voyage, np.random.default_rng(1))
    record = made.with_sensor_noise(np.random.default_rng(2), voyage)
    columns = tuple(ColumnSpec(c, k + 2, NOTATION[c].unit) for k, c in enumerate(CHANNELS))
    stream = Stream(
        source=StreamSource.STDIN,
        layout=Layout("text", ColumnSpec("time", 1, "s"), columns),
        rate=10.0,
        batch_window_s=600.0,
    )
    noise = {"z": HEAVE_NOISE, "theta": PITCH_NOISE}
    estimator = OnlineEstimator(
        Trial(ship=QI2025_SHIP, runs=(), model=with_physics_start(made.truth), noise=noise, stream=stream)
    )
    rows, began = np.stack([record[c] for c in CHANNELS], axis=1), time.perf_counter()
    for number in range(voyages):
        if number:
            estimator.begin_run()
        for at, row in zip(record.time + number * GAP, rows, strict=True):
            shown = estimator.update(Sample(float(at), row))
        if number % EVERY == 0 or number == voyages - 1:
            rate = shown.samples / (time.perf_counter() - began)
            print(f"{shown.samples:>10} samples, {shown.phase}, {_resident():.0f} MB, {rate:.0f} samples/s", flush=True)


def _resident() -> float:
    """MB in memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 30)
