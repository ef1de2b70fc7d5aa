"""Vector instructions: each does to every lane what NumPy does to an array, in compiled code."""

import numpy as np
import pytest
from numba import njit

from seatrial.numerics.kernels import simd

LANES = simd.LANES


@pytest.fixture
def slots(rng: np.random.Generator) -> np.ndarray:
    """Six slots of random numbers, aligned."""
    flat = simd.aligned_scratch(6)
    flat[:] = rng.standard_normal(6 * LANES)
    return flat


def test_scratch_is_aligned_to_a_slot() -> None:
    flat = simd.aligned_scratch(3)
    assert flat.shape == (3 * LANES,) and flat.__array_interface__["data"][0] % (8 * LANES) == 0


def test_dot_sums_over_slots_in_every_lane(slots: np.ndarray) -> None:
    @njit
    def call(w):
        simd.dot(w, 5, 0, 2, 1, 2)

    before = slots.reshape(6, LANES).copy()
    call(slots)
    np.testing.assert_allclose(slots[5 * LANES :], before[0] * before[2] + before[1] * before[3], rtol=1e-14)
    np.testing.assert_array_equal(slots[: 5 * LANES], before[:5].ravel())


def test_add_scaled_adds_slots_by_the_numbers_of_an_array(slots: np.ndarray) -> None:
    numbers = np.array([9.0, 2.0, 9.0, -0.5])

    @njit
    def call(w, numbers):
        simd.add_scaled(w, 4, 0, 1, numbers, 1, 2, 2)

    before = slots.reshape(6, LANES).copy()
    call(slots, numbers)
    np.testing.assert_allclose(slots[4 * LANES : 5 * LANES], before[4] + 2.0 * before[0] - 0.5 * before[1], rtol=1e-14)


def test_broadcast_squared_difference_and_selection(slots: np.ndarray) -> None:
    @njit
    def call(w):
        simd.broadcast(w, 0, 3.0)
        simd.add_squared_difference(w, 1, 2, 0.5, 4.0)
        simd.copy_where_greater(w, 3, 4, 5, 0.0)

    before = slots.reshape(6, LANES).copy()
    call(slots)
    after = slots.reshape(6, LANES)
    np.testing.assert_array_equal(after[0], 3.0)
    np.testing.assert_allclose(after[1], before[1] + 4.0 * (before[2] - 0.5) ** 2, rtol=1e-14)
    np.testing.assert_array_equal(after[3], np.where(before[5] > 0.0, before[4], before[3]))


def test_add_multiple_adds_a_multiple_of_a_slot(slots: np.ndarray) -> None:
    @njit
    def call(w):
        simd.add_multiple(w, 5, 1, -0.5, 2)

    before = slots.reshape(6, LANES).copy()
    call(slots)
    np.testing.assert_allclose(slots[5 * LANES :], before[1] - 0.5 * before[2], rtol=1e-14)
    np.testing.assert_array_equal(slots[: 5 * LANES], before[:5].ravel())


def test_gather_scaled_sums_as_many_slots_as_are_wanted(rng: np.random.Generator) -> None:
    """Slots of rows 1 and 2, scaled, and those of row 3: for counts within one round and beyond it."""

    @njit
    def call(w, count, numbers, number_at, slot_at):
        simd.gather_scaled(w, 4 * count, count, 0, numbers, number_at, slot_at, 1, 3, 3 * count)

    numbers = np.array([9.0, 2.0, 9.0, -0.5])
    for count in (1, 2, 3, 4, 5, 9):
        flat = simd.aligned_scratch(5 * count)
        flat[:] = rng.standard_normal(len(flat))
        before = flat.reshape(5, count * LANES).copy()
        call(flat, count, numbers, np.array([0, 1, 3]), np.array([0, 1, 2]) * count)
        after = flat.reshape(5, count * LANES)
        np.testing.assert_allclose(after[4], 2.0 * before[1] - 0.5 * before[2] + before[3], rtol=1e-13, atol=1e-14)
        np.testing.assert_array_equal(after[:4], before[:4])
