"""Intervals of manoeuvres that were never sailed."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis
from seatrial.core.values import InputError, Record
from seatrial.estimation.predict.draws import measure_intervals, models_at_scale
from seatrial.physics.manoeuvres import measures
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import kvlcc2, kvlcc2_l7
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.steer import manoeuvre

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


def margin(sd: float) -> IntervalBasis:
    return IntervalBasis(np.array([[sd**2]]), np.inf)


def test_half_widths_are_those_of_the_coefficient(model: Model, steer: Callable[[Model], Record]) -> None:
    sd, value = 0.0005, model.parameters["N_r"].value
    interval = measure_intervals(model, margin(sd), steer, LENGTH)[NAME]
    up, down = (measures(steer(model.with_values({"N_r": value + s})), LENGTH)[NAME] for s in (sd, -sd))
    expected = 1.96 * abs(up - down) / 2
    assert (interval[1] - interval[0]) / 2 == pytest.approx(expected, rel=1e-4)
    assert sum(interval) / 2 == pytest.approx(measures(steer(model), LENGTH)[NAME], rel=1e-3)


def test_every_measure_has_an_interval(model: Model, steer: Callable[[Model], Record]) -> None:
    interval = measure_intervals(model, margin(1e-4), steer, LENGTH)
    assert set(interval) == set(measures(steer(model), LENGTH))


def test_unknown_kinds_take_the_factor_known_ones_the_discrepancy(
    model: Model, steer: Callable[[Model], Record]
) -> None:
    plain = measure_intervals(model, margin(1e-4), steer, LENGTH)[NAME]
    wide = replace(margin(1e-4), factor=3.0)
    factored = measure_intervals(model, wide, steer, LENGTH)[NAME]
    assert np.ptp(np.log(factored)) == pytest.approx(3.0 * np.ptp(np.log(plain)))
    reached, value = float(np.max(np.abs(steer(model)["delta"]))), measures(steer(model), LENGTH)[NAME]
    for index in (0.5, 2.0):
        seen = replace(margin(1e-9), measure_deviation={NAME: 0.1}, training_envelope={"rudder": reached / index})
        interval = measure_intervals(model, seen, steer, LENGTH)[NAME]
        half = value * np.ptp(np.log(interval)) / 2  # of a positive measure's logarithm
        assert half == pytest.approx(1.96 * 0.1 * max(index, 1.0) ** 2, rel=1e-3)


def test_tied_models_widen_the_interval(model: Model, steer: Callable[[Model], Record]) -> None:
    other = {"Y_r": 1.1 * model.parameters["Y_r"].value}
    apart = measures(steer(model.with_values(other)), LENGTH)[NAME] - measures(steer(model), LENGTH)[NAME]
    interval = measure_intervals(model, replace(margin(1e-9), tied=(other,)), steer, LENGTH)[NAME]
    value = measures(steer(model), LENGTH)[NAME]
    assert value * np.ptp(np.log(interval)) / 2 == pytest.approx(1.96 * abs(apart), rel=1e-3)


def test_ships_that_cannot_be_steered_are_no_interval(model: Model) -> None:
    """A helmsman whose every other ship is lost."""
    orders, calls = programme("turning-circle:20"), []

    def steer(ship: Model) -> Record:
        calls.append(ship)
        if len(calls) > 1:
            raise InputError("the simulation diverges")
        return manoeuvre(ship, orders, dt=0.5, inputs={"v_j": 1.866})

    with pytest.raises(InputError, match="2 of 2 ships one standard deviation from the fit cannot be steered"):
        measure_intervals(model, margin(1e-4), steer, LENGTH)


def test_one_lost_side_leaves_the_other(model: Model, steer: Callable[[Model], Record]) -> None:
    value = model.parameters["N_r"].value

    def limping(ship: Model) -> Record:
        if ship.parameters["N_r"].value > value:
            raise InputError("the simulation diverges")
        return steer(ship)

    both, one = (measure_intervals(model, margin(1e-4), by, LENGTH)[NAME] for by in (steer, limping))
    assert np.ptp(one) == pytest.approx(np.ptp(both), rel=0.05)


def test_directions_add_up_in_squares(steer: Callable[[Model], Record]) -> None:
    """Two coefficients, first each alone, then together, then fully correlated."""
    base = waterjet()
    names, sd = ("N_r", "N_v"), np.array([2e-4, 2e-4])
    alone = [
        np.ptp(measure_intervals(base.with_parameters(base.parameters.only_free([n])), margin(s), steer, LENGTH)[NAME])
        for n, s in zip(names, sd, strict=True)
    ]
    pair = base.with_parameters(base.parameters.only_free(names))
    free = pair.parameters.free_names
    order = [free.index(n) for n in names]
    together = np.ptp(measure_intervals(pair, IntervalBasis(np.diag(sd[order] ** 2), np.inf), steer, LENGTH)[NAME])
    assert together == pytest.approx(np.hypot(*alone), rel=0.02)


def test_the_rudders_zero_counts_beside_the_coefficients() -> None:
    """A first-order ship on a turn, whose heading answers the rudder's zero nearly linearly."""
    base = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
    ship = base.with_parameters(base.parameters.only_free(["delta_0"]))

    def steer(one: Model) -> Record:
        return manoeuvre(one, programme("turning-circle:20"), dt=0.5, speed=2.0)

    def width(sd: float, between: float) -> float:
        interval = measure_intervals(ship, replace(margin(sd), offsets={"delta zero": between}), steer, 8.0)
        return float(np.ptp(interval["steady_yaw_rate_deg_s"]))

    assert width(0.008, 0.006) == pytest.approx(np.hypot(width(0.008, 0.0), width(1e-12, 0.006)), rel=0.01)
    assert width(1e-12, 0.006) == pytest.approx(2 * 1.96 * np.degrees(0.15 * 0.006), rel=0.02)


def test_few_degrees_of_freedom_widen_by_students_t(model: Model, steer: Callable[[Model], Record]) -> None:
    """Quantiles of Student's t at 97.5 %: 2.776 with four degrees of freedom, 1.960 with any number."""
    wide, narrow = (
        measure_intervals(model, replace(margin(1e-4), degrees_of_freedom=d), steer, LENGTH) for d in (4.0, np.inf)
    )
    assert np.ptp(wide[NAME]) / np.ptp(narrow[NAME]) == pytest.approx(2.776 / 1.960, rel=1e-3)


def test_a_model_test_adds_wake_and_propeller_loading_of_its_scale() -> None:
    """KVLCC2 1:45.7 at 1.18 m/s: CF 0.00318 of the model, 0.00139 of the ship (ITTC 1957); 27194 m^2 wet."""
    ship, tanker = kvlcc2_l7().ship, kvlcc2()
    run = Record.from_arrays("run", np.arange(2.0), {"u": np.full(2, 1.18)})
    (full, _), (loaded, _) = models_at_scale(tanker, run, ship.length, 45.7)
    assert full.parameters["w_P0"].value == pytest.approx(0.45)
    added = loaded.parameters["R_0"].value - tanker.parameters["R_0"].value
    assert added == pytest.approx(0.00179 * 27194.0 / (320.0 * 20.8), rel=0.06)
    assert models_at_scale(tanker, run, ship.length, 1.0) == []
    assert models_at_scale(nomoto(), run, ship.length, 45.7) == []


def test_intervals_at_full_scale_are_wider_than_those_of_the_model_test() -> None:
    tanker, orders = kvlcc2(), programme("turning-circle:35")
    alone = tanker.with_parameters(tanker.parameters.only_free(["N_r"]))

    def turned(ship: Model) -> Record:
        return manoeuvre(ship, orders, dt=0.5, inputs={"n": 10.4})

    length = kvlcc2_l7().ship.length
    tested, scaled = (measure_intervals(alone, margin(1e-5), turned, length, scale)[NAME] for scale in (1.0, 45.7))
    assert tested is not None
    assert scaled is not None
    assert np.ptp(scaled) > 2.0 * np.ptp(tested)
