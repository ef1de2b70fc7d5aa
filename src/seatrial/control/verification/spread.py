"""What chance makes of a value of spectra: segments of each leg left out in turn."""

from collections.abc import Callable, Sequence

import numpy as np

from seatrial.estimation.sea import StretchSpectra
from seatrial.physics.hydro.excitation import Complex

_TOGETHER = 2  # segments left out together, as neighbours overlap


def products(spectra: StretchSpectra) -> Complex:
    """Return transforms times conjugate transforms of each segment, (m, k, c, c)."""
    return np.einsum("mkc,mkd->mkcd", spectra.transforms, spectra.transforms.conj())


def jackknife_deviation(legs: Sequence[Complex], value: Callable[[Sequence[Complex]], float]) -> float:
    """Return the standard deviation of a value of the legs' mean products, (k, c, c) each.

    legs: products of each leg's segments, (m, k, c, c). Pairs of segments are left out in turn (delete-group jackknife:
    Kott 2001, Journal of Official Statistics 17, 521-526); legs are independent.
    """
    means = [leg.mean(axis=0) for leg in legs]
    total = 0.0
    for k, leg in enumerate(legs):
        groups = np.array_split(np.arange(len(leg)), max(2, len(leg) // _TOGETHER))
        values = [value([*means[:k], np.delete(leg, g, axis=0).mean(axis=0), *means[k + 1 :]]) for g in groups]
        count = len(groups)
        total += (count - 1) / count * float(np.sum((np.array(values) - np.mean(values)) ** 2))
    return float(np.sqrt(total))
