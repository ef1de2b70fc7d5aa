"""Wild horse optimiser (Naruei & Keynia 2022, Engineering with Computers 38, 3025-3056), as Qi et al. 2025 print it."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from seatrial.numerics.optimise.least_squares import Array
from seatrial.numerics.optimise.population import Box, FitnessMemory, Population, SearchError, reject_nonfinite_settings


class StrideVariant(Enum):
    """How a stride turns.

    PAPER: cos(2 pi R Z) with one R in [-2, 2] for each horse (eq. 15); leaders draw their own Z and R.
    REFERENCE: cos(2 pi R) with R = -2 + 4 Z, as in the authors' published program, where a leader takes the stride
        of the last foal of its group again.
    """

    PAPER = "paper"
    REFERENCE = "reference"


@dataclass(frozen=True)
class HerdSettings:
    """Settings of the wild horse optimiser, defaults from Qi et al. 2025, section 4.1.

    Attributes:
        population: horses, N.
        iterations: populations evaluated, the first included, T_max.
        P_S: share of leaders.
        P_C: probability of mating instead of grazing.
        variant: how a stride turns.
        memory: what becomes of the leaders' fitness.
    """

    population: int = 40
    iterations: int = 200
    P_S: float = 0.25
    P_C: float = 0.13
    variant: StrideVariant = StrideVariant.PAPER
    memory: FitnessMemory = FitnessMemory.KEEP

    def __post_init__(self) -> None:
        reject_nonfinite_settings(self)
        groups = self.groups
        if groups < 3 or self.population < 2 * groups:
            raise SearchError(
                f"The wild horse optimiser needs 3 groups or more with a foal each, but has {groups} groups and "
                f"{self.population - groups} foals (population {self.population}, share of leaders "
                f"{self.P_S:g}); raise the population, or take a share between 0.1 and 0.5."
            )
        if not 0 <= self.P_C <= 1:
            raise SearchError(f"The crossover probability P_C lies between 0 and 1, not at {self.P_C}.")

    @property
    def groups(self) -> int:
        """Number of groups, G = ceil(N P_S)."""
        return int(np.ceil(round(self.population * self.P_S, 9)))  # digits, against rounding; chosen


class WildHorse(Population):
    """Groups of foals that graze round their leader or mate, while leaders move about the waterhole.

    An ask holds the foals, then one trial of each leader; as a leader's trial depends on no foal of its iteration, it
    loses nothing against one evaluation after the other. All groups move at once: mates are the worst foals of the
    last population, where the authors' program meets some that have moved already. A leader keeps its place unless
    the trial is better, then changes places with a better foal (eq. 20). The waterhole is the best leader.

    Eq. 19 is not invariant to a shift of the unknowns: -WH sends leaders through zero. The population therefore lives
    in the coordinates of the box that was given. With `Memory.RE_EVALUATE` the leaders, shape (groups, d), follow in
    every ask but the first.
    """

    def __init__(self, box: Box, generator: np.random.Generator, settings: HerdSettings | None = None) -> None:
        self.settings = settings or HerdSettings()
        super().__init__(box, generator, self.settings.iterations)
        groups = self.settings.groups
        horses = box.random_points(generator, self.settings.population)
        self._leaders, self._foals = horses[:groups], horses[groups:]
        self._leader_fitness = np.full(groups, np.inf)
        self._foal_fitness = np.full(len(self._foals), np.inf)
        self._group_of_foal = np.arange(len(self._foals)) % groups
        self._last_foal = len(self._foals) - 1 - (len(self._foals) - 1 - np.arange(groups)) % groups

    @property
    def best(self) -> tuple[Array, float]:
        """The waterhole: the best leader, and its fitness."""
        first = int(np.argmin(self._leader_fitness))
        return self._leaders[first].copy(), float(self._leader_fitness[first])

    def _propose(self) -> Array:
        if self.iteration == 0:
            return np.concatenate([self._foals, self._leaders])
        z, stride = self._strides(len(self._foals))
        mating = self._generator.random((len(self._foals), 1)) < self.settings.P_C
        leaders = self._leaders[self._group_of_foal]
        grazed = stride * (leaders - self._foals) + leaders  # eq. 15
        foals = np.where(mating, self._mating_foals(), grazed)
        if self.settings.variant is StrideVariant.REFERENCE:
            z, stride = z[self._last_foal], stride[self._last_foal]
        else:
            z, stride = self._strides(len(self._leaders))
        moved = self._scatter(np.concatenate([foals, self._leader_trials(z, stride)]))
        return moved if self.settings.memory is FitnessMemory.KEEP else np.concatenate([moved, self._leaders])

    def _learn(self, points: Array, fitness: Array) -> None:
        count, groups = len(self._foals), len(self._leaders)
        self._foals, self._foal_fitness = points[:count].copy(), fitness[:count].copy()
        trials, trial_fitness = points[count : count + groups], fitness[count : count + groups]
        if len(fitness) > count + groups:
            self._leader_fitness = fitness[count + groups :]
        better = (trial_fitness < self._leader_fitness) | (self.iteration == 0)
        self._leaders = np.where(better[:, None], trials, self._leaders)
        self._leader_fitness = np.where(better, trial_fitness, self._leader_fitness)
        self._exchange()

    def _strides(self, count: int) -> tuple[Array, Array]:
        """Return Z (eq. 16) and 2 Z cos(...) (eq. 15) of some horses, shapes (count, d)."""
        generator, shape = self._generator, (count, self.box.size)
        fading = 1 - (self.iteration + 1) / self.iterations  # eq. 17; the first population is T = 1
        inside = generator.random(shape) < fading
        z = np.where(inside, generator.random(shape), generator.random((count, 1)))
        if self.settings.variant is StrideVariant.REFERENCE:
            return z, 2 * z * np.cos(2 * np.pi * (4 * z - 2))
        turn = generator.uniform(-2, 2, (count, 1))
        return z, 2 * z * np.cos(2 * np.pi * turn * z)

    def _mating_foals(self) -> Array:
        """Return for each foal the mean of the worst foals of two other groups, eq. 18; shape (foals, d)."""
        groups, count = len(self._leaders), len(self._foals)
        first = self._generator.integers(groups - 1, size=count)
        second = self._generator.integers(groups - 2, size=count)
        second += second >= first
        worst = self._foals[
            _fitness_by_group(self._foal_fitness, groups, -np.inf).argmax(axis=0) * groups + np.arange(groups)
        ]
        return (
            worst[(self._group_of_foal + 1 + first) % groups] + worst[(self._group_of_foal + 1 + second) % groups]
        ) / 2

    def _leader_trials(self, z: Array, stride: Array) -> Array:  # noqa: ARG002
        """Return a trial for each leader, eq. 19; shape (groups, d)."""
        waterhole = self.best[0]
        side = np.where(self._generator.random((len(stride), 1)) >= 0.5, 1.0, -1.0)
        return stride * (waterhole - self._leaders) + side * waterhole

    def _scatter(self, points: Array) -> Array:
        """Return points moved against all laws: none."""
        return points

    def _exchange(self) -> None:
        """Let a foal better than its leader take its place, eq. 20."""
        groups = len(self._leaders)
        first = _fitness_by_group(self._foal_fitness, groups, np.inf).argmin(axis=0) * groups + np.arange(groups)
        rising = np.flatnonzero(self._foal_fitness[first] < self._leader_fitness)
        foals = first[rising]
        risen, risen_fitness = self._foals[foals], self._foal_fitness[foals]
        self._foals[foals], self._foal_fitness[foals] = self._leaders[rising], self._leader_fitness[rising]
        self._leaders[rising], self._leader_fitness[rising] = risen, risen_fitness


def _fitness_by_group(fitness: Array, groups: int, missing: float) -> Array:
    """Return the fitness of foals dealt out to groups in turn, shape (foals in the largest group, groups)."""
    rows = -(-len(fitness) // groups)
    table = np.full(rows * groups, missing)
    table[: len(fitness)] = fitness
    return table.reshape(rows, groups)


@dataclass(frozen=True)
class ImprovedHerdSettings(HerdSettings):
    """Settings of the improved wild horse optimiser, defaults from Qi et al. 2025, sections 2.2 and 4.1.

    Attributes:
        scatter: probability that a horse is drawn anew in the whole box (eq. 21).
        omega_min, omega_max: limits of the waterhole's weight (eq. 22); both 1: eq. 23 is the first line of eq. 19.
        has_competition: whether leaders compete for the waterhole (eq. 24); else they move by the second line of
            eq. 19.
    """

    scatter: float = 0.05
    omega_min: float = 0.1
    omega_max: float = 0.9
    has_competition: bool = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.scatter <= 1:
            raise SearchError(f"The scatter probability lies between 0 and 1, not at {self.scatter}.")


class ImprovedWildHorse(WildHorse):
    """The wild horse optimiser with scattered horses and another law for leaders (eqs. 21-25).

    A scattered leader's point is its trial: it is taken only where it is better, like every move of a leader. The
    fitness in eq. 22 is that of the population of the last iteration; points that could not be evaluated do not enter
    its mean. Eq. 23 draws leaders towards omega WH, that is towards zero: the coordinates of the box matter.
    """

    def __init__(self, box: Box, generator: np.random.Generator, settings: ImprovedHerdSettings | None = None) -> None:
        self.improved_settings = settings or ImprovedHerdSettings()
        super().__init__(box, generator, self.improved_settings)

    def _scatter(self, points: Array) -> Array:
        anew = self._generator.random((len(points), 1)) < self.improved_settings.scatter
        return np.where(anew, self.box.random_points(self._generator, len(points)), points)  # eq. 21

    def _leader_trials(self, z: Array, stride: Array) -> Array:
        waterhole = self.best[0]
        ahead = self._generator.random((len(stride), 1)) >= 0.5
        q1, q2 = self._generator.uniform(-1, 1, (2, len(stride), 1))
        near = stride * (waterhole - self._leaders) + self._waterhole_weights()[:, None] * waterhole  # eq. 23
        rival = waterhole - z * (self._leaders * q1 - self._leaders * q2)  # eq. 24
        if not self.improved_settings.has_competition:
            rival = stride * (waterhole - self._leaders) - waterhole  # eq. 19, second line
        return np.where(ahead, near, rival)  # eq. 25

    def _waterhole_weights(self) -> Array:
        """Return the weight of the waterhole for each leader, eq. 22, shape (groups,)."""
        low, high = self.improved_settings.omega_min, self.improved_settings.omega_max
        own = self._leader_fitness
        known = np.concatenate([own, self._foal_fitness])
        known = known[np.isfinite(known)]
        if not known.size:
            return np.full(len(own), high)
        least, mean = known.min(), known.mean()
        good = own <= mean
        share = np.where(good, own, mean) - least
        return np.where(good, low + (high - low) * share / (mean - least if mean > least else 1.0), high)
