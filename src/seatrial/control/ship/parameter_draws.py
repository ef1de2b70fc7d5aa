"""Ships sampled from the covariance of a fit, each trimmed anew, and how many of them a controller keeps stable."""

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice

import numpy as np

from seatrial.control.ship.trimmed_ship import one_sided_plants, plant_and_disturbance, with_parameters
from seatrial.control.task import TrimmedShip, TuningTask
from seatrial.core.values import Array, InputError
from seatrial.estimation.predict.draws import square_root
from seatrial.numerics.kernels.loop import is_hurwitz
from seatrial.physics.loops import Block, TransferLoop

SEED, DRAWS = 0, 100  # of the ships drawn, and how many; chosen
_KEPT = 8  # results kept in memory: one for each plant in use; chosen


@dataclass(frozen=True, eq=False)
class ParameterDraws:
    """Ships sampled from the covariance of a fit.

    Attributes:
        draws: number of samples, also of those without a trim or with an actuator without effect; no controller counts
            as stable on these.
        ships: the trimmed samples; plants: of each, the mean of both sides and, where they differ, the two sides.
    """

    draws: int
    ships: tuple[TrimmedShip, ...]
    plants: tuple[tuple[Block, ...], ...]

    def stable_ships(self, loop: TransferLoop, gains: Array) -> tuple[bool, ...]:
        """Return for each ship whether gains (g,) stabilise it, on the straight course and starting either turn."""
        rows = [d + gains @ n for d, n in _characteristic_polynomials(loop, self)]
        stable = iter([is_hurwitz(np.ascontiguousarray(row), len(row) - 1) for row in rows])
        return tuple(all(list(islice(stable, len(plants)))) for plants in self.plants)


@lru_cache(maxsize=_KEPT)
def draw_parameters(ship: TrimmedShip, draws: int = DRAWS, seed: int = SEED) -> ParameterDraws:
    """Return ships sampled from the Gaussian of the free parameters; none where the fit has no covariance.

    The same seed gives the same ships. Nothing is truncated.
    """
    if not ship.covariance.size or not draws:
        return ParameterDraws(0, (), ())
    free = ship.model.parameters.free
    centre: Array = np.array([p.value for p in free])
    points = centre + np.random.default_rng(seed).standard_normal((draws, len(free))) @ square_root(ship.covariance).T
    ships, plants = [], []
    for point in points:
        try:
            sampled = with_parameters(ship, dict(zip([p.name for p in free], point.tolist(), strict=True)))
            plants.append(_plant_blocks(sampled))
            ships.append(sampled)
        except InputError:
            continue
    return ParameterDraws(draws, tuple(ships), tuple(plants))


def stable_draws(
    task: TuningTask, gains: Array, loop: TransferLoop | None = None, *, draws: int = DRAWS
) -> tuple[int, int]:
    """Return how many sampled ships the gains (g,) stabilise, and how many were sampled; (0, 0) without covariance."""
    if task.trimmed_ship is None:
        return 0, 0
    samples = draw_parameters(task.trimmed_ship, draws, SEED)
    return sum(samples.stable_ships(task.loop if loop is None else loop, gains)), samples.draws


def _plant_blocks(ship: TrimmedShip) -> tuple[Block, ...]:
    mean, _ = plant_and_disturbance(ship)
    sides = one_sided_plants(ship)
    alike = all(side.den == mean.den and side.num == mean.num for side in sides)
    return (mean,) if alike else (mean, *sides)


@lru_cache(maxsize=_KEPT)
def _characteristic_polynomials(loop: TransferLoop, samples: ParameterDraws) -> tuple[tuple[Array, Array], ...]:
    """Return d and n of the loop before each plant drawn, in a row: it is stable where d + gains n is, by Routh."""
    return tuple(replace(loop, plant=plant).polynomials for plants in samples.plants for plant in plants)
