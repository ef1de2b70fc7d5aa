"""Intervals of manoeuvres that were never sailed."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from seatrial.equations import Model
from seatrial.manoeuvres import measures
from seatrial.manoeuvres.programme import programme
from seatrial.models.nomoto import nomoto
from seatrial.models.waterjet import waterjet
from seatrial.predict.steered import DRAWS, measure_intervals
from seatrial.results import Margin
from seatrial.simulate.steer import manoeuvre
from seatrial.values import InputError, Record

LENGTH = 9.8
NAME = "tactical_diameter_L"


@pytest.fixture(scope="module")
def model() -> Model:
    """The craft with one free coefficient, on which the turn depends nearly linearly."""
    made = waterjet()
    return made.with_parameters(made.parameters.only_free(["N_r"]))


@pytest.fixture(scope="module")
def steer() -> Callable[[Model], Record]:
    orders = programme("turning-circle:20")
    return lambda ship: manoeuvre(ship, orders, dt=0.5, inputs={"v_j": 1.866})


def margin(sd: float) -> Margin:
    return Margin(np.array([[sd**2]]), np.inf)


def test_half_widths_are_those_of_the_coefficient(model: Model, steer: Callable[[Model], Record]) -> None:
    sd, value = 0.0005, model.parameters["N_r"].value
    told = measure_intervals(model, margin(sd), steer, LENGTH, np.random.default_rng(0))[NAME]
    up, down = (measures(steer(model.with_values({"N_r": value + s})), LENGTH)[NAME] for s in (sd, -sd))
    expected = 1.96 * abs(up - down) / 2
    assert (told[1] - told[0]) / 2 == pytest.approx(expected, rel=0.25), "60 draws: 9 % of chance, twice"
    assert sum(told) / 2 == pytest.approx(measures(steer(model), LENGTH)[NAME])


def test_every_measure_has_an_interval(model: Model, steer: Callable[[Model], Record]) -> None:
    told = measure_intervals(model, margin(1e-4), steer, LENGTH, np.random.default_rng(0))
    assert set(told) == set(measures(steer(model), LENGTH))


def test_unknown_kinds_take_the_factor_known_ones_the_discrepancy(
    model: Model, steer: Callable[[Model], Record]
) -> None:
    plain = measure_intervals(model, margin(1e-4), steer, LENGTH, np.random.default_rng(0))[NAME]
    wide = replace(margin(1e-4), factor=3.0)
    factored = measure_intervals(model, wide, steer, LENGTH, np.random.default_rng(0))[NAME]
    assert np.ptp(factored) == pytest.approx(3.0 * np.ptp(plain))
    reached = float(np.max(np.abs(steer(model)["delta"])))
    for index in (0.5, 2.0):
        seen = replace(margin(1e-9), kinds={NAME: 0.1}, covered={"rudder": reached / index})
        told = measure_intervals(model, seen, steer, LENGTH, np.random.default_rng(0))[NAME]
        assert np.ptp(told) / 2 == pytest.approx(1.96 * 0.1 * max(index, 1.0) ** 2, rel=1e-3)


def test_tied_models_widen_the_interval(model: Model, steer: Callable[[Model], Record]) -> None:
    other = {"Y_r": 1.1 * model.parameters["Y_r"].value}
    apart = measures(steer(model.with_values(other)), LENGTH)[NAME] - measures(steer(model), LENGTH)[NAME]
    told = measure_intervals(model, replace(margin(1e-9), tied=(other,)), steer, LENGTH, np.random.default_rng(0))[NAME]
    assert np.ptp(told) / 2 == pytest.approx(1.96 * abs(apart), rel=1e-3)


def test_ships_that_cannot_be_steered_are_no_interval(model: Model, steer: Callable[[Model], Record]) -> None:
    """Damping in yaw whose sign is open: drawn ships that spin faster and faster."""
    sd = 100.0 * abs(model.parameters["N_r"].value)
    with pytest.raises(InputError, match=r"5\d of 60 ships drawn from the fit's covariance cannot be steered"):
        measure_intervals(model, margin(sd), steer, LENGTH, np.random.default_rng(0))


def test_a_free_rudder_zero_scatters_as_it_was_estimated_and_as_runs_differ() -> None:
    """A first-order ship on a turn, whose heading answers the rudder's zero linearly."""
    base = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
    ship = base.with_parameters(base.parameters.only_free(["delta_0"]))
    seen: list[float] = []

    def steer(one: Model) -> Record:
        seen.append(one.parameters["delta_0"].value)
        return manoeuvre(one, programme("turning-circle:20"), dt=0.5, speed=2.0)

    sd, between = 0.008, 0.006
    measure_intervals(ship, replace(margin(sd), offsets={"delta zero": between}), steer, 8.0, np.random.default_rng(0))
    drawn = np.array(seen[1:])
    assert len(drawn) == DRAWS
    assert np.std(drawn) == pytest.approx(np.hypot(sd, between), rel=0.2), "60 draws: 9 % of chance, twice"


def test_few_degrees_of_freedom_widen_by_students_t(model: Model, steer: Callable[[Model], Record]) -> None:
    """Quantiles of Student's t at 97.5 %: 2.776 with four degrees of freedom, 1.960 with any number."""
    wide, narrow = (
        measure_intervals(model, replace(margin(1e-4), degrees_of_freedom=d), steer, LENGTH, np.random.default_rng(0))
        for d in (4.0, np.inf)
    )
    assert np.ptp(wide[NAME]) / np.ptp(narrow[NAME]) == pytest.approx(2.776 / 1.960, rel=1e-3)
