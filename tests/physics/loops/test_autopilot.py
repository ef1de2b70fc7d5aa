"""Gains from the plant: the textbook's poles for a Nomoto ship, half the motion at resonance for a fin."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import InputError
from seatrial.physics.loops import Block, TransferLoop, in_series, margins
from seatrial.physics.loops.autopilot import (
    DAMPING_RATIO,
    acceleration_feed_forward,
    heading_gains_at,
    heading_loop,
    lag_frequency,
    pitch_loop,
    speed_loop,
    working_frequency,
)
from seatrial.physics.loops.performance import sensitivity_magnitude

GEAR = (Block("steering gear", (1.0,), (0.5, 1.0)),)
UNSTABLE = Block("tanker", (0.0285, 0.00497), (1.0, 0.384, -0.0045, 0.0))
PITCH = Block("pitch", (0.06,), (1.0, 0.25, 1.4))


def nomoto(K: float, T: float) -> Block:
    return Block("ship", (K,), (T, 1.0, 0.0))


def bounds_of(loop: TransferLoop) -> list[float]:
    return [x for gain in loop.gains for x in (gain.lower, gain.value, gain.upper)] + [*loop.terms[-1].block.den]


@pytest.mark.parametrize("pole", [1e-3, 0.05, 0.31, 4.44])
@pytest.mark.parametrize("mismatch", [1.0, 1.001])
def test_equal_responses_have_equal_gains(pole: float, mismatch: float) -> None:
    """A pole beside its zero moves the response by 0.1 % at most, and bounds, start values and filter by 1 %."""
    pair = Block("pair", (1.0, pole), (1.0, pole * mismatch))
    for make, plant, rel in (
        (heading_loop, nomoto(0.16, 4.0), 0.01),
        (heading_loop, UNSTABLE, 0.01),
        (speed_loop, Block("speed", (0.11,), (50.0, 1.0)), 0.01),
        (pitch_loop, PITCH, 0.01),
    ):
        longer = in_series("plant", (plant, pair))
        plain, same = (bounds_of(make(one, one, ())) for one in (plant, longer))
        assert same == pytest.approx(plain, rel=1e-6 if mismatch == 1.0 else rel, abs=1e-9)


def test_the_working_frequency_is_where_the_heading_moves_as_far_as_the_rudder() -> None:
    """K = omega sqrt(1 + (T omega)^2) of a Nomoto ship; sqrt(b) of b / s^2; 1 / T of a speed."""
    K, T = 0.2, 8.0
    omega = working_frequency(nomoto(K, T))
    assert omega * np.hypot(1.0, T * omega) == pytest.approx(K, rel=1e-7)
    assert working_frequency(nomoto(1e-3, 0.1)) == pytest.approx(1e-3, rel=1e-4)
    assert working_frequency(nomoto(1e9, 1e9 / 0.04)) == pytest.approx(0.2, rel=1e-4)
    assert working_frequency(Block("speed", (0.5,), (20.0, 1.0))) == pytest.approx(1.0 / 20.0, rel=1e-7)
    assert lag_frequency(nomoto(K, T)) == pytest.approx(1.0 / T, rel=1e-7)
    with pytest.raises(InputError, match="no pole off the origin that its response shows"):
        lag_frequency(Block("double", (1.0, 1.0), (1.0, 1.0, 0.0, 0.0)))


def test_a_slow_pole_that_the_loop_does_not_see_changes_nothing() -> None:
    """A ship of T = 400 s and one unstable on its course that answers alike: K / T decides, as it does at sea."""
    settled, unstable = (heading_loop(one, one, ()) for one in (nomoto(16.0, 400.0), nomoto(-16.0, -400.0)))
    assert bounds_of(unstable) == pytest.approx(bounds_of(settled), rel=0.02)


@given(K=st.floats(0.01, 0.5), T=st.floats(1.0, 100.0), sign=st.sampled_from([1.0, -1.0]))
def test_pd_places_the_poles_of_a_nomoto_ship(K: float, T: float, sign: float) -> None:
    plant = nomoto(sign * K, T)
    loop = heading_loop(plant, plant, (), parts=("KP", "KD"))
    KP, KD = loop.gain_values
    omega = 1.5 * working_frequency(plant)
    assert pytest.approx(omega**2 * T / K) == KP
    assert pytest.approx(max((2.0 * DAMPING_RATIO * omega * T - 1.0) / K, 0.0)) == KD
    assert bool(loop.filters) is (sign < 0.0)
    assert margins(loop).is_stable


def test_the_integral_is_a_tenth_of_the_frequency_and_may_leak() -> None:
    plant = nomoto(0.2, 10.0)
    loop = heading_loop(plant, plant, GEAR)
    KP, KI, _ = loop.gain_values
    assert pytest.approx(0.1 * 1.5 * working_frequency(plant) * KP) == KI
    assert loop.terms[1].block.den == (1.0, 0.0)
    leaking = heading_loop(plant, plant, GEAR, integral_lag=200.0)
    assert leaking.terms[1].block.gain == 200.0
    omega = np.geomspace(0.1, 10.0, 20)
    assert leaking.open_loop(omega) == pytest.approx(loop.open_loop(omega), rel=0.01)


def test_what_is_fed_forward_is_the_inverse_of_the_lag() -> None:
    """(T r' + r) / K of a Nomoto ship; (T u' + u) / K of a speed."""
    turn = acceleration_feed_forward(Block("psi", (0.08,), (10.0, 1.0, 0.0)), 0.1)
    assert (turn.level, turn.velocity, turn.acceleration) == pytest.approx((0.0, 12.5, 125.0))
    speed = acceleration_feed_forward(Block("u", (0.5,), (20.0, 1.0)), 0.1)
    assert (speed.level, speed.velocity, speed.acceleration) == pytest.approx((2.0, 40.0, 0.0))


def test_placed_gains_are_the_textbook_s_of_a_nomoto_ship() -> None:
    """Fossen 2021, section 15.3, for K = 0.08 1/s, T = 10 s, omega = 0.2 rad/s and a damping ratio of one."""
    placed = heading_gains_at(Block("psi", (0.08,), (10.0, 1.0, 0.0)), 0.2, 1.0)
    assert placed == pytest.approx({"KP": 0.04 * 125.0, "KI": 0.02 * 5.0, "KD": (2.0 * 0.2 * 10.0 - 1.0) / 0.08})


def test_an_unstable_ship_is_held_within_its_bounds() -> None:
    for parts in (("KP", "KD"), ("KP", "KI", "KD")):
        loop = heading_loop(UNSTABLE, UNSTABLE, GEAR, parts=parts)
        made = margins(loop)
        assert made.is_stable
        assert made.Ms < 1.3
        assert all(0.0 <= p.lower < p.value < p.upper < np.inf for p in loop.gains)


def test_pi_places_the_poles_of_a_speed() -> None:
    K, T = 0.11, 50.0
    plant = Block("speed", (K,), (T, 1.0))
    loop = speed_loop(plant, plant, ())
    omega = 1.5 / T
    assert loop.closed_loop_poles == pytest.approx(np.roots([1.0, 2.0 * DAMPING_RATIO * omega, omega**2]))
    assert (loop.output, loop.actuator) == ("u", "n")


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_fin_on_pitch_halves_the_motion_at_resonance(sign: float) -> None:
    plant = PITCH.scaled(sign)
    loop = pitch_loop(plant, PITCH, (), parts=("KD",), derivative_filter=1e-4)
    at = np.geomspace(0.5, 3.0, 2000)
    top = at[np.argmax(np.abs(plant.frequency_response(at)))]
    assert sensitivity_magnitude(loop, np.array([top]))[0] == pytest.approx(0.5, rel=0.02)
    assert margins(loop).is_stable


def test_what_cannot_be_is_refused() -> None:
    lag = Block("lag", (1.0,), (5.0, 1.0))
    with pytest.raises(InputError, match="is no heading"):
        heading_loop(lag, lag, GEAR)
    with pytest.raises(InputError, match="KP, KI, KD, not KQ"):
        heading_loop(UNSTABLE, UNSTABLE, GEAR, parts=("KQ",))
    with pytest.raises(InputError, match="must be positive"):
        heading_loop(UNSTABLE, UNSTABLE, GEAR, derivative_filter=0.0)
    with pytest.raises(InputError, match="no restoring"):
        pitch_loop(nomoto(0.1, 5.0), lag, GEAR)
    with pytest.raises(InputError, match="no pole off the origin"):
        speed_loop(Block("integrator", (1.0,), (1.0, 0.0)), lag, GEAR)
