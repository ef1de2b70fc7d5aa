"""Blocks: what is refused, what a product is, responses against polynomials."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import InputError
from seatrial.physics.loops import Block, in_series

FIRST, SECOND = Block("lag", (2.0,), (3.0, 1.0)), Block("gyro", (400.0, 0.0), (1.0, 80.0, 4000.0))
OMEGA = np.geomspace(1e-2, 1e2, 7)
numbers = st.floats(-5.0, 5.0).filter(lambda x: abs(x) > 0.1)


@pytest.mark.parametrize(
    ("num", "den", "said"),
    [
        ((1.0, 0.0), (1.0,), "of degree 1, the denominator of 0"),
        ((1.0, float("nan")), (1.0, 1.0), "'num' needs finite coefficients"),
        ((1.0,), (float("inf"), 1.0), "'den' needs finite coefficients"),
        ((), (1.0,), "'num' needs finite coefficients"),
        ((1.0,), (0.0, 0.0), "the denominator is zero"),
    ],
)
def test_what_is_no_block_is_refused_by_name(num: tuple[float, ...], den: tuple[float, ...], said: str) -> None:
    with pytest.raises(InputError, match=f"block 'servo': .*{said}"):
        Block("servo", num, den)


def test_leading_zeros_fall_away() -> None:
    block = Block("lag", (0.0, 0.0, 2.0), (0.0, 3.0, 1.0))
    assert (block.num, block.den, block.order) == ((2.0,), (3.0, 1.0), 1)
    assert Block("nothing", (0.0, 0.0), (1.0, 1.0)).num == (0.0,)


def test_response_gain_and_poles_of_a_lag_are_those_of_the_textbook() -> None:
    np.testing.assert_allclose(FIRST.frequency_response(OMEGA), 2.0 / (1.0 + 3j * OMEGA), rtol=1e-14)
    np.testing.assert_allclose(FIRST.poles, [-1.0 / 3.0])
    assert FIRST.gain == 2.0
    assert SECOND.gain == 0.0
    assert Block("integrator", (1.0,), (1.0, 0.0)).gain == np.inf


def test_a_scaled_block_answers_in_proportion() -> None:
    np.testing.assert_allclose(
        SECOND.scaled(-1.5).frequency_response(OMEGA), -1.5 * SECOND.frequency_response(OMEGA), rtol=1e-14
    )


@given(st.lists(st.tuples(numbers, numbers, numbers), min_size=0, max_size=5))
def test_a_series_answers_as_the_product(drawn: list[tuple[float, float, float]]) -> None:
    blocks = [Block("b", (a,), (b, c)) for a, b, c in drawn]
    made = in_series("all", blocks)
    product = np.prod([block.frequency_response(OMEGA) for block in blocks], axis=0)
    np.testing.assert_allclose(made.frequency_response(OMEGA), product * np.ones_like(OMEGA), rtol=1e-11)
    assert made.order == len(blocks)


def test_nothing_cancels_in_a_series() -> None:
    assert in_series("both", [Block("a", (1.0, 1.0), (1.0, 2.0)), Block("b", (1.0,), (1.0, 1.0))]).order == 2
