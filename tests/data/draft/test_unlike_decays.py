"""Decays of two conditions among one another are named, those of one condition are not."""

import numpy as np

from seatrial.core.values import Record
from seatrial.data.draft.held_out import heels_apart, unlike_decays_text


def decay(damping: float, seed: int, heel: float = 0.0) -> Record:
    """A free roll with a period of 6 s about a heel [deg], and a linear damping [1/s], read to 0.1 deg."""
    time = np.arange(0.0, 50.0, 0.05)
    phi = np.radians(heel) + np.radians(12.0) * np.exp(-damping * time) * np.cos(2.0 * np.pi * time / 6.0)
    return Record.from_arrays(
        "decay", time, {"phi": phi + np.radians(0.1) * np.random.default_rng(seed).normal(size=1000)}
    )


def test_decays_that_die_out_faster_are_named_with_the_factor() -> None:
    runs = {f"rest_{k}": decay(0.05, k) for k in range(3)} | {f"ten_knots_{k}": decay(0.1, k) for k in range(2)}
    text = unlike_decays_text(runs)
    assert text.startswith("ten_knots_0 and ten_knots_1 die out 2 times as fast as the others: ")


def test_decays_of_one_condition_are_alike() -> None:
    assert unlike_decays_text({f"run_{k}": decay(0.05 + 0.004 * k, k) for k in range(4)}) == ""
    assert unlike_decays_text({"only": decay(0.05, 0)}) == ""


def test_heels_that_differ_are_found_and_those_that_noise_leaves_are_not() -> None:
    apart = heels_apart({f"run_{k}": decay(0.05, k, heel) for k, heel in enumerate((0.0, 0.5, 1.5))})
    assert apart is not None
    np.testing.assert_allclose(np.degrees(apart), [0.0, 1.5], atol=0.15)
    assert heels_apart({f"run_{k}": decay(0.05 + 0.01 * k, k, 0.7) for k in range(4)}) is None
    assert heels_apart({"only": decay(0.05, 0, 2.0)}) is None
