"""A ship in waves as a stream: a trial that follows it, the samples, and the true coefficients."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.results.online import Sample, Snapshot
from seatrial.core.values import NOTATION, Record
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial import Trial
from seatrial.data.trial.runs import require_stream
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.estimation.identify.online import OnlineEstimator
from seatrial.estimation.identify.online.estimator import StreamWindow
from seatrial.physics.models.published import QI2025_SHIP
from seatrial_studies.heave_pitch_search import with_physics_start
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE, SeawayScenario, simulate_seaway_run

CHANNELS = ("F3", "M5", "delta_f1", "z", "theta")
LAYOUT = Layout(
    "text", ColumnSpec("time", 1, "s"), tuple(ColumnSpec(c, k + 2, NOTATION[c].unit) for k, c in enumerate(CHANNELS))
)


@dataclass(frozen=True, eq=False)
class SeaStream:
    """A trial without records of its own, its noisy run, and the true free coefficients, (k,)."""

    trial: Trial
    record: Record
    truth: np.ndarray


def sea_stream(heading: int, duration: float, seed: int = 1) -> SeaStream:
    """Return heave and pitch at `heading` [deg] over `duration` s, 10 Hz, with the sensors' noise."""
    scenario = SeawayScenario(heading, duration=duration)
    run = simulate_seaway_run(scenario, np.random.default_rng(seed))
    model = with_physics_start(run.truth)
    truth = np.array([run.truth.parameters[n].value for n in model.parameters.free_names])
    noise = {"z": HEAVE_NOISE, "theta": PITCH_NOISE}
    trial = Trial(
        ship=QI2025_SHIP,
        runs=(),
        model=model,
        noise=noise,
        stream=Stream(source=StreamSource.STDIN, layout=LAYOUT, rate=10.0),
    )
    return SeaStream(trial, run.with_sensor_noise(np.random.default_rng(seed + 1), scenario), truth)


def samples(record: Record, trial: Trial, rows: slice = slice(None)) -> list[Sample]:
    """Return rows of a record as the trial's stream would send them."""
    columns = require_stream(trial).layout.columns
    values = np.stack([record[c.symbol] for c in columns], axis=1)[rows]
    return [Sample(time, row) for time, row in zip(record.time[rows].tolist(), values, strict=True)]


def feed(estimator: OnlineEstimator, record: Record, trial: Trial, rows: slice = slice(None)) -> Snapshot:
    """Feed rows of a record and return the last snapshot."""
    return [estimator.update(sample) for sample in samples(record, trial, rows)][-1]


def window_of(stream: SeaStream, rows: slice) -> StreamWindow:
    """Return a window that holds those rows as its first run."""
    window = StreamWindow(stream.trial)
    window.begin_run(1)
    for sample in samples(stream.record, stream.trial, rows):
        window.add(np.array([sample.time]), sample.values[None])
    return window
