"""Craft with thrusters taken through programmes: speed, stop and spin against closed forms, zigzags to both sides."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.manoeuvres.thrust_programme import thrust_programme
from seatrial.physics.models.thruster_layout import CATAMARAN, AngleInput, CommandInput, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.thrust import (
    refuse_rudder_options,
    settled_yaw_rate,
    straight_at_speed,
    straight_by_thrusters,
    thrust_manoeuvre,
)

SURGE_DRAG, YAW_DRAG, THRUST, ARM = 0.3, 0.8, 1.2, 0.3
"""X_uu and N_rr with their sign turned, thrust of one at half command, all on each kg of M_u; arm [m]; chosen."""


@pytest.fixture(scope="module")
def craft() -> Model:
    """Two thrusters without lag, on quadratic curves, drag quadratic: the motions below have closed forms."""
    layout = ThrusterLayout(tuple(replace(t, lag=0.0) for t in CATAMARAN.thrusters))
    model = thrusters(layout)
    off = [n for n in ("X_u", "Y_v", "Y_vv", "N_r", "N_ur", "Y_uv", "Y_NT", "k_J", "k_4") if n in model.parameters]
    values = dict.fromkeys(off, 0.0) | {"X_uu": -SURGE_DRAG, "N_rr": -YAW_DRAG, "p_f": 2.0, "p_b": 2.0}
    return model.with_values(values | {"k_f": 4.0 * THRUST, "k_b": 4.0 * THRUST})


def measured(craft: Model, text: str, **options: float) -> dict[str, float]:
    return measures(thrust_manoeuvre(craft, thrust_programme(text), inputs=options or None), 1.0)


def test_the_steady_speed_balances_thrust_and_drag(craft: Model) -> None:
    """M u' = 2 T - c u^2: u = U tanh(t c U / M), U = sqrt(2 T / c)."""
    found = measured(craft, "straight:50")
    speed = np.sqrt(2.0 * THRUST / SURGE_DRAG)
    assert found["steady_speed"] == pytest.approx(speed, rel=2e-3)
    share = (1.0 - np.exp(-1.0)) * found["steady_speed"] / speed
    assert found["time_constant_s"] == pytest.approx(np.arctanh(share) / (SURGE_DRAG * speed), rel=1e-3)


def test_the_stop_takes_the_distance_of_its_closed_form(craft: Model) -> None:
    """M u' = -2 T - c u^2 from u_0: distance M / (2 c) ln(1 + c u_0^2 / (2 T)), time M / sqrt(2 T c) atan(...)."""
    found = measured(craft, "stop:50")
    force, speed = 2.0 * THRUST, found["approach_speed"]
    assert speed == pytest.approx(np.sqrt(force / SURGE_DRAG), rel=5e-3)
    distance = np.log1p(SURGE_DRAG * speed**2 / force) / (2.0 * SURGE_DRAG)
    seconds = np.arctan(speed * np.sqrt(SURGE_DRAG / force)) / np.sqrt(force * SURGE_DRAG)
    # commands of a record run straight between samples: half a step at full speed ahead
    assert found["stopping_distance_m"] == pytest.approx(distance + 0.025 * speed, rel=0.01)
    assert found["stopping_time_s"] == pytest.approx(seconds + 0.025, rel=0.01)


@pytest.mark.parametrize(("side", "sign"), [("starboard", 1.0), ("port", -1.0)])
def test_the_steady_spin_balances_moment_and_drag(craft: Model, side: str, sign: float) -> None:
    """2 T l = N_rr r^2, to the side that was ordered, on the spot."""
    record = thrust_manoeuvre(craft, thrust_programme(f"spin:50:{side}"))
    rate = np.sqrt(2.0 * THRUST * ARM / YAW_DRAG)
    assert measures(record, 1.0)["steady_yaw_rate_deg_s"] == pytest.approx(np.degrees(rate), rel=1e-3)
    assert np.sign(record["psi"][-1]) == sign
    assert np.ptp(record["u"]) < 0.05 * rate


def test_a_zigzag_switches_at_its_heading_and_is_the_mirror_to_port(craft: Model) -> None:
    damped = craft.with_values({"N_r": -1.0, "Y_v": -2.0, "Y_vv": -2.0})
    starboard = thrust_manoeuvre(damped, thrust_programme("zigzag:30/20"))
    port = thrust_manoeuvre(damped, thrust_programme("zigzag:30/20:port"))
    np.testing.assert_allclose(port["psi"], -starboard["psi"], atol=1e-9)
    difference = np.sign(starboard["command_1"] - starboard["command_2"])
    switches = np.flatnonzero(np.diff(difference[1:])) + 1
    assert np.degrees(np.abs(starboard["psi"][switches])) == pytest.approx(20.0, abs=2.0)
    found = measures(starboard, 1.0)
    assert {"overshoot_1_deg", "overshoot_2_deg", "period_s", "approach_speed"} <= set(found)
    assert measured(damped, "zigzag:30/20", ahead=0.25)["approach_speed"] < found["approach_speed"]


def test_commands_keep_their_reading_at_rest_and_within_full() -> None:
    in_microseconds = tuple(
        replace(t, lag=0.0, command=CommandInput(t.command.channel, 1500.0, 400.0)) for t in CATAMARAN.thrusters
    )
    record = thrust_manoeuvre(
        thrusters(ThrusterLayout(in_microseconds)), thrust_programme("zigzag:80/20"), duration=5.0
    )
    assert record["command_1"][:1] == pytest.approx(1500.0 + 400.0 * 0.5)
    assert record["command_1"].max() == 1900.0


def test_a_tunnel_thruster_only_turns_and_an_azimuth_points_ahead() -> None:
    bow = Thruster("bow", 1.0, 0.0, CommandInput("command_1"), angle=np.pi / 2.0, lag=0.0)
    stern = Thruster("stern", -1.0, 0.0, CommandInput("command_2"), angle=AngleInput("alpha_2"), lag=0.0)
    model = thrusters(ThrusterLayout((bow, stern)))
    record = thrust_manoeuvre(model, thrust_programme("spin:50"), duration=10.0)
    assert set(record["command_1"]) == {0.5} and not np.any(record["command_2"])
    ahead = thrust_manoeuvre(model, thrust_programme("straight:50"), duration=10.0)
    assert not np.any(ahead["command_1"]) and set(ahead["command_2"]) == {0.5}


def test_options_of_ships_are_refused(craft: Model) -> None:
    with pytest.raises(InputError, match="leave --speed out"):
        refuse_rudder_options(thrust_programme("stop:50"), 1.0, None)
    with pytest.raises(InputError, match="leave --rudder-rate out"):
        refuse_rudder_options(thrust_programme("zigzag:30/20"), 1.0, 0.1)
    with pytest.raises(InputError, match="ahead 2 is no share"):
        thrust_manoeuvre(craft, thrust_programme("zigzag:30/20"), inputs={"ahead": 2.0})
    with pytest.raises(InputError, match="'n' cannot be set in the manoeuvre 'spin:50'; nothing can"):
        thrust_manoeuvre(craft, thrust_programme("spin:50"), inputs={"n": 2.0})
    with pytest.raises(InputError, match="did you mean 'ahead'"):
        thrust_manoeuvre(craft, thrust_programme("zigzag:30/20"), inputs={"ahed": 0.5})
    with pytest.raises(InputError, match="gives the command 'command_1' itself"):
        thrust_manoeuvre(craft, thrust_programme("zigzag:30/20"), inputs={"command_1": 0.5})


def test_a_craft_without_thrust_is_refused(craft: Model) -> None:
    with pytest.raises(InputError, match="'stop:50' ends where it begins"):
        thrust_manoeuvre(craft.with_values({"k_f": 0.0, "k_b": 0.0}), thrust_programme("stop:50"))


def test_a_straight_run_balances_surge_and_a_nudge_shows_whether_it_is_held(craft: Model) -> None:
    """The speed of the closed form above; v' = -u r / M_v, r' = (M_u - M_v) u v / M_r: unstable without damping."""
    run = straight_by_thrusters(craft, 0.5)
    assert run.speed == pytest.approx(np.sqrt(2.0 * THRUST / SURGE_DRAG), rel=1e-9)
    assert settled_yaw_rate(craft, run) > 0.1
    held = craft.with_values({"N_r": -3.0, "Y_v": -3.0})
    assert settled_yaw_rate(held, straight_by_thrusters(held)) == pytest.approx(0.0, abs=1e-9)


def test_the_order_of_a_speed_is_found_within_full_command(craft: Model) -> None:
    """Quadratic thrust against quadratic drag: the speed is in proportion to the order."""
    half = straight_by_thrusters(craft, 0.5)
    command = craft.input_names.index("command_1")
    same = straight_at_speed(craft, half.speed)
    np.testing.assert_allclose(same.inputs, half.inputs, atol=1e-5)
    assert straight_at_speed(craft, 10.0 * half.speed).speed == pytest.approx(2.0 * half.speed, rel=1e-9)
    assert straight_at_speed(craft, 0.1 * half.speed).inputs[command] == pytest.approx(
        0.1 * half.inputs[command], abs=1e-5
    )
