"""Margins: loops of second order known in closed form, what margins promise, python-control."""

import math

import control
import numpy as np
import pytest
from tests.physics.loops.example_loops import second_order

from seatrial.physics.loops import TransferLoop, delay_margin, margins
from seatrial.physics.loops.discrete import open_loop_transfer_function
from seatrial.physics.loops.performance import frequency_band, sensitivity_magnitude
from seatrial.physics.loops.structures import Preamplifier, fin_loop

OMEGA = np.geomspace(1e-4, 1e4, 40_001)
PUBLISHED = [fin_loop(reading) for reading in Preamplifier]


@pytest.mark.parametrize("damping", [0.05, 0.1, 0.3, 0.7, 1.2])
def test_a_loop_of_second_order_has_the_margins_of_the_textbook(damping: float) -> None:
    found, square = margins(second_order(damping)), damping**2
    # |S|^2 = x (x + 4 zeta^2) / ((1 - x)^2 + 4 zeta^2 x), x = omega^2, is largest at x = (1 + sqrt(1 + 8 zeta^2)) / 2
    x = 0.5 * (1.0 + math.sqrt(1.0 + 8.0 * square))
    peak = math.sqrt(x * (x + 4.0 * square) / ((1.0 - x) ** 2 + 4.0 * square * x))
    crossing = math.sqrt(math.sqrt(1.0 + 4.0 * square**2) - 2.0 * square)
    phase = math.atan2(2.0 * damping, crossing)
    assert found.is_stable
    assert found.Ms == pytest.approx(peak, rel=1e-9)
    assert found.Ms_frequency == pytest.approx(math.sqrt(x), rel=1e-4)
    assert found.phase == pytest.approx(phase, rel=1e-9)
    assert found.delay == pytest.approx(phase / crossing, rel=1e-9)
    assert found.gain == math.inf
    assert found.damping == pytest.approx(min(damping, 1.0), rel=1e-9)


def test_without_gain_nothing_can_be_lost() -> None:
    found = margins(fin_loop().with_gains(np.zeros(3)))
    assert (found.Ms, found.gain, found.phase, found.delay) == (1.0, math.inf, math.inf, math.inf)


def test_an_unstable_loop_has_none() -> None:
    found = margins(fin_loop().with_gains(np.array([100.0, 50.0, 0.0]) * 100.0))
    assert not found.is_stable
    assert found.Ms == math.inf
    assert found.damping < 0.0
    assert math.isnan(found.gain) and math.isnan(found.phase) and math.isnan(found.delay)


def stable_loops() -> list[TransferLoop]:
    rng, made = np.random.default_rng(20261), []
    for loop in PUBLISHED:
        some = [loop.with_gains(k) for k in rng.random((60, 3)) * [100.0, 50.0, 100.0]]
        made += [one for one in some if np.all(one.closed_loop_poles.real < -1e-3)][:5]
    return [*PUBLISHED, *made]


def turns(loop: TransferLoop, turned: np.ndarray) -> float:
    """How often the curve 1 + L, L turned, goes around zero: 0 where the loop is stable (Nyquist 1932)."""
    angle = np.angle(1.0 + loop.open_loop(OMEGA) * np.exp(1j * turned))
    return float(np.sum(np.angle(np.exp(1j * np.diff(angle)))) / math.pi)


def test_margins_are_what_a_loop_bears_and_no_more() -> None:
    for loop in stable_loops():
        found = margins(loop)
        for share, stands in ((0.99, True), (1.01, False)):
            if math.isfinite(found.gain):
                louder = loop.with_gains(share * found.gain * loop.gain_values)
                assert np.all(louder.closed_loop_poles.real < 0.0) == stands
            if math.isfinite(found.delay):
                assert (abs(turns(loop, -OMEGA * share * found.delay)) < 0.5) == stands
            if math.isfinite(found.phase):
                later, sooner = (abs(turns(loop, sign * share * found.phase * np.ones_like(OMEGA))) for sign in (-1, 1))
                assert (max(later, sooner) < 0.5) == stands
        assert found.phase > 0.0
        assert found.delay > 0.0
        assert found.gain > 1.0


def test_the_peak_is_the_largest_of_many_samples() -> None:
    for loop in stable_loops():
        samples = sensitivity_magnitude(loop, OMEGA)
        assert margins(loop).Ms == pytest.approx(samples.max(), rel=1e-5)
        low, high = frequency_band(loop)
        assert low <= margins(loop).Ms_frequency <= high


def test_phase_and_gain_keep_the_bounds_that_the_peak_sets() -> None:
    # GM >= Ms / (Ms - 1), PM >= 2 arcsin(1 / (2 Ms)) (Skogestad & Postlethwaite 2005, section 2.4.3)
    for loop in stable_loops():
        found = margins(loop)
        assert found.gain >= found.Ms / (found.Ms - 1.0) - 1e-9
        assert found.phase >= 2.0 * math.asin(0.5 / found.Ms) - 1e-9


def test_the_delay_margin_alone_is_that_of_all_margins() -> None:
    without_gain, unstable = (fin_loop().with_gains(np.full(3, gain)) for gain in (0.0, 1e4))
    for loop in (*PUBLISHED, without_gain):
        assert delay_margin(loop) == margins(loop).delay
    assert math.isnan(delay_margin(unstable))


@pytest.mark.parametrize("loop", PUBLISHED, ids=lambda loop: loop.name)
def test_margins_are_those_of_python_control_among_all_its_crossings(loop: TransferLoop) -> None:
    found = margins(loop)
    gains, phases, distances, _, at_phase, _ = control.stability_margins(
        open_loop_transfer_function(loop), returnall=True
    )
    assert found.gain == pytest.approx(min(g for g in gains if g > 1.0), rel=1e-6)
    # its sign tells the way L would have to turn: negative where it has to be sooner
    assert found.phase == pytest.approx(math.radians(np.abs(phases).min()), rel=1e-6)
    assert found.delay == pytest.approx(np.min(np.radians(phases % 360.0) / at_phase), rel=1e-6)
    assert found.Ms == pytest.approx(1.0 / distances.min(), rel=1e-6)


@pytest.mark.parametrize("loop", stable_loops(), ids=range(len(stable_loops())))
def test_the_loop_is_unstable_just_below_its_lower_gain_margin(loop: TransferLoop) -> None:
    factor = margins(loop).lower_gain
    assert 0.0 <= factor < 1.0
    assert np.all(loop.with_gains(loop.gain_values * (1.01 * factor + 1e-6)).closed_loop_poles.real < 0.0)
    if factor > 0.0:
        assert np.any(loop.with_gains(loop.gain_values * 0.99 * factor).closed_loop_poles.real > 0.0)
