"""Peaks of residual spectra: found where a channel swings, at the size it swings with."""

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.estimation.information.frequency_response import spectral_peaks

DT, ROWS, OMEGA = 0.5, 4096, 0.9


def noise() -> Array:
    """A white channel, and a random walk that follows slowly."""
    white = np.random.default_rng(5).standard_normal((ROWS, 2))
    return np.column_stack([white[:, 0], np.cumsum(0.3 * white[:, 1])])


def test_a_swing_is_found_in_the_channels_that_show_it() -> None:
    swing = 3.0 * np.sin(OMEGA * DT * np.arange(ROWS))
    peak = spectral_peaks([noise() + swing[:, None] * [1.0, 0.0]], DT, 1)[0]
    assert peak.frequency == pytest.approx(OMEGA, rel=0.02)
    assert peak.variance[0] == pytest.approx(np.var(swing), rel=0.1)
    assert peak.variance[1] < 0.01 * peak.variance[0]
    assert 0.0 < peak.floor[0] < 1.0, "of white noise of variance 1, by its least density"


def test_the_peak_that_exceeds_its_sides_most_comes_first_and_no_more_than_asked() -> None:
    time = DT * np.arange(ROWS)
    both = np.column_stack([2.0 * np.sin(OMEGA * time) + 5.0 * np.sin(2.5 * OMEGA * time)] * 2)
    frequencies = [peak.frequency for peak in spectral_peaks([noise() + both], DT, 2)]
    assert frequencies == pytest.approx([2.5 * OMEGA, OMEGA], rel=0.02)
    assert len(spectral_peaks([noise() + both], DT, 1)) == 1


def test_records_shorter_than_a_spectrum_say_nothing() -> None:
    assert spectral_peaks([noise()[:10]], DT, 2) == []
