"""Ships that the prior allows: the model itself first, then draws that cover what it may be wrong by."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.design.task import DesignTask

# ships drawn lie within so many standard deviations, ours
_MAX_DEVIATES = 2.0


@dataclass(frozen=True, eq=False)
class PriorShips:
    """Parameters (n, np) of every ship, the model's own first; precision (k,) of the free coefficients' priors."""

    parameters: Array
    precision: Array

    @property
    def count(self) -> int:
        """How many ships there are."""
        return len(self.parameters)


def draw_ships(task: DesignTask, seed: int, draws: int | None = None) -> PriorShips:
    """The model and `draws` ships about it (default: the task's), spread evenly (Latin hypercube; McKay et al. 1979).

    A coefficient without a prior differs by up to the task's spread of its characteristic scale, evenly; one with a
    Gaussian prior, or all where a fit gives their covariance, by normal deviates of up to two standard deviations.
    Bounds are kept.
    """
    parameters = task.model.parameters
    free = parameters.free
    count = task.request.draws if draws is None else draws
    unit = _latin_hypercube(count, len(free), np.random.default_rng(seed))
    drawn = np.tile(parameters.values, (count + 1, 1))
    if count:
        values = np.clip(_prior_values(task, unit), [p.lower for p in free], [p.upper for p in free])
        drawn[1:, [parameters.index(p.name) for p in free]] = values
    precision = np.array([0.0 if p.prior is None else p.prior.standard_deviation**-2 for p in free])
    return PriorShips(drawn, precision)


def relative_spread(task: DesignTask) -> Array:
    """Return how far ships differ in each free coefficient, as a share of its magnitude, shape (k,)."""
    free = task.model.parameters.free
    if task.covariance is not None:
        deviations = np.sqrt(np.diag(task.covariance))
        return np.array([d / p.characteristic_scale for d, p in zip(deviations, free, strict=True)])
    return np.array(
        [
            task.request.relative_spread if p.prior is None else p.prior.standard_deviation / p.characteristic_scale
            for p in free
        ]
    )


def _latin_hypercube(count: int, size: int, generator: np.random.Generator) -> Array:
    """Return one point in every `count`-th part of each side of the unit cube, (count, size)."""
    parts = np.array([generator.permutation(count) for _ in range(size)]).T
    return (parts + generator.random((count, size))) / max(count, 1)


def _prior_values(task: DesignTask, unit: Array) -> Array:
    free = task.model.parameters.free
    values = np.array([p.value for p in free])
    normal = np.clip(_normal_deviates(unit), -_MAX_DEVIATES, _MAX_DEVIATES)
    if task.covariance is not None:
        roots, vectors = np.linalg.eigh(task.covariance)
        return values + normal @ (vectors * np.sqrt(np.maximum(roots, 0.0))).T
    even = (2.0 * unit - 1.0) * task.request.relative_spread
    scale = np.array([p.characteristic_scale for p in free])
    own = [p.prior is not None for p in free]
    deviation = np.array([0.0 if p.prior is None else p.prior.standard_deviation for p in free])
    return values + np.where(own, normal * deviation, even * scale)


def _normal_deviates(unit: Array) -> Array:
    from scipy.special import ndtri

    return ndtri(np.clip(unit, 1e-9, 1.0 - 1e-9))  # within 6 standard deviations; chosen
