"""Ship and sea of one stretch when the heading to the waves is not known either: draws of all that the motion allows.

A motion's spectrum may fit several seas at several headings, so that no search about one optimum will do. A population
is drawn from a grid of headings and peak periods, each with ships and peaks drawn from what was known before, by the
likelihood to a small power. It then moves by differences of its own members (differential evolution Markov chain: ter
Braak 2006, Statistics and Computing 16, 239-249) while the power rises to one. The height is integrated by its normal
approximation (Laplace: Tierney & Kadane 1986, JASA 81, 82-86). Before the stretch all headings from following to head
seas are equally likely, port and starboard the same, and so is the logarithm of the peak period.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.sea.encountered_sea import sea_spectrum
from seatrial.estimation.sea.legs_in_waves import PEAK_DEVIATION, PEAK_MEAN
from seatrial.estimation.sea.plant_factors import altered_loop
from seatrial.estimation.sea.wave_leg import SHIP_COUNT, WaveLeg
from seatrial.physics.hydro.dispersion import G
from seatrial.physics.loops import TransferLoop

# logarithm of the steepness 2 pi H / (g T^2), H significant height, T peak period, before the stretch: 0.02 lies
# between swell and the Pierson-Moskowitz sea's 0.026, 95 % from 0.0075 to 0.053, short of the 1/15 at which seas
# break (DNV-RP-C205, 3.5.4); chosen
_STEEPNESS_MEAN, _STEEPNESS_DEVIATION = math.log(0.02), 0.5
_HEADINGS, _PERIODS, _SHIPS = 36, 24, 24  # cells of heading and period, and ships and peaks in each; chosen
_SHORTEST, _LONGEST = 0.3, 3.0  # peak periods over the one expected that are looked at; chosen
_MEMBERS = 384  # of the population; chosen: many times its six unknowns, so that none of several headings is lost
_FIRST_POWER = 0.05  # of the likelihood, so that a narrow peak between the grid's points is not lost; chosen
_RISING, _SETTLING, _KEPT = 12, 2, 6  # generations while the power rises, at one, and at one and kept; chosen
_DIFFERENCE = 2.38  # times the difference of two members, over the root of twice the unknowns; ter Braak 2006, eq. (2)
_JUMPS, _JITTER = 0.1, 1e-4  # share of steps of a whole difference, from peak to peak; of every step, random; ter Braak
_SEARCH_STEPS = 6  # of the height's optimum, from the energy of the motion; chosen
_HEIGHTS = math.log(1e-3), math.log(100.0)  # logarithms of heights [m] that are looked at; chosen: more than seas have
_TABLE = np.geomspace(0.25, 8.0, 400)  # frequencies over the peak's at which a spectrum is tabulated; chosen


@dataclass(frozen=True, eq=False)
class ShipInSea:
    """Draws: headings [rad] (n,), of `PLANT_FACTORS` (n, 3), and of `SEA_UNKNOWNS` (n, 3)."""

    headings: Array
    ships: Array
    seas: Array


@dataclass(frozen=True, eq=False)
class _Heights:
    """The optimal logarithm of the height [m], its deviation, and the logarithm of the evidence; any shape."""

    optimum: Array
    deviation: Array
    evidence: Array


@dataclass(frozen=True, eq=False)
class _Target:
    """The posterior of points (6,): heading, logarithm of the period, ship and peak as standard normal numbers.

    deviations: of the ship's factors, (3,); periods: ends of the logarithm of the peak period.
    """

    leg_at: Callable[[float], WaveLeg]
    deviations: Array
    periods: tuple[float, float]

    def heights(self, point: Array) -> _Heights | None:
        """Return the height at a point, shape (1,); None outside what is looked at."""
        beta, period = float(point[0]), float(point[1])
        if not (0.0 < beta < math.pi and self.periods[0] < period < self.periods[1]):
            return None
        leg, peak = self.leg_at(beta), PEAK_MEAN + PEAK_DEVIATION * float(point[-1])
        response = leg.responses(self.deviations * point[2:-1])
        energy = leg.sea.disturbance_energy(np.array([0.0, period, peak]))
        density = leg.sea.leakage @ (response.gain * energy)
        return _heights(leg, density[None], response.by_actuator, np.array([period]))


@dataclass(frozen=True, eq=False)
class _Population:
    """Members: points (n, 6), evidence (n,), optimum and deviation of the height's logarithm, (n,)."""

    points: Array
    evidence: Array
    optimum: Array
    deviation: Array

    def resampled(self, rise: float, rng: np.random.Generator) -> "_Population":
        """Return members drawn by what a rise of the power makes of their weights, in random order."""
        kept = rng.permutation(_resampled(rise * self.evidence, len(self.points), rng)) if rise else slice(None)
        return _Population(*(part[kept] for part in vars(self).values()))

    def stepped(self, target: _Target, power: float, rng: np.random.Generator) -> "_Population":
        """Return the next generation: each half moves by differences of two members of the other."""
        made, half = _Population(*(part.copy() for part in vars(self).values())), len(self.points) // 2
        for movers, others in ((range(half), range(half, 2 * half)), (range(half, 2 * half), range(half))):
            for k in movers:
                one, other = made.points[rng.choice(others, 2, replace=False)]
                factor = 1.0 if rng.random() < _JUMPS else _DIFFERENCE / math.sqrt(2.0 * made.points.shape[1])
                point = made.points[k] + factor * (one - other) + _JITTER * rng.standard_normal(len(one))
                there = target.heights(point)
                gain = -math.inf if there is None else power * (float(there.evidence[0]) - made.evidence[k])
                gain += 0.5 * float(np.sum(made.points[k, 2:] ** 2) - np.sum(point[2:] ** 2))
                if there is not None and math.log(rng.random()) < gain:
                    made.points[k], made.evidence[k] = point, there.evidence[0]
                    made.optimum[k], made.deviation[k] = there.optimum[0], there.deviation[0]
        return made


def draw_ship_in_sea(leg_at: Callable[[float], WaveLeg], deviations: Array, rng: np.random.Generator) -> ShipInSea:
    """Return draws of heading, ship and sea that a stretch allows, in the order in which they were made.

    Args:
        leg_at: the stretch as met at a heading [rad].
        deviations: of the ship's factors before the stretch, (3,).
    """
    target, population = _first_population(leg_at, deviations, rng)
    powers = np.geomspace(_FIRST_POWER, 1.0, _RISING).tolist() + [1.0] * (_SETTLING + _KEPT)
    kept = []
    for generation, power in enumerate(powers):
        if generation:
            population = population.resampled(power - powers[generation - 1], rng)
        population = population.stepped(target, power, rng)
        if generation >= len(powers) - _KEPT:
            kept.append(population)
    points, optimum, deviation = (
        np.concatenate([getattr(one, name) for one in kept]) for name in ("points", "optimum", "deviation")
    )
    height = optimum + deviation * rng.standard_normal(len(points))
    seas = np.column_stack([height, points[:, 1], PEAK_MEAN + PEAK_DEVIATION * points[:, -1]])
    return ShipInSea(points[:, 0], deviations * points[:, 2:-1], seas)


def _first_population(
    leg_at: Callable[[float], WaveLeg], deviations: Array, rng: np.random.Generator
) -> tuple[_Target, _Population]:
    """Return the posterior and a population drawn from a grid by the likelihood to the first power."""
    normal, cell = rng.standard_normal((_SHIPS, SHIP_COUNT + 1)), math.pi / _HEADINGS
    headings, first = cell * (np.arange(_HEADINGS) + 0.5), leg_at(0.5 * math.pi)
    ends = math.log(_SHORTEST * first.expected_period), math.log(_LONGEST * first.expected_period)
    edges = np.linspace(ends[0], ends[1], _PERIODS + 1)
    periods = 0.5 * (edges[1:] + edges[:-1])
    shapes = [_unit_spectrum(PEAK_MEAN + PEAK_DEVIATION * z) for z in normal[:, -1].tolist()]
    ships = [altered_loop(first.observed.loop, deviations * z) for z in normal[:, :-1]]
    evidence = np.array([_grid_evidence(leg_at(beta), ships, shapes, periods) for beta in headings.tolist()])
    chosen = _resampled(_FIRST_POWER * evidence.ravel(), _MEMBERS, rng)
    at_heading, at_ship, at_period = np.unravel_index(rng.permutation(chosen), evidence.shape)
    points: Array = np.column_stack([headings[at_heading], periods[at_period], normal[at_ship]]).astype(np.float64)
    target = _Target(leg_at, deviations, ends)
    heights = [one for one in map(target.heights, points) if one is not None]
    columns = (np.concatenate([getattr(one, name) for one in heights]) for name in ("evidence", "optimum", "deviation"))
    return target, _Population(points, *columns)


def _resampled(log_weight: Array, count: int, rng: np.random.Generator) -> Index:
    """Return places drawn by weight, (count,), at even steps of the cumulated weight (systematic resampling)."""
    cumulated = np.cumsum(np.exp(log_weight - np.max(log_weight)))
    steps = (np.arange(count) + rng.random()) / count
    return np.minimum(np.searchsorted(cumulated, steps * cumulated[-1]), len(cumulated) - 1)


def _unit_spectrum(peak: float) -> Array:
    """Return the density of a sea of 1 m and a peak at 1 rad/s at the frequencies of the table, (400,)."""
    return sea_spectrum(np.array([0.0, math.log(2.0 * math.pi), peak])).density(_TABLE)


def _grid_evidence(leg: WaveLeg, ships: list[TransferLoop], shapes: list[Array], periods: Array) -> Array:
    """Return the evidence of s ships, as loops, each with its shape of the spectrum, at peak periods (p,), (s, p)."""
    peaks = 2.0 * math.pi * np.exp(-periods)[:, None]
    share, inside = leg.sea.omega / peaks, leg.sea.effect_energy * leg.sea.width / peaks
    rows = []
    for ship, shape in zip(ships, shapes, strict=True):
        response = leg.responses_of(ship)
        energy = np.interp(share, _TABLE, shape, left=0.0, right=0.0) * inside
        rows.append(_heights(leg, (response.gain * energy) @ leg.sea.leakage.T, response.by_actuator, periods).evidence)
    return np.array(rows)


def _heights(leg: WaveLeg, density: Array, rest: Array, periods: Array) -> _Heights:
    """Return the heights whose H^2 density (p, k) + rest (k,) explains the leg, at peak periods (p,).

    By Fisher scoring; the cost is that of `WaveLeg`, with the prior of the steepness.
    """
    observed, information = leg.observed.output_density, leg.spectra.information
    density = np.maximum(density, np.finfo(np.float64).tiny)
    expected = _STEEPNESS_MEAN - math.log(2.0 * math.pi / G) + 2.0 * periods
    x = np.clip(0.5 * np.log(np.sum(observed) / np.sum(density, axis=1)), *_HEIGHTS)
    precision = np.ones_like(x)
    for _ in range(_SEARCH_STEPS):
        total = np.exp(2.0 * x)[:, None] * density + rest
        slope = 2.0 * (1.0 - rest / total)
        precision = information * np.sum(slope**2, axis=1) + _STEEPNESS_DEVIATION**-2
        gradient = information * np.sum(slope * (1.0 - observed / total), axis=1)
        x = np.clip(x - (gradient + (x - expected) * _STEEPNESS_DEVIATION**-2) / precision, *_HEIGHTS)
    total = np.exp(2.0 * x)[:, None] * density + rest
    cost = information * np.sum(np.log(total) + observed / total, axis=1)
    cost += 0.5 * ((x - expected) / _STEEPNESS_DEVIATION) ** 2
    return _Heights(x, precision**-0.5, -cost - 0.5 * np.log(precision))
