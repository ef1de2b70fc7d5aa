"""Figures keep what matters when they are thinned, and turn the right way."""

import numpy as np

from seatrial.core.figures.correlation import correlation_matrix
from seatrial.core.figures.plot import decimated, display_values
from seatrial.core.figures.tracks import hull_outline


def test_decimation_keeps_extremes_order_and_gaps(rng: np.random.Generator) -> None:
    x = np.arange(10_000.0)
    y = rng.standard_normal(10_000)
    y[5_000:6_000] = np.nan
    a, b = decimated(x, y, 400)
    assert len(a) <= 400 and np.all(np.diff(a) >= 0)
    assert np.nanmax(b) == np.nanmax(y) and np.nanmin(b) == np.nanmin(y)
    assert np.isnan(b[(a > 5_050) & (a < 5_950)]).all()


def test_a_wrapped_heading_is_drawn_without_jumps() -> None:
    heading = np.linspace(0.0, 4.0 * np.pi, 200)
    wrapped = np.angle(np.exp(1j * heading))
    assert np.ptp(np.diff(display_values("psi", wrapped, "rad"))) < 1e-9


def test_a_ship_heading_east_points_east() -> None:
    outline = hull_outline(0.0, 0.0, np.pi / 2, 10.0)
    assert np.isclose(outline[:, 1].max(), 5.0) and np.abs(outline[:, 0]).max() < 1.0


def test_correlation_of_a_covariance() -> None:
    assert np.allclose(correlation_matrix(np.array([[4.0, -1.0], [-1.0, 1.0]])), [[1.0, -0.5], [-0.5, 1.0]])
