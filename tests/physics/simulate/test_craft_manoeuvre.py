"""Craft whose thrusters turn: zigzags and circles by that angle against SciPy and closed forms; what cannot be done."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.models import model_named
from seatrial.physics.models.thruster_layout import CATAMARAN, AngleInput, CommandInput, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.replay import replay
from seatrial.physics.simulate.thrust import craft_manoeuvre, craft_programme, is_steered_by_angle, order_at_speed

X, FULL, DRAG, YAW_DRAG = -2.0, 0.8, 0.1, 1.5
"""Place of the outboard [m], its thrust at full command, X_uu and N_r with their sign turned, on each kg of M_u."""
M_V, M_R, SWAY_DRAG, SPEED_DRAG = 1.6, 2.0, 0.7, 0.4  # M_v, M_r, Y_v and N_ur with their sign turned
OUTBOARD = Thruster("outboard", X, 0.0, CommandInput("command_1"), angle=AngleInput("alpha_1"))
FAST = math.radians(25.0)  # rad/s: an outboard is put over in a second


@pytest.fixture(scope="module")
def outboard() -> Model:
    """Thrust k_f c^2 along the outboard; drag of u |u|, of v, of r and of |u| r."""
    model = thrusters(ThrusterLayout((OUTBOARD,), length=4.0))
    values = dict.fromkeys(("X_u", "Y_vv", "N_rr", "Y_uv", "Y_NT", "N_uv", "k_J", "k_4"), 0.0)
    return model.with_values(values | {
        "k_f": FULL, "p_f": 2.0, "X_uu": -DRAG, "Y_v": -SWAY_DRAG, "N_r": -YAW_DRAG, "N_ur": -SPEED_DRAG, "M_v": M_V,
        "M_r": M_R,
    })  # fmt: skip


def steered(model: Model, text: str, speed: float | None = None, **inputs: float) -> Record:
    layout = ThrusterLayout.from_text(model.equations.layout)
    return craft_manoeuvre(model, craft_programme(layout, text), speed=speed, inputs=inputs or None, slew_rate=FAST)


def motion(record: Record) -> np.ndarray:
    """u, v, r, psi, x0, y0 at the last sample, by SciPy from the equations and the recorded direction of thrust."""

    def rates(t: float, s: np.ndarray) -> list[float]:
        u, v, r, psi = s[:4]
        a = np.interp(t, record.time, record["alpha_1"])
        T = FULL * record["command_1"][0] ** 2
        return [
            T * np.cos(a) - DRAG * abs(u) * u + M_V * v * r,
            (T * np.sin(a) - SWAY_DRAG * v - u * r) / M_V,
            (X * T * np.sin(a) - (YAW_DRAG + SPEED_DRAG * abs(u)) * r + (1.0 - M_V) * u * v) / M_R,
            r, u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi),
        ]  # fmt: skip

    start = [record["u"][0], 0.0, 0.0, 0.0, 0.0, 0.0]
    return solve_ivp(rates, (0.0, record.time[-1]), start, rtol=1e-9, atol=1e-9, max_step=0.05).y[:, -1]


@pytest.mark.parametrize(("end", "side"), [("", 1.0), (":port", -1.0)])
def test_a_zigzag_reverses_the_outboard_at_its_heading_and_moves_as_scipy_has_it(
    outboard: Model, end: str, side: float
) -> None:
    record = steered(outboard, f"zigzag:20/15{end}")
    last = [record[s][-1] for s in ("u", "v", "r", "psi", "x0", "y0")]
    np.testing.assert_allclose(last, motion(record), atol=1e-5)  # of 60 m: rounding of steps of 0.05 s
    assert record["u"][0] == pytest.approx(math.sqrt(FULL * 0.5**2 / DRAG))  # thrust and drag of half command
    held = np.abs(record["alpha_1"]) > math.radians(19.9)
    assert np.sign(record["alpha_1"][held][0]) == -side  # thrust to port, at the stern: to starboard
    assert np.ptp(record["command_1"]) == 0.0
    reversed_at = np.flatnonzero(held[:-1] & ~held[1:])
    assert len(reversed_at) == 4 and np.degrees(np.abs(record["psi"][reversed_at])) == pytest.approx(15.0, abs=1.0)
    found = measures(record, 4.0)
    assert found["rudder_deg"] == pytest.approx(20.0) and {"overshoot_1_deg", "overshoot_4_deg", "period_s"} <= {*found}


@pytest.mark.parametrize(("end", "side"), [("", 1.0), (":port", -1.0)])
def test_the_steady_turn_balances_the_moment_of_the_turned_thrust(outboard: Model, end: str, side: float) -> None:
    """No moment of u v with M_v = M_u: r = |x| T sin(35 deg) / N_r."""
    alike = outboard.with_values({"M_v": 1.0, "N_ur": 0.0})
    record = steered(alike, f"turning-circle:35{end}")
    rate = -X * FULL * 0.25 * math.sin(math.radians(35.0)) / YAW_DRAG
    assert record["r"][-1] == pytest.approx(side * rate, rel=1e-4)
    assert abs(record["psi"][-1]) == pytest.approx(math.radians(540.0), abs=0.05)
    assert measures(record, 4.0)["steady_yaw_rate_deg_s"] == pytest.approx(math.degrees(rate), rel=1e-3)


def test_thrust_is_that_of_the_approach_speed(outboard: Model) -> None:
    """k_f c^2 = X_uu u^2: c = u sqrt(X_uu / k_f); beyond full command there is no more."""
    assert order_at_speed(outboard, 2.0) == pytest.approx(2.0 * math.sqrt(DRAG / FULL), rel=1e-9)
    record = steered(outboard, "turning-circle:20", speed=2.0)
    assert record["u"][0] == pytest.approx(2.0) and record["command_1"][-1] == pytest.approx(math.sqrt(0.5))
    with pytest.raises(InputError, match=r"makes 2.83 m/s at full command, not 4 m/s; give a lower --speed"):
        steered(outboard, "turning-circle:20", speed=4.0)
    with pytest.raises(InputError, match="the approach speed or the order ahead, not both"):
        steered(outboard, "turning-circle:20", speed=2.0, ahead=0.5)
    with pytest.raises(InputError, match="approach speed -1 m/s is not positive"):
        steered(outboard, "turning-circle:20", speed=-1.0)


def test_the_thruster_has_settled_at_its_order_and_a_replay_repeats_the_run(outboard: Model) -> None:
    record = steered(outboard, "pull-out:20", ahead=0.4)
    assert np.allclose(record["c_outboard"], 0.4) and record["u"][1] == pytest.approx(record["u"][0])
    np.testing.assert_allclose(replay(outboard, record)["psi"], record["psi"], atol=1e-12)


@pytest.mark.parametrize(("text", "layout", "message"), [
    ("spin:50", ThrusterLayout((OUTBOARD,)), "of their thrust has no moment; it can do zigzag:20/20, .*turning-circle"),
    ("turning-circle:35", CATAMARAN, "thrusters are fixed, with no angle to order; it can do spin:50, zigzag:30/20"),
    ("zigzag:20/20", ThrusterLayout((replace(OUTBOARD, angle=0.0),)), "no thruster turns it; it can do straight:50"),
    ("circle:35", CATAMARAN, "cannot do the manoeuvre 'circle:35'; it can do spin:50"),
    ("zigzag:20", ThrusterLayout((OUTBOARD,)), "cannot read the manoeuvre 'zigzag:20'"),
])  # fmt: skip
def test_what_a_craft_cannot_do_is_refused_with_what_it_can(text: str, layout: ThrusterLayout, message: str) -> None:
    with pytest.raises(InputError, match=message):
        craft_programme(layout, text)


def test_a_rudder_or_a_thruster_that_turns_takes_the_manoeuvres_of_ships(outboard: Model) -> None:
    assert is_steered_by_angle(outboard) and is_steered_by_angle(model_named("waterjet"))
    assert not is_steered_by_angle(thrusters(CATAMARAN)) and not is_steered_by_angle(model_named("roll"))


def test_the_angle_that_is_ordered_cannot_be_set(outboard: Model) -> None:
    with pytest.raises(InputError, match="gives the angle 'alpha_1' itself"):
        steered(outboard, "zigzag:20/20", alpha_1=0.1)
