"""States that were not measured, and the start without a guess."""

import math

import numpy as np
import pytest
from tests.estimation.identify.conftest import TRUTH, square, steered

from seatrial.core.values import InputError, Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.start import weak_form_start
from seatrial.estimation.identify import estimate_model
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models import model_named
from seatrial.physics.models.nomoto import nomoto, nomoto2
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.states import measured_states
from seatrial.physics.simulate.steer import manoeuvre


@pytest.fixture(scope="module")
def record() -> Record:
    return manoeuvre(
        waterjet(), programme("zigzag:20/20"), inputs={"v_j": 1.866}, slew_rate=math.radians(4.0), duration=250.0
    )


def test_velocities_follow_from_positions(record: Record) -> None:
    states = measured_states(waterjet(), record.without("u", "v", "r"))
    for i, (symbol, tolerance) in enumerate((("u", 1e-4), ("v", 1e-4), ("r", 1e-4))):
        np.testing.assert_allclose(states[20:-20, i], record[symbol][20:-20], atol=tolerance)


def test_heading_follows_from_the_rate_and_positions_may_lack(record: Record) -> None:
    states = measured_states(waterjet(), record.without("psi", "x0", "y0"))
    np.testing.assert_allclose(states[:, 3], record["psi"] - record["psi"][0], atol=1e-3)
    np.testing.assert_array_equal(states[:, 4:], 0.0)


def test_what_neither_is_nor_follows_is_named(record: Record) -> None:
    with pytest.raises(InputError, match="neither holds nor implies 'v', which model 'waterjet' needs"):
        measured_states(waterjet(), record.without("v", "x0", "y0"))


def test_coefficients_without_any_velocity_measured(record: Record) -> None:
    """From positions and heading alone, starting at zero."""
    bare = record.without("u", "v", "r")
    start = waterjet().with_values(dict.fromkeys(COEFFICIENTS, 0.0))
    found = estimate_model(start, Runs.one_session_each([bare], 9.8)).model.parameters
    truth = waterjet().parameters
    assert max(abs(found[n].value / truth[n].value - 1) for n in COEFFICIENTS) < 1e-6


def test_the_start_is_near_the_truth(record: Record) -> None:
    point = weak_form_start(waterjet().with_values(dict.fromkeys(COEFFICIENTS, 0.0)), [record], 15.0)
    truth = np.array([waterjet().parameters[n].value for n in waterjet().parameters.free_names])
    np.testing.assert_allclose(point, truth, rtol=0.02)


def test_positions_nobody_measured_say_nothing_about_speed() -> None:
    """U of the steering model moves positions only; the others start as if it were fixed."""
    rng = np.random.default_rng(3)
    model = nomoto().with_values({**TRUTH, "U": 2.0})
    record = steered(model, square(500), rng, {"r": 1e-3}).without("x0", "y0")
    free = model.with_parameters(model.parameters.freed("U")).with_values({"K": 0.1, "T": 10.0})
    started = dict(zip(free.parameters.free_names, weak_form_start(free, [record], 6.0), strict=True))
    assert started["U"] == 2.0
    assert started["K"] == pytest.approx(TRUTH["K"], rel=0.05)
    assert started["T"] == pytest.approx(TRUTH["T"], rel=0.1)


def test_a_hidden_state_leaves_the_start_to_the_model() -> None:
    """The second-order steering model has a state that no record can hold; its truth is found all the same."""
    model = nomoto2().with_values({"K": 0.15, "T_1": 15.0, "T_2": 3.0, "T_3": 5.0, "U": 1.0})
    record = manoeuvre(model, programme("zigzag:20/20"), dt=0.2, speed=1.0).without("r_rest")
    start = nomoto2().with_values({"U": 1.0})
    np.testing.assert_array_equal(weak_form_start(start, [record], 10.0), [p.value for p in start.parameters.free])
    found = estimate_model(start, Runs.one_session_each([record], 7.0))
    assert "r_rest" in found.start_method
    values = [found.model.parameters[n].value for n in ("K", "T_1", "T_2", "T_3")]
    np.testing.assert_allclose(values, [0.15, 15.0, 3.0, 5.0], rtol=1e-6)


def test_a_roll_of_two_periods_is_searched_from_its_period(rng: np.random.Generator) -> None:
    """45 s of a light decay of 19 s: the weak form alone leads to a damping of 1.6 for 0.006 1/s."""
    time = np.arange(0.0, 45.0, 0.1)
    damping, frequency = 0.00314, math.sqrt(0.1075)
    phi = 0.035 + 0.26 * np.exp(-0.5 * damping * time) * np.cos(frequency * time)
    record = Record.from_arrays("decay", time, {"phi": phi + 3e-4 * rng.standard_normal(len(time))})
    model = model_named("roll")
    model = model.with_parameters(model.parameters.only_free(("b_1", "b_2", "c_1", "c_3", "phi_0")))
    fit = estimate_model(model, Runs.one_session_each([record], 30.0))
    assert fit.start_method.startswith("the period of the records")
    assert fit.model.parameters["c_1"].value == pytest.approx(0.1075, rel=0.01)
    assert fit.model.parameters["b_1"].value == pytest.approx(damping, abs=0.003)


def unstable_zigzag(angle: float, rng: np.random.Generator) -> Record:
    """A tanker that turns by itself, 60 r' = 0.03 delta + r - r^3 / (0.3 deg/s)^2, in a zigzag; Euler, 0.02 s."""
    r, psi, delta, order, rows = 0.0, 0.0, 0.0, math.radians(angle), []
    rate, step, limit = math.radians(2.5), 0.02, math.radians(0.3)
    for k in range(75_000):
        if k % 50 == 0:
            rows.append((r, psi, delta))
        if psi * order > 0.0 and abs(psi) > math.radians(angle):
            order = -order
        delta += min(max(order - delta, -rate * step), rate * step)
        r += step * (0.03 * delta + r - r**3 / limit**2) / 60.0
        psi += step * r
    columns = np.array(rows)
    noisy = columns + np.array([math.radians(0.005), math.radians(0.05), 0.0]) * rng.standard_normal(columns.shape)
    return Record.from_arrays(
        f"zigzag {angle:g}",
        np.arange(len(columns), dtype=np.float64),
        dict(zip(("r", "psi", "delta"), noisy.T, strict=True)),
    )


def test_a_ship_that_turns_by_itself_is_found_from_the_default_start(rng: np.random.Generator) -> None:
    """K = -0.03 1/s, T = -60 s: between them and the start values lies an infinite time constant."""
    model = nomoto().with_parameters(nomoto().parameters.only_free(("K", "T", "alpha")))
    found = weak_form_start(model, [unstable_zigzag(angle, rng) for angle in (10.0, 20.0)], 30.0)
    np.testing.assert_allclose(found, [-0.03, -60.0, -1.0 / math.radians(0.3) ** 2], rtol=0.1)
