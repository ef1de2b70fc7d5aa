"""The screen sees disturbances in residuals that a fit over whole runs leaves, and seldom where there are none."""

import numpy as np
from scipy.signal import lfilter

from seatrial.estimation.estimate.disturbance_tests import HINT, spectral_hint

ROWS = 3000


def test_white_residuals_give_no_hint() -> None:
    rng = np.random.default_rng(1)
    hints = [spectral_hint([rng.standard_normal((ROWS, 2))]) for _ in range(100)]
    assert np.mean(np.array(hints) > HINT) <= 0.06


def test_a_faint_disturbance_is_seen() -> None:
    """First-order noise of 0.3 times the sensors' standard deviation with a memory of 50 samples."""
    rng = np.random.default_rng(2)
    noise = rng.standard_normal((ROWS, 2))
    noise[:, 1] += 0.3 * lfilter([np.sqrt(1.0 - 0.98**2)], [1.0, -0.98], rng.standard_normal(ROWS))
    assert spectral_hint([noise[:1500], noise[1500:]]) > HINT


def test_pieces_too_short_say_nothing() -> None:
    assert spectral_hint([np.ones((10, 1))]) == 0.0
