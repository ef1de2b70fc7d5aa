"""The band of a record's power: tones, noise, slow sensors; and what is said of it."""

import numpy as np
import pytest

from seatrial.core.values import Channel, Record, RecordKind, frozen
from seatrial.estimation.information.frequency_response import frequency_range, frequency_range_finding


def recorded(values: np.ndarray, dt: float = 0.1) -> Record:
    time = frozen(np.arange(len(values)) * dt)
    return Record("run", time, {"z": Channel.from_notation("z", frozen(values))}, RecordKind.MEASURED)


def test_two_tones_bound_the_range(rng: np.random.Generator) -> None:
    time = np.arange(6000) * 0.1
    z = np.sin(0.8 * time) + np.sin(2.5 * time + 1.0) + 0.01 * rng.standard_normal(6000)
    low, high = frequency_range([recorded(z)], ["z", "theta"])["z"]
    assert low == pytest.approx(0.8, abs=0.1)
    assert high == pytest.approx(2.5, abs=0.1)


def test_white_noise_fills_the_band_to_nyquist(rng: np.random.Generator) -> None:
    low, high = frequency_range([recorded(rng.standard_normal(20_000))], ["z"])["z"]
    assert low == pytest.approx(0.05 * np.pi / 0.1, rel=0.2)
    assert high == pytest.approx(0.95 * np.pi / 0.1, rel=0.05)


def test_a_slow_sensor_is_taken_at_its_own_rate() -> None:
    z = np.sin(1.2 * np.arange(8000) * 0.1)
    z[np.arange(8000) % 5 != 0] = np.nan
    low, high = frequency_range([recorded(z)], ["z"])["z"]
    assert low == pytest.approx(1.2, abs=0.1)
    assert high == pytest.approx(1.2, abs=0.1)


def test_what_does_not_move_has_no_range_and_the_rest_is_said() -> None:
    assert frequency_range([recorded(np.zeros(500))], ["z"]) == {}
    assert "1.1 to 2.4 rad/s" in frequency_range_finding({"z": (1.1, 2.4)}).message
