"""Ships that a fit allows: drawn from its covariance, each trimmed anew, and how many a controller keeps stable."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from seatrial.control.ship.vessel import at_values, plant_of, sides_of
from seatrial.control.task import Task, Vessel
from seatrial.core.values import Array, InputError
from seatrial.estimation.predict.draws import root
from seatrial.numerics.kernels.loop import is_hurwitz
from seatrial.physics.loops import Block, TransferLoop

SEED, DRAWS = 0, 100


@dataclass(frozen=True, eq=False)
class Fleet:
    """Ships drawn, `draws` of them; `lost` have no trim, or an actuator without effect.

    Attributes:
        ships: the others; plants: of each, the mean of both sides and, where they differ, the two sides.
    """

    draws: int
    ships: tuple[Vessel, ...]
    plants: tuple[tuple[Block, ...], ...]

    @property
    def lost(self) -> int:
        """How many could not be trimmed; no controller is counted stable on them."""
        return self.draws - len(self.ships)

    def stable(self, loop: TransferLoop, gains: Array) -> tuple[bool, ...]:
        """Whether each ship's loop is stable with the gains (g,), on the straight course and beginning either turn."""
        return tuple(all(_is_stable(loop, plant, gains) for plant in plants) for plants in self.plants)


@lru_cache(maxsize=8)
def fleet(ship: Vessel, draws: int = DRAWS, seed: int = SEED) -> Fleet:
    """Gaussian draws of the free parameters from the fit's covariance; none where there is no covariance.

    The same seed gives the same ships. Nothing is truncated.
    """
    if not ship.covariance.size or not draws:
        return Fleet(0, (), ())
    free = ship.model.parameters.free
    centre: Array = np.array([p.value for p in free])
    points = centre + np.random.default_rng(seed).standard_normal((draws, len(free))) @ root(ship.covariance).T
    ships, plants = [], []
    for point in points:
        try:
            drawn = at_values(ship, dict(zip([p.name for p in free], point.tolist(), strict=True)))
            plants.append(_plants(drawn))
            ships.append(drawn)
        except InputError:
            continue
    return Fleet(draws, tuple(ships), tuple(plants))


def robust(task: Task, gains: Array, loop: TransferLoop | None = None, *, draws: int = DRAWS) -> tuple[int, int]:
    """How many of the ships drawn the gains (g,) keep stable, and how many were drawn; (0, 0) without a covariance."""
    if task.vessel is None:
        return 0, 0
    made = fleet(task.vessel, draws, SEED)
    return sum(made.stable(task.loop if loop is None else loop, gains)), made.draws


def _plants(ship: Vessel) -> tuple[Block, ...]:
    mean, _ = plant_of(ship)
    sides = sides_of(ship)
    alike = all(side.den == mean.den and side.num == mean.num for side in sides)
    return (mean,) if alike else (mean, *sides)


def _is_stable(loop: TransferLoop, plant: Block, gains: Array) -> bool:
    """By Routh's scheme on d + sum gain_i n_i with that plant in the place of the loop's own."""
    nums, dens = _through(loop)
    fixed = np.polymul(dens, plant.den)
    moved = np.polymul(gains @ nums, plant.num)
    row = np.polyadd(fixed, moved)
    return bool(is_hurwitz(np.ascontiguousarray(row, dtype=np.float64), len(row) - 1))


@lru_cache(maxsize=8)
def _through(loop: TransferLoop) -> tuple[Array, Array]:
    """Numerators of the controller's terms (g, n) and their common denominator (n,), plant left out."""
    d, n = replace(loop, plant=Block("none")).polynomials
    return n, d
