"""The error with which a measure is read, against the scatter of many readings of one run."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.predict.prediction_intervals import reading_errors
from seatrial.physics.manoeuvres import measures
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.manoeuvres.recognition import ObservedManoeuvre
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.steer import manoeuvre

NOISE = {"psi": np.radians(0.2), "r": np.radians(0.05)}
READINGS = 200


@pytest.fixture(scope="module")
def run() -> Record:
    craft = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 1.0})
    return manoeuvre(craft, programme("zigzag:20/20"), dt=0.2, speed=1.0, duration=120.0)


def read(run: Record, rng: np.random.Generator) -> Record:
    for channel, size in NOISE.items():
        noisy = run[channel] + size * rng.standard_normal(len(run.time))
        run = run.with_channel(channel, run.channel(channel).with_values(noisy))
    return run


def test_it_is_the_scatter_of_many_readings(run: Record, rng: np.random.Generator) -> None:
    reference = ObservedManoeuvre.from_record(run)
    readings = [measures(read(run, rng), 7.0, reference=reference) for _ in range(READINGS)]
    errors = reading_errors(read(run, rng), 7.0, rng)
    for name in ("overshoot_1_deg", "overshoot_2_deg"):
        scatter = float(np.std([m[name] for m in readings]))
        # both are known to a tenth, and a maximum of noisy headings is no linear reading
        assert errors[name] == pytest.approx(scatter, rel=0.6)


def test_a_run_without_noise_is_read_exactly(run: Record, rng: np.random.Generator) -> None:
    errors = reading_errors(run, 7.0, rng)
    assert errors["overshoot_1_deg"] < 0.02
