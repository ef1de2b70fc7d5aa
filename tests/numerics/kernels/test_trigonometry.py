"""Sine and cosine together agree with the C library to the last bits, in every quadrant."""

import math

import numpy as np
import pytest

from seatrial.numerics.kernels.trigonometry import sincos


def test_it_agrees_with_the_library(rng: np.random.Generator) -> None:
    for angle in np.concatenate([rng.uniform(-10.0, 10.0, 500), rng.uniform(-1e5, 1e5, 500)]):
        sine, cosine = sincos(angle)
        assert sine == pytest.approx(math.sin(angle), abs=3e-16)
        assert cosine == pytest.approx(math.cos(angle), abs=3e-16)


def test_zero_and_signs_are_exact() -> None:
    assert sincos(0.0) == (0.0, 1.0)
    for angle in (0.3, 1.2, 2.9, 6.0):
        assert sincos(-angle) == (-sincos(angle)[0], sincos(angle)[1])
