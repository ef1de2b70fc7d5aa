"""Optimisers of others are checked as the built-in ones; every way to break the protocol has its sentence."""

import numpy as np
import pytest

from seatrial.numerics.optimise import Box, ParticleSwarm, SwarmSettings
from seatrial.numerics.optimise.named import OPTIMISERS
from seatrial.testing import ConformanceError, check_optimiser


@pytest.mark.parametrize("name", sorted(OPTIMISERS))
def test_built_in_optimisers_conform(name: str) -> None:
    check_optimiser(OPTIMISERS[name])


class Swarm(ParticleSwarm):
    """A short conforming swarm, from which the broken ones derive."""

    def __init__(self, box: Box, generator: np.random.Generator) -> None:
        super().__init__(box, generator, SwarmSettings(population=20, iterations=60))


class Outside(Swarm):
    def ask(self) -> np.ndarray:
        return super().ask() + self.box.width


class Flat(Swarm):
    def ask(self) -> np.ndarray:
        return super().ask()[0]


class OwnArray(Swarm):
    def ask(self) -> np.ndarray:
        super().ask()
        assert self._pending_points is not None
        return self._pending_points


class Credulous(Swarm):
    def _validate(self, points: np.ndarray, values: np.ndarray) -> None:
        pass


class Unseeded(Swarm):
    def __init__(self, box: Box, generator: np.random.Generator) -> None:
        super().__init__(box, np.random.default_rng() if generator else generator)


class Global(Swarm):
    def _propose(self) -> np.ndarray:
        np.random.random(1000)  # noqa: NPY002
        return super()._propose()


class Endless(Swarm):
    @property
    def done(self) -> bool:
        return False


class Boaster(Swarm):
    @property
    def best(self) -> tuple[np.ndarray, float]:
        return super().best[0], 0.0


class Idle(Swarm):
    def _move(self) -> None:
        pass


@pytest.mark.parametrize(
    ("broken", "sentence"),
    [
        (Outside, "outside the box"),
        (Flat, r"returns shape \(3,\)"),
        (OwnArray, "before tell\\(\\) returns other points"),
        (Credulous, "another length"),
        (Unseeded, "same seed gives other points"),
        (Global, "global generator"),
        (Endless, "still false after"),
        (Boaster, "best claims the fitness 0"),
        (Idle, "a sphere is not minimised"),
    ],
)
def test_violations_are_named(broken: type[Swarm], sentence: str) -> None:
    with pytest.raises(ConformanceError, match=sentence):
        check_optimiser(broken)


def test_the_swarm_without_a_defect_conforms() -> None:
    check_optimiser(Swarm)
