"""Intervals of normal estimates, and what a verification derives from its rows."""

from dataclasses import replace

import pytest

from seatrial.core.results.verification import (
    ModelCorrection,
    Verification,
    VerifiedQuantity,
    is_consistent,
    normal_interval,
)


def test_intervals_of_normal_estimates() -> None:
    assert normal_interval(1.0, 0.5) == pytest.approx((0.020018, 1.979982))
    assert is_consistent(1.0, 1.9, 0.3, 0.4)
    assert not is_consistent(1.0, 2.0, 0.3, 0.4)


def test_what_is_outside_and_what_moved_are_named() -> None:
    row = VerifiedQuantity("reduction", "1", 0.8, 0.79, 0.81, 0.7, 0.68, 0.72, False)
    moved = ModelCorrection("damping ratio", "1", 0.1, 0.03, 0.2, 0.15, 0.25, True)
    verification = Verification(
        "fins", "as given", "phi", "alpha_f", {"KP": 1.0}, (), (row, replace(row, name="rms", is_inside=True)), (),
        (moved, replace(moved, name="natural frequency", is_moved=False)), (),
    )  # fmt: skip
    assert verification.outside == ("reduction",)
    assert verification.moved == ("damping ratio",)
    assert "outside" in str(verification.summary())
