"""What transforms show of waves, against the nodes of one heading and the window's transform of sines."""

import math

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.estimation.problem.spectral_likelihood import hann_transform
from seatrial.estimation.sea import TransformBins, band_edges, encounter_matrix, encountered_sea, sea_spectrum
from seatrial.physics.hydro.excitation import encounter_frequency
from seatrial.physics.loops import WAVE_SLOPE, HullFactor

HULL, U = HullFactor(100.0, 10.5, 3.4), 9.0
OMEGA = np.arange(40, 480) * 0.0052
BINS = TransformBins(OMEGA, 0.0052, 1)
SEA = np.log([2.5, 9.0, 1.3])


@pytest.mark.parametrize("degrees", [20.0, 60.0, 90.0, 150.0])
def test_density_is_that_of_nodes(degrees: float) -> None:
    beta, edges = math.radians(degrees), band_edges(OMEGA, HULL)
    matrix = encounter_matrix(BINS, edges, U, np.array([beta]), HULL)
    got = matrix @ sea_spectrum(SEA).density(np.sqrt(edges[1:] * edges[:-1]))
    nodes = encountered_sea(OMEGA, U, beta, HULL)
    expected = nodes.density(SEA, np.ones(len(nodes.omega)))
    assert np.max(np.abs(got - expected)) < 0.03 * np.max(expected)
    assert np.sum(got) == pytest.approx(np.sum(expected), rel=0.003)


def test_a_cell_is_the_mean_of_its_headings() -> None:
    edges = band_edges(OMEGA, HULL)
    both = encounter_matrix(BINS, edges, U, np.array([1.0, 1.1]), HULL)
    each = [encounter_matrix(BINS, edges, U, np.array([beta]), HULL) for beta in (1.0, 1.1)]
    np.testing.assert_allclose(both.toarray(), 0.5 * (each[0] + each[1]).toarray(), atol=1e-15)


def test_a_wave_shows_where_its_sine_does() -> None:
    """One band of waves is one sine of random phase: its mean periodogram, from following seas."""
    count, dt, beta = 1000, 0.6, 0.7
    omega, _ = hann_transform(np.zeros((count, 1)), dt)
    bins = TransformBins(omega[20:200:2], float(omega[1] - omega[0]), 2)
    edges = np.array([0.8, 0.8001])
    met = float(encounter_frequency(np.array([0.80005]), U, beta)[0])
    phases = np.linspace(0.0, math.pi, 4, endpoint=False)
    waves = np.cos(met * dt * np.arange(count)[:, None] + phases) * math.sqrt(2.0 * 1e-4)
    shown = np.mean(np.abs(hann_transform(waves, dt)[1][20:200:2]) ** 2, axis=1)
    shown *= abs(WAVE_SLOPE.amplitude(np.array([0.80005]), U, beta)[0]) ** 2
    got = encounter_matrix(bins, edges, U, np.array([beta]), WAVE_SLOPE) @ np.ones(1)
    np.testing.assert_allclose(got, shown, atol=0.01 * np.max(shown))


def test_a_speed_out_of_sense_is_refused() -> None:
    with pytest.raises(InputError, match="speed"):
        encounter_matrix(BINS, band_edges(OMEGA, HULL), -1.0, np.array([0.5]), HULL)
