"""What the transform of a whole stretch shows of waves: a matrix from bands of wave frequency, for each heading.

Waves that share one frequency of encounter add up in one row, so that following seas are as any other; no Jacobian of
the encounter appears. Each band's energy is spread over nodes so close that the largest frequency of encounter, where
waves of many frequencies gather, is resolved to a fraction of a bin.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.problem.spectral_likelihood import hann_leakage
from seatrial.physics.hydro.excitation import encounter_frequency
from seatrial.physics.loops import WaveEffect
from seatrial.physics.sea.spectrum import speed_factor

if TYPE_CHECKING:
    from scipy.sparse import csr_array

BAND = 0.01  # relative width of a band: a seventh of the width of JONSWAP's peak, 0.07 (Hasselmann et al. 1973); chosen
_LONGEST, _SHORTEST = 0.5, 4.0  # wave frequencies over the ends of the transform's that are looked at; chosen
_NODES_A_BIN = 3.0  # nodes for each bin of the transform that a band covers, at least; chosen
_WINDOW_POWER = 1.5  # mean of a Hann window's square over the square of its mean: the area under its leakage, in bins
_PLACES_A_BIN = 256  # at which leakage is tabulated: within 1 % of a node's own down to a tenth of the largest; chosen
_LEAKAGE_BINS = 6  # bins either way in which a node shows: beyond them less than 3e-6 of its energy; chosen


@dataclass(frozen=True, eq=False)
class _Nodes:
    """Each node's band, its frequency and width [rad/s], (p,)."""

    band: Index
    omega: Array
    width: Array


@dataclass(frozen=True, eq=False)
class TransformBins:
    """Bins of a stretch's transform: omega (k,) [rad/s], `stride` of the transform's steps [rad/s] apart."""

    omega: Array
    step: float
    stride: int


def band_edges(omega: Array, effect: WaveEffect) -> Array:
    """Return edges of the bands of wave frequency (n + 1,) [rad/s], evenly spaced in logarithm.

    omega: (k,), rad/s, of the transform; effect: of the waves, whose range bounds the bands.
    """
    longest, shortest = effect.frequency_range
    low, high = max(_LONGEST * float(omega[0]), longest), min(_SHORTEST * float(omega[-1]), shortest)
    return np.exp(math.log(low) + BAND * np.arange(math.ceil(math.log(high / low) / BAND) + 1))


def encounter_matrix(bins: TransformBins, edges: Array, U: float, headings: Array, effect: WaveEffect) -> "csr_array":
    """Return the density at k bins of the disturbance for unit density of waves in each band, (k, n), sparse.

    edges: (n + 1,), rad/s; U: m/s; headings: (h,), rad, 0 following; the mean over them is returned.

    Raises:
        InputError: speed or heading out of sense.
    """
    from scipy.sparse import csr_array

    step, leakage = bins.step, _leakage()
    last = bins.stride * (len(bins.omega) - 1)
    rows, columns, values = [], [], []
    for beta in headings.tolist():
        speed_factor(U, beta)  # refuses what is out of sense
        nodes = _nodes(edges, U, beta, step)
        places = (np.abs(encounter_frequency(nodes.omega, U, beta)) - bins.omega[0]) / step
        share = nodes.width / (_WINDOW_POWER * step * len(headings))
        energy = np.abs(effect.amplitude(nodes.omega, U, beta)) ** 2 * share
        near = np.rint(places).astype(int)
        shows = (near > -_LEAKAGE_BINS) & (near < last + _LEAKAGE_BINS)
        row = near[shows, None] + np.arange(-_LEAKAGE_BINS, _LEAKAGE_BINS + 1)
        part = np.rint((places - near + 0.5)[shows] * _PLACES_A_BIN).astype(int)
        value = leakage[part] * energy[shows, None]
        inside = (row >= 0) & (row <= last) & (row % bins.stride == 0)
        rows.append(row[inside] // bins.stride)
        columns.append(np.broadcast_to(nodes.band[shows, None], row.shape)[inside])
        values.append(value[inside])
    cells = np.concatenate(rows), np.concatenate(columns)
    return csr_array((np.concatenate(values), cells), shape=(len(bins.omega), len(edges) - 1))


@cache
def _leakage() -> Array:
    """Return what the bins about the nearest one show of a node, half a bin below that to half a bin above, (p, 13)."""
    places = np.arange(_PLACES_A_BIN + 1) / _PLACES_A_BIN - 0.5
    return hann_leakage(np.arange(-_LEAKAGE_BINS, _LEAKAGE_BINS + 1) - places[:, None])


def _nodes(edges: Array, U: float, beta: float, step: float) -> _Nodes:
    """Return nodes so close that they are met at most a third of a bin apart."""
    met = encounter_frequency(edges, U, beta)
    counts = np.maximum(np.ceil(_NODES_A_BIN * np.abs(np.diff(met)) / step), 1.0).astype(int)
    band = np.repeat(np.arange(len(counts)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    width = (np.diff(edges) / counts)[band]
    return _Nodes(band, edges[band] + (np.arange(len(band)) - first + 0.5) * width, width)
