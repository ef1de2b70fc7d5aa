"""What instruments show, against closed forms; exact Jacobians; the model file keeps them."""

import math

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record
from seatrial.data.folder.model_file import ModelFile, model_text, parse_model
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.physics.manoeuvres import measures
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models import model_named
from seatrial.physics.sensors import Compass, Sensors, VelocityReference, with_sensors
from seatrial.physics.sensors.measured_outputs import is_late, late_name, with_timed_receiver, without_sensors
from seatrial.physics.sensors.settings import LAG_START, Antenna, Late
from seatrial.physics.simulate import manoeuvre
from seatrial.physics.simulate.replay import replay
from seatrial.testing import check_model

ALL = Sensors(
    compass=Compass.HARMONIC, velocity=VelocityReference.GROUND, velocity_lag=0.4, yaw_rate_bias=True,
    antenna=Antenna(0.8, -0.3),
)  # fmt: skip
DEVIATION = {"compass_A": 0.05, "compass_B": 0.1, "compass_C": -0.08, "r_bias": 0.01}
CURRENT = {"current_north": 0.2, "current_east": -0.1}


@pytest.fixture(scope="module")
def model() -> Model:
    return with_sensors(model_named("waterjet"), ALL).with_values(DEVIATION | CURRENT)


@pytest.fixture(scope="module")
def shown(model: Model) -> Record:
    """A turn, as the instruments show it."""
    time = 0.1 * np.arange(400)
    planned = Record.from_arrays("turn", time, {"delta": np.where(time > 5.0, 0.3, 0.0), "v_j": np.full(400, 10.0)})
    start = dict.fromkeys(model.states, 0.0) | {"u": 4.0, "u_late_1": 4.2, "u_late": 4.2}
    return replay(model, planned, start)


def test_the_compass_shows_the_heading_less_its_deviation(shown: Record) -> None:
    psi = shown["psi"]
    e = 0.05 + 0.1 * np.sin(psi) - 0.08 * np.cos(psi)
    np.testing.assert_allclose(shown["psi_true"] - psi, e, atol=3e-4)  # two steps leave the third power of e


def test_positions_are_those_of_the_antenna(shown: Record) -> None:
    psi = shown["psi_true"]
    np.testing.assert_allclose(shown["x0"] - shown["x0_true"], 0.8 * np.cos(psi) + 0.3 * np.sin(psi), atol=1e-12)
    np.testing.assert_allclose(shown["y0"] - shown["y0_true"], 0.8 * np.sin(psi) - 0.3 * np.cos(psi), atol=1e-12)


def test_a_circle_is_measured_at_the_craft_not_at_its_antenna() -> None:
    craft = model_named("waterjet")
    instruments = Sensors(velocity=VelocityReference.GROUND, antenna=Antenna(2.0, 0.0))
    at_antenna = with_sensors(craft, instruments).with_values({"x_antenna": 2.0, "y_antenna": 0.0})
    orders = programme("turning-circle:20")
    bare, with_instruments = (
        manoeuvre(one, orders, duration=60.0, inputs={"v_j": 10.0}) for one in (craft, at_antenna)
    )
    assert np.max(np.abs(with_instruments["x0"] - bare["x0"])) > 1.9  # m: the record shows the antenna
    assert measures(with_instruments, 5.0) == pytest.approx(measures(bare, 5.0), rel=1e-12)


def test_velocities_are_those_of_the_antenna_over_ground_turned_by_the_compass_and_late(shown: Record) -> None:
    speed_of_antenna = np.hypot(np.gradient(shown["x0"], 0.1), np.gradient(shown["y0"], 0.1))
    course = np.arctan2(np.gradient(shown["y0"], 0.1), np.gradient(shown["x0"], 0.1))
    settled = slice(30, -5)
    late = np.interp(shown.time - 0.4, shown.time, speed_of_antenna)
    np.testing.assert_allclose(np.hypot(shown["u"], shown["v"])[settled], late[settled], rtol=0.03)
    drift = np.arctan2(shown["v"], shown["u"])[settled]
    expected = np.interp(shown.time - 0.4, shown.time, np.unwrap(course) - shown["psi"])[settled]
    np.testing.assert_allclose(drift, expected, atol=0.03)


def test_late_states_start_where_their_channel_does(model: Model) -> None:
    assert [s for s in model.states if is_late(s)] == ["u_late_1", "u_late", "v_late_1", "v_late"]
    assert late_name("u") == "u_late"


def test_a_bias_is_added_to_the_yaw_rate(shown: Record) -> None:
    np.testing.assert_allclose(shown["r"] - shown["r_true"], 0.01, atol=1e-15)


LATE = Sensors(
    velocity=VelocityReference.GROUND, late=LAG_START, yaw_rate_bias=True, yaw_rate_scale=True,
    antenna=Antenna(0.8, -0.3),
)  # fmt: skip
LAGS = {"lag_receiver": 0.4, "lag_heading": 0.3, "lag_yaw_rate": 0.2}
"""s."""


def test_late_channels_show_what_was_a_lag_before() -> None:
    """A receiver's against the true channels, interpolated; those behind a filter by its equation."""
    craft = with_sensors(model_named("waterjet"), LATE)
    truth = craft.with_values({**LAGS, "r_scale": 0.02, "r_bias": 0.01, "x_antenna": 0.8, "y_antenna": -0.3})
    time = np.arange(0.0, 40.0, 0.1)
    order = 0.3 * np.sin(0.3 * time)
    planned = Record.from_arrays("weave", time, {"delta": order, "v_j": np.full(400, 10.0)})
    shown = replay(truth, planned, dict.fromkeys(craft.states, 0.0) | {"u": 4.0})
    settled = slice(50, -5)

    def before(channel: str, lag: float) -> np.ndarray:
        return np.interp(time - lag, time, shown[f"{channel}_true"])

    for channel, values, lag in (
        ("psi", shown["psi"], LAGS["lag_heading"]), ("r", (shown["r"] - 0.01) / 1.02, LAGS["lag_yaw_rate"]),
    ):  # fmt: skip
        prompt = values + lag * np.gradient(values, 0.1)
        assert np.max(np.abs(prompt - shown[f"{channel}_true"])[settled]) < 0.01 * np.ptp(prompt)
    psi = before("psi", LAGS["lag_receiver"])
    x = before("x0", LAGS["lag_receiver"]) + 0.8 * np.cos(psi) + 0.3 * np.sin(psi)
    y = before("y0", LAGS["lag_receiver"]) + 0.8 * np.sin(psi) - 0.3 * np.cos(psi)
    speed = np.hypot(np.gradient(x, 0.1), np.gradient(y, 0.1))
    course = np.unwrap(np.arctan2(np.gradient(y, 0.1), np.gradient(x, 0.1)))
    assert np.max(np.abs(np.hypot(shown["u"], shown["v"]) - speed)[settled]) < 0.02 * np.max(speed)
    drift = np.arctan2(shown["v"], shown["u"])  # of the receiver's course from the heading of now
    assert np.max(np.abs(drift - (course - shown["psi_true"]))[settled]) < 0.02 * np.ptp(drift)
    way = 4.0 * LAGS["lag_receiver"]  # m, which the lag amounts to
    assert np.max(np.hypot(shown["x0"] - x, shown["y0"] - y)[settled]) < 0.02 * way


@pytest.mark.parametrize("rows", [5, -3])
def test_readings_of_a_late_receiver_move_to_the_time_that_they_are_of(rows: int) -> None:
    """A turn whose fixes and velocities over ground are `rows` late, resolved along the heading of now."""
    time = 0.1 * np.arange(300)
    psi, speed, drift = 0.002 * time**2, 3.0 + 0.02 * time, 0.1 * np.sin(time)
    then = np.clip(np.arange(300) - rows, 0, 299)
    course = (psi + drift)[then] - psi
    prompt = {"x0": np.cos(time), "y0": time**2, "u": speed * np.cos(drift), "v": speed * np.sin(drift), "psi": psi}
    late = {c: prompt[c][then] for c in ("x0", "y0")} | {"psi": psi}
    late |= {"u": speed[then] * np.cos(course), "v": speed[then] * np.sin(course)}
    stated = Sensors(velocity=VelocityReference.GROUND, late={Late.RECEIVER: 0.1 * rows})
    moved = with_timed_receiver(Record.from_arrays("turn", time, late), stated, 0.1 * rows)
    there = slice(0, -rows) if rows > 0 else slice(-rows, None)
    for channel, values in prompt.items():
        np.testing.assert_allclose(moved[channel][there], values[there], atol=1e-12)
        assert np.count_nonzero(np.isnan(moved.measured(channel))) == (0 if channel == "psi" else abs(rows))


def test_what_is_left_of_the_lag_of_a_moved_receiver_is_a_term_of_first_order() -> None:
    moved, prompt = Sensors(late={Late.RECEIVER: 0.4}), Sensors(late={Late.RECEIVER: 0.0})
    craft, time = model_named("waterjet"), 0.1 * np.arange(100)
    planned = Record.from_arrays("weave", time, {"delta": 0.3 * np.sin(0.3 * time), "v_j": np.full(100, 10.0)})
    shown = [
        replay(m, planned, dict.fromkeys(m.states, 0.0) | {"u": 4.0})
        for m in (with_sensors(craft, moved).with_values({"lag_receiver": 0.45}),
                  with_sensors(craft, prompt).with_values({"lag_receiver": 0.05}))
    ]  # fmt: skip
    for channel in ("x0", "y0"):
        np.testing.assert_allclose(shown[0][channel], shown[1][channel], atol=1e-12)


def test_settings_of_sensors_are_stated_as_lines_of_a_trial() -> None:
    stated = Sensors(late={Late.RECEIVER: 0.4, Late.HEADING: 0.5}, yaw_rate_bias=True, antenna=Antenna(sd=0.6))
    assert stated.line("late") == "late = {receiver = 0.4, heading = 0.5}"
    assert stated.line("yaw_rate_bias") == "yaw_rate_bias = true"
    assert stated.line("antenna") == "antenna = {x = 0.0, y = 0.0, sd = 0.6}"


def test_late_channels_have_exact_derivatives() -> None:
    craft = with_sensors(model_named("waterjet"), LATE)
    check_model(craft.with_values({**LAGS, "r_scale": 0.02, "r_bias": 0.01}), points=5)


def test_a_model_without_its_sensors_is_the_one_before(model: Model) -> None:
    craft = model_named("waterjet")
    for sensed in (model, with_sensors(craft, LATE)):
        bare = without_sensors(sensed)
        assert bare.equation_hash == craft.equation_hash
        assert bare.parameters.names == craft.parameters.names


def test_a_record_is_compared_with_what_the_instruments_show(model: Model, shown: Record) -> None:
    assert compared_outputs(model, [shown])[:6] == ("u", "v", "r", "psi", "x0", "y0")
    assert [model.observable_of(c) for c in ("psi", "delta")] == ["psi_measured", "delta"]


def test_sensors_have_exact_derivatives_and_keep_in_the_model_file(model: Model) -> None:
    check_model(model, points=5)
    restored = parse_model(model_text(ModelFile(model)), "model.toml").model
    assert restored.equation_hash == model.equation_hash
    assert Sensors.from_text(restored.equations.sensors) == ALL


def test_perfect_instruments_leave_the_model_as_it_is() -> None:
    assert with_sensors(model_named("nomoto"), Sensors()) is model_named("nomoto")


def test_an_instrument_of_what_the_model_lacks_is_refused() -> None:
    with pytest.raises(InputError, match="no state 'u'"):
        with_sensors(model_named("nomoto"), Sensors(velocity=VelocityReference.GROUND))
    with pytest.raises(InputError, match="has sensors already"):
        with_sensors(with_sensors(model_named("nomoto"), Sensors(yaw_rate_bias=True)), Sensors(yaw_rate_bias=True))


def test_an_offset_turns_the_compass_only() -> None:
    model = with_sensors(model_named("nomoto"), Sensors(compass=Compass.OFFSET))
    assert math.isclose(model.parameters["compass_A"].value, 0.0)
    assert model.parameters["compass_A"].free
    assert model.outputs == ("psi_measured",)


def test_a_model_read_from_the_cache_knows_whether_it_is_affine_and_keeps_its_layout() -> None:
    """Asking the equations themselves would import SymPy in every process."""
    craft = model_named("thrusters")
    for _ in range(2):
        shown = with_sensors(craft, Sensors(compass=Compass.HARMONIC)).equations
        assert vars(shown)["is_affine"] is False
        assert shown.layout == craft.equations.layout
