"""Trials of the known ships that turn and roll: how each begins, and to which side it heels."""

from collections.abc import Callable

import numpy as np
import pytest

from seatrial.problems.rolling_ship import RollingShip, rolling_container_ship, rolling_expansion, rolling_tanker


@pytest.mark.parametrize("known", [rolling_container_ship, rolling_tanker, rolling_expansion])
def test_a_ship_heels_outwards_in_its_circle_and_rolls_out_from_its_release(
    known: Callable[[], RollingShip], rng: np.random.Generator
) -> None:
    ship = known()
    runs = ship.runs()
    assert len(runs) == len(ship.manoeuvres) + len(ship.decays)
    circle = runs[list(ship.manoeuvres).index("turning-circle:35")]
    last = slice(-len(circle) // 4, None)
    assert np.mean(circle["phi"][last]) * np.mean(circle["r"][last]) < 0.0  # phi to starboard down, r to starboard
    for run, heel in zip(runs[len(ship.manoeuvres) :], ship.decays, strict=True):
        assert np.degrees(run["phi"][0]) == pytest.approx(heel)
        assert np.max(np.abs(run["phi"][-20:])) < 0.5 * abs(run["phi"][0])
    noisy = ship.noisy(circle, rng)
    assert np.std(noisy["psi"] - circle["psi"]) == pytest.approx(ship.noise["psi"], rel=0.2)
