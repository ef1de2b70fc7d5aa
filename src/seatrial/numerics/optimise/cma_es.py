"""Covariance matrix adaptation evolution strategy (Hansen 2016, arXiv:1604.00772), by the package `cmaes`."""

from dataclasses import dataclass
from math import floor, log

import numpy as np

from seatrial.numerics.optimise.least_squares import Array, Status
from seatrial.numerics.optimise.population import Box, Population, SearchError, reject_nonfinite_settings


@dataclass(frozen=True)
class AdaptationSettings:
    """Settings of the evolution strategy.

    Attributes:
        population: points of a generation; None for 4 + floor(3 ln d), eq. 48.
        iterations: generations at most.
        step: first standard deviation, as a share of the box's width.
        resampling: draws of a point before it is put on the wall of the box.
    """

    population: int | None = None
    iterations: int = 200
    step: float = 0.3
    resampling: int = 20

    @staticmethod
    def default_population(unknowns: int) -> int:
        """Return the points of a generation where none are given, eq. 48."""
        return 4 + floor(3 * log(unknowns))

    def __post_init__(self) -> None:
        reject_nonfinite_settings(self)
        if self.population is not None and self.population < 4:
            raise SearchError(f"The evolution strategy needs at least 4 points a generation, not {self.population}.")
        if not self.step > 0:
            raise SearchError(f"The first step is a positive share of the box's width, not {self.step}.")


class CovarianceAdaptation(Population):
    """The package's strategy in the unit box, from `start` or the box's centre; done when it says so, too.

    It remembers no fitness from one generation to the next but that of the best point, so there is nothing to
    re-evaluate. Points of infinite fitness rank last.
    """

    def __init__(
        self,
        box: Box,
        generator: np.random.Generator,
        settings: AdaptationSettings | None = None,
        start: Array | None = None,
    ) -> None:
        from cmaes import CMA

        self.settings = settings or AdaptationSettings()
        super().__init__(box, generator, self.settings.iterations)
        unit = np.stack([np.zeros(box.size), np.ones(box.size)], axis=1)
        self._strategy = CMA(
            mean=np.full(box.size, 0.5) if start is None else (start - box.lower) / box.width,
            sigma=self.settings.step,
            bounds=unit,
            n_max_resampling=self.settings.resampling,
            seed=int(generator.integers(2**32)),
            population_size=self.settings.population or self.settings.default_population(box.size),
        )
        self._unit_points = np.zeros((0, box.size))
        self._best, self._best_fitness = box.scaled(unit.mean(axis=1)), np.inf
        self._has_converged = False

    @property
    def best(self) -> tuple[Array, float]:
        """Best point so far and its fitness."""
        return self._best.copy(), self._best_fitness

    @property
    def done(self) -> bool:
        """Whether the generations are spent, or the strategy cannot improve."""
        return super().done or self._has_converged

    @property
    def status(self) -> Status:
        """Converged, to a minimum that need not be the least one, where the strategy stopped by itself."""
        return Status.CONVERGED if self._has_converged else Status.EXHAUSTED

    def _propose(self) -> Array:
        self._unit_points = np.array([self._strategy.ask() for _ in range(self._strategy.population_size)])
        return self.box.scaled(self._unit_points)

    def _learn(self, points: Array, fitness: Array) -> None:
        first = int(np.argmin(fitness))
        if fitness[first] < self._best_fitness:
            self._best, self._best_fitness = points[first].copy(), float(fitness[first])
        known = np.isfinite(fitness)
        worst = 2 * np.max(np.abs(fitness[known])) + 1 if known.any() else 1.0
        ranked = np.where(known, fitness, worst)
        self._strategy.tell(list(zip(self._unit_points, ranked.tolist(), strict=True)))
        self._has_converged = bool(known.any() and self._strategy.should_stop())
