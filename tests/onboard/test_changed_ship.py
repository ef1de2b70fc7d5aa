"""A ship that changes while a stream is followed to its end: the result is of the changed ship alone."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.online.streams import CHANNELS, sea_stream

from seatrial.data.trial.runs import require_stream
from seatrial.data.trial.settings import StreamSource
from seatrial.onboard.follow import follow
from seatrial_studies.seaway import SeawayScenario, ship, simulate_seaway_run

GROWTH, CHANGED, SECONDS, HEADING, SEED = 1.3, 60.0, 160.0, 135, 5  # 1, s, s, deg


def test_the_fit_is_of_the_samples_behind_a_change_and_names_it(tmp_path: Path) -> None:
    """In one sea the added mass in heave grows at once."""
    stream, scenario = sea_stream(HEADING, SECONDS, SEED), SeawayScenario(HEADING, duration=SECONDS)
    truth = GROWTH * ship(HEADING).parameters["a33"].value
    loaded = simulate_seaway_run(scenario, np.random.default_rng(SEED), ship(HEADING).with_values({"a33": truth}))
    after, time = loaded.with_sensor_noise(np.random.default_rng(2), scenario), stream.record.time
    columns = [np.where(time < CHANGED, stream.record[c], after[c]) for c in CHANNELS]
    path = tmp_path / "voyage.csv"
    np.savetxt(path, np.column_stack([time, *columns]), "%.8g", ",")
    source = replace(require_stream(stream.trial), source=StreamSource.FILE, file=path)
    outcome = follow(replace(stream.trial, stream=source), once=True)
    assert outcome.fit is not None
    finding = next(f for f in outcome.fit.findings if f.code == "coefficients-changed")
    name, _, size = finding.evidence.removesuffix(" %").partition(" by ")  # alone: the others are as they were
    assert name == "a33"
    assert float(size) == pytest.approx(100.0 * (GROWTH - 1.0), abs=1.5)
    a33 = next(c for c in outcome.fit.coefficients if c.name == "a33")
    assert a33.standard_error is not None
    assert abs(a33.estimate - truth) < 4.0 * a33.standard_error
    assert a33.standard_error == pytest.approx(0.0, abs=0.02 * truth)
