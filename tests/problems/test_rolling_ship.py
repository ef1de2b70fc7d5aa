"""Trials of the known ships that turn and roll: how each begins, and to which side it heels."""

from collections.abc import Callable

import numpy as np
import pytest

from seatrial.estimation.estimate import Runs, estimate_model
from seatrial.problems.rolling_ship import (
    SETTINGS,
    RollingShip,
    rolling_container_ship,
    rolling_expansion,
    rolling_tanker,
)


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


def test_the_tanker_is_found_without_a_guess() -> None:
    """A draw whose weak form in windows as wide as its roll has negative damping, from which a simulation diverges."""
    ship, rng = rolling_tanker(), np.random.default_rng([1, 2])
    runs = Runs.one_session_each([ship.noisy(run, rng) for run in ship.runs()], ship.length)
    names = ship.model.parameters.free_names
    begun = ship.model.with_values(dict.fromkeys(names, 0.0) | {"GM": 1.0})
    estimation = estimate_model(begun, runs, SETTINGS)
    truth = np.array([ship.model.parameters[n].value for n in names])
    missed = estimation.estimate.common_parameters[: len(names)] - truth
    assert np.all(np.abs(missed) < 4.0 * np.sqrt(np.diag(estimation.interval.covariance))[: len(names)])
    np.testing.assert_allclose(estimation.model.parameters["GM"].value, ship.model.parameters["GM"].value, rtol=2e-3)
