"""Sums for integrals: exact where they claim to be, and many nodes gathered on few without a loss."""

import math

import numpy as np
import pytest

from seatrial.physics.loops.encounter_spectrum import gather_nodes, nodes, weights


@pytest.mark.parametrize("power", range(8))
def test_weights_are_exact_for_polynomials_up_to_the_seventh_degree(power: int) -> None:
    x = np.linspace(0.0, 1.0, 21)
    assert weights(21) @ x**power / 20.0 == pytest.approx(1.0 / (power + 1.0), rel=1e-13)


def test_weights_converge_with_the_eighth_power_and_beyond_on_a_function_cut_short() -> None:
    off = [abs(weights(n) @ np.exp(np.linspace(0.0, 2.0, n)) * 2.0 / (n - 1) - math.expm1(2.0)) for n in (17, 33)]
    assert off[1] < off[0] / 2.0**8


def test_nodes_integrate_between_edges() -> None:
    omega, width = nodes((0.5, 1.0, 8.0), 120)
    assert len(omega) == 120
    assert np.sum(width * omega**-2) == pytest.approx(1.0 / 0.5 - 1.0 / 8.0, rel=1e-9)
    assert np.sum(width[:60]) == pytest.approx(0.5, rel=1e-9)


def test_gathered_energy_weighs_smooth_functions_as_before(rng: np.random.Generator) -> None:
    omega, energy = np.abs(rng.normal(size=20_000)) * 3.0, rng.random(20_000)
    few, made = gather_nodes(omega, energy[None], 512)
    made = made[0]
    assert few.shape == made.shape == (512,)
    assert few[0] > 0.0 and np.all(np.diff(few) > 0.0)
    for damping, limit in ((1.0, 1e-10), (0.16, 1e-8), (0.08, 1e-6), (0.05, 1e-5)):
        size = [1.0 / ((1.0 - w**2) ** 2 + (2.0 * damping * w) ** 2) for w in (omega, few)]
        assert size[1] @ made == pytest.approx(size[0] @ energy, rel=limit)
    assert made.sum() == pytest.approx(energy.sum(), rel=1e-12)
