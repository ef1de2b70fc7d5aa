"""Particle swarms by hand: eq. 29 of Qi et al. 2025, weights and mutations of Meng et al. 2014."""

import numpy as np
import pytest
from tests.numerics.optimise.landscapes import BOX, SQUARE

from seatrial.numerics.optimise import CloudParticleSwarm, CloudSettings, ParticleSwarm, SearchError, SwarmSettings


def test_two_steps_by_hand() -> None:
    settings = SwarmSettings(population=12, iterations=9, omega=0.6, c1=1.2, c2=0.9, velocity_limit=0.15)
    swarm = ParticleSwarm(BOX, np.random.default_rng(4), settings)
    draw = np.random.default_rng(4)
    x = BOX.random_points(draw, 12)
    v = (BOX.random_points(draw, 12) - x) / 2
    own, value = x.copy(), np.full(12, np.inf)
    for _ in range(4):
        assert np.array_equal(swarm.ask(), x)
        swarm.tell(SQUARE(x))
        for i, f in enumerate(SQUARE(x)):
            if f < value[i]:
                own[i], value[i] = x[i], f
        leader = own[np.argmin(value)]
        r = draw.random((2, 12, 8))
        for i in range(12):
            for j in range(8):
                wide = 0.15 * BOX.width[j]
                v[i, j] = (
                    0.6 * v[i, j] + 1.2 * r[0, i, j] * (own[i, j] - x[i, j]) + 0.9 * r[1, i, j] * (leader[j] - x[i, j])
                )
                v[i, j] = min(max(v[i, j], -wide), wide)
                free = x[i, j] + v[i, j]
                x[i, j] = min(max(free, BOX.lower[j]), BOX.upper[j])
                v[i, j] = v[i, j] if x[i, j] == free else 0.0


class Shown(CloudParticleSwarm):
    """Shows its weights."""

    def weights(self) -> np.ndarray:
        return self._inertia()[:, 0]


def test_weights_by_the_ratio_of_fitness() -> None:
    swarm = Shown(BOX, np.random.default_rng(1), CloudSettings(population=6, He=0.0))
    swarm.ask()
    swarm.tell(np.array([1.0, 1.05, 1.1, 2.0, 6.0, np.inf]))
    ratio = 1 / np.array([1.1, 2.0, 6.0])
    cloud = 0.9 - 0.5 * np.exp(-((ratio - 4.1) ** 2) / 50)  # eq. 6: Ex = 5 (.9) - .4, En = 5
    assert np.allclose(swarm.weights(), [0.4, 0.4, *cloud, 0.9], rtol=1e-14)


def test_a_perfect_particle_is_good_and_the_others_are_bad() -> None:
    swarm = Shown(BOX, np.random.default_rng(1), CloudSettings(population=3))
    swarm.ask()
    swarm.tell(np.array([0.0, 1.0, 0.0]))
    assert swarm.weights().tolist() == [0.4, 0.9, 0.4]


def test_only_particles_that_are_not_good_become_drops_round_the_best() -> None:
    still = {"population": 40, "c1": 0.0, "c2": 0.0, "w1": 0.0, "w2": 0.0}
    swarm = CloudParticleSwarm(BOX, np.random.default_rng(2), CloudSettings(**still, p_m=1.0, spread=1e-6))
    before = swarm.ask().copy()
    fitness = np.where(np.arange(40) % 2 == 0, 1.0, 2.0)
    swarm.tell(fitness)
    after = swarm.ask()
    assert np.array_equal(after[::2], before[::2])
    away = (after[1::2] - before[0]) / BOX.width
    assert 0.8e-6 < away.std() < 1.2e-6


def test_a_negative_fitness_has_no_ratio() -> None:
    swarm = CloudParticleSwarm(BOX, np.random.default_rng(2))
    points = swarm.ask()
    with pytest.raises(SearchError, match="row 3 has -1"):
        swarm.tell(np.where(np.arange(len(points)) == 3, -1.0, 1.0))
    assert np.array_equal(swarm.ask(), points)
