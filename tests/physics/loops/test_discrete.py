"""Difference equations: against SciPy's bilinear rule, and the frequency response they should have."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import bilinear, freqz

from seatrial.core.values import InputError
from seatrial.physics.loops import Block
from seatrial.physics.loops.autopilot import heading_loop
from seatrial.physics.loops.discrete import (
    default_sample_time,
    difference_equation,
    discrete_blocks,
    holding_terms,
    ringing_blocks,
)
from seatrial.physics.loops.loop import Sampling, straight_step
from seatrial.physics.loops.structures import fin_loop

BLOCKS = [
    Block("lag", (1.0,), (24.607, 1.0)),
    Block("derivative", (0.064, 0.0), (0.064 * 0.18, 0.244, 1.0)),
    Block("gain", (3.0,), (1.0,)),
    Block("integral", (1.0,), (1.0, 0.0)),
    Block("notch", (1.0, 0.1, 1.0), (1.0, 1.0, 1.0)),
]


@pytest.mark.parametrize("block", BLOCKS, ids=lambda b: b.name)
def test_it_is_scipys_bilinear_rule(block: Block) -> None:
    expected = bilinear(block.num, block.den, fs=20.0)
    for ours, theirs in zip(difference_equation(block, 0.05), expected, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("block", BLOCKS, ids=lambda b: b.name)
def test_at_low_frequencies_it_answers_as_the_block(block: Block) -> None:
    T, omega = 0.01, np.geomspace(0.01, 2.0, 20)
    _, response = freqz(*difference_equation(block, T), worN=omega * T)
    np.testing.assert_allclose(response, block.frequency_response(omega), rtol=1e-3)


def test_the_default_sample_time_costs_six_degrees_where_the_loop_is_frailest() -> None:
    T = default_sample_time(fin_loop())
    assert T in (0.01, 0.02, 0.05, 0.1)


@pytest.mark.parametrize("T", [0.0, -0.1, float("nan")])
def test_a_sample_time_that_is_none_is_refused(T: float) -> None:
    with pytest.raises(InputError, match="not positive"):
        difference_equation(BLOCKS[0], T)


def test_slow_terms_hold_with_the_sign_of_their_share() -> None:
    """The integral winds up, the filtered derivative does not; of a plant that turns the other way it pushes back."""
    plant = Block("ship", (0.2,), (8.0, 1.0, 0.0))
    loop, reversed_loop = (heading_loop(one, one, ()) for one in (plant, plant.scaled(-1.0)))
    assert holding_terms(loop) == ((False, True, False), 1.0)
    assert holding_terms(reversed_loop) == ((False, True, False), -1.0)
    blocks = discrete_blocks(replace(reversed_loop, sampling=Sampling(0.1)))
    assert [(block.role, block.gain, block.hold) for block in blocks] == [
        ("term", "KP", 0), ("term", "KI", -1), ("term", "KD", 0), ("filter", "", 0),
    ]  # fmt: skip


def test_no_block_rings_at_the_default_sample_time() -> None:
    loop = heading_loop(Block("ship", (0.2,), (8.0, 1.0, 0.0)), Block("ship", (0.2,), (8.0, 1.0, 0.0)), ())
    assert ringing_blocks(loop, default_sample_time(loop)) == ()


def test_a_step_over_a_straight_input_is_the_solution_of_a_lag() -> None:
    """T x' = u - x from 0, u from 0 to 1 over h: x(h) = 1 - T / h (1 - e^(-h / T)); with both ends a held input."""
    T, h = 2.0, 0.5
    E, before, after = straight_step(np.array([[-1.0 / T]]), np.array([1.0 / T]), h)
    assert pytest.approx(np.exp(-h / T)) == E
    assert after == pytest.approx(1.0 - T / h * (1.0 - np.exp(-h / T)))
    assert before + after == pytest.approx(1.0 - np.exp(-h / T))
