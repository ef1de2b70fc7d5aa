"""Ship and seas together from legs in waves that nobody measured, with or without control: one ship, a sea each."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.sea.wave_leg import SEA_COUNT, SHIP_COUNT, STEP, WaveLeg
from seatrial.numerics.optimise import NormalEquations, Status, levenberg_marquardt

# log(gamma - 1) before the records: gamma 1.2 to 5.5 within a standard deviation, about what JONSWAP's records have
PEAK_MEAN, PEAK_DEVIATION = 0.0, 1.5
_WIDEST_SHIP = 1.6  # logarithm of a factor on the ship, either way: five times; chosen
_LOWEST_SEA, _HIGHEST_SEA = np.array([-7.0, -3.0, -5.0]), np.array([4.0, 5.0, 3.0])
"""Bounds of a sea's unknowns: 1 mm to 55 m, 0.05 to 150 s, gamma 1.007 to 21; chosen."""
_NEGLIGIBLE, _EVALUATIONS = 1e-6, 200  # promised gain of log-likelihood that ends a search, and its length; chosen
_NO_LOCAL = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class LegPriors:
    """What is known before the legs, as standard deviations.

    Attributes:
        ship: of the ship's factors, (3,); zero holds one.
        sea_change: of the logarithms of height and peak period from one leg to the next, (2,); infinite where the legs
            have nothing to do with one another.
    """

    ship: Array
    sea_change: Array


@dataclass(frozen=True, eq=False)
class LegsInWaves:
    """A `LeastSquares` problem: the ship's factors (3,) and then the unknowns of each leg's sea (3,) in turn."""

    legs: tuple[WaveLeg, ...]
    priors: LegPriors

    @property
    def lower(self) -> Array:
        """Lower bounds."""
        return np.concatenate([np.where(self.priors.ship > 0.0, -_WIDEST_SHIP, 0.0), *[_LOWEST_SEA] * len(self.legs)])

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        return np.concatenate([np.where(self.priors.ship > 0.0, _WIDEST_SHIP, 0.0), *[_HIGHEST_SEA] * len(self.legs)])

    def cost(self, shared: Array, local: Array) -> float:  # noqa: ARG002
        """Return minus the logarithm of the posterior, up to a constant."""
        ship, seas = _split(shared)
        away = shared - self._prior_mean
        legs = sum(leg.likelihood(ship, sea)[0] for leg, sea in zip(self.legs, seas, strict=True))
        return legs + 0.5 * float(away @ self._precision @ away)

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return cost, gradient and Fisher information at a point."""
        ship, seas = _split(shared)
        gradient, hessian = self._precision @ (shared - self._prior_mean), self._precision.copy()
        for k, (leg, sea) in enumerate(zip(self.legs, seas, strict=True)):
            rows = np.r_[:SHIP_COUNT, _sea_slice(k)]
            own_gradient, own_hessian = leg.equations(ship, sea)
            gradient[rows] += own_gradient
            hessian[np.ix_(rows, rows)] += own_hessian
        size = len(shared)
        return NormalEquations(
            self.cost(shared, local), gradient, hessian, _NO_LOCAL, np.zeros((0, 0, 0)), np.zeros((0, size, 0))
        )

    def start(self) -> Array:
        """Return the ship as the model has it, in the sea that explains each leg best."""
        none = np.zeros(SHIP_COUNT)
        return np.concatenate([none, *(leg.start(none, PEAK_MEAN) for leg in self.legs)])

    @property
    def _prior_mean(self) -> Array:
        return np.concatenate([np.zeros(SHIP_COUNT), *[[0.0, 0.0, PEAK_MEAN]] * len(self.legs)])

    @property
    def _precision(self) -> Array:
        """Return the inverse of the covariance before the legs; the first sea's height and period are not known."""
        is_held = self.priors.ship <= 0.0
        ship = np.where(is_held, 0.0, 1.0 / np.where(is_held, 1.0, self.priors.ship) ** 2)
        precision = np.diag(np.concatenate([ship, *[[0.0, 0.0, 1.0 / PEAK_DEVIATION**2]] * len(self.legs)]))
        change = np.diag(1.0 / self.priors.sea_change**2)
        for k in range(len(self.legs) - 1):
            one, other = (np.arange(_sea_slice(leg).start, _sea_slice(leg).start + len(change)) for leg in (k, k + 1))
            for first, second, sign in ((one, one, 1.0), (other, other, 1.0), (one, other, -1.0), (other, one, -1.0)):
                precision[np.ix_(first, second)] += sign * change
        return precision


@dataclass(frozen=True, eq=False)
class LegFit:
    """Ship and seas that the legs show.

    Attributes:
        ship: (3,), of `PLANT_FACTORS`; seas: (s, 3), of `SEA_UNKNOWNS`, a row for each leg.
        covariance: of the ship's unknowns and then the seas' in turn, (3 + 3 s, 3 + 3 s).
        cost: minus the logarithm of the posterior, up to a constant; is_converged: whether the search ended there.
    """

    ship: Array
    seas: Array
    covariance: Array
    cost: float
    is_converged: bool

    @property
    def ship_deviations(self) -> Array:
        """Return standard deviations of the ship's factors, (3,)."""
        return np.sqrt(np.diag(self.covariance)[:SHIP_COUNT])

    def sea_deviations(self, leg: int) -> Array:
        """Return standard deviations of the unknowns of a leg's sea, (3,)."""
        return np.sqrt(np.diag(self.covariance)[_sea_slice(leg)])

    def deviation(self, value: Callable[[Array, Array], float]) -> float:
        """Return the standard deviation of a value of ship (3,) and seas (s, 3), to the first order."""
        centre = np.concatenate([self.ship, self.seas.ravel()])
        ends = ([value(*_split(centre + sign * s)) for sign in (1.0, -1.0)] for s in STEP * np.eye(len(centre)))
        slope = np.array([up - down for up, down in ends]) / (2.0 * STEP)
        return float(np.sqrt(max(slope @ self.covariance @ slope, 0.0)))


def fit_legs(legs: Sequence[WaveLeg], priors: LegPriors) -> LegFit:
    """Return the ship and the seas that explain the legs, in order of time, best."""
    problem = LegsInWaves(tuple(legs), priors)
    optimum = levenberg_marquardt(problem, problem.start(), _NO_LOCAL, negligible=_NEGLIGIBLE, evaluations=_EVALUATIONS)
    is_free = problem.upper > problem.lower
    covariance = np.zeros((len(is_free), len(is_free)))
    covariance[np.ix_(is_free, is_free)] = inverse(optimum.normal.hessian[np.ix_(is_free, is_free)])
    is_converged = optimum.solution.status is Status.CONVERGED
    return LegFit(*_split(optimum.solution.point), covariance, optimum.solution.value, is_converged)


def _split(point: Array) -> tuple[Array, Array]:
    """Return the ship's factors (3,) and the seas (s, 3)."""
    return point[:SHIP_COUNT], point[SHIP_COUNT:].reshape(-1, SEA_COUNT)


def _sea_slice(leg: int) -> slice:
    first = SHIP_COUNT + SEA_COUNT * leg
    return slice(first, first + SEA_COUNT)
