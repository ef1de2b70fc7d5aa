"""Breeding compiled: the same children as the steps written out in NumPy, for the same random numbers."""

import numpy as np
import pytest

from seatrial.numerics.kernels.breeding import breed, decode_codes, exchange_tails, selection_shares, spin


def plain_offspring(codes, J, elite, spins, cut, flips, Pm):
    """Roulette on 1 / J, one-point crossover, mutation: each step as its definition reads."""
    fitness = 1.0 / J
    share = fitness - fitness.min()
    share /= share.sum()
    rows = np.searchsorted(np.cumsum(share), spins * np.cumsum(share)[-1], side="right")
    tail = np.arange(codes.shape[1]) >= cut[:, None]
    mothers, fathers = codes[rows]
    children = np.concatenate([np.where(tail, fathers, mothers), np.where(tail, mothers, fathers)])[: len(flips)]
    return np.concatenate([codes[elite], children ^ (flips < Pm)])


@pytest.mark.parametrize("population", [8, 9, 50])
def test_offspring_are_those_of_the_steps_written_out(population: int) -> None:
    rng = np.random.default_rng(population)
    codes = rng.integers(0, 2, (population, 12), dtype=np.uint8)
    J, elite = rng.random(population) + 0.1, np.array([3, 0, 5])
    count = population - len(elite)
    pairs = (count + 1) // 2
    spins, flips, cut = rng.random((2, pairs)), rng.random((count, 12)), rng.integers(1, 13, pairs)
    offspring = np.empty_like(codes)
    breed(codes, J, elite, spins, cut, flips, 0.1, offspring)
    assert np.array_equal(offspring, plain_offspring(codes, J, elite, spins, cut, flips, 0.1))


def test_shares_are_even_where_all_are_alike_and_none_falls_on_the_worst() -> None:
    share = np.empty(4)
    selection_shares(np.full(4, 2.0), share)
    assert np.allclose(share, 0.25)
    selection_shares(np.array([1.0, 3.0, 2.0, 1.0]), share)
    assert np.allclose(share, [0.0, 2.0 / 3.0, 1.0 / 3.0, 0.0])
    rows = np.empty((1, 2), dtype=np.int64)
    spin(share, np.array([[0.0, np.nextafter(1.0, 0.0)]]), rows)
    assert rows.tolist() == [[1, 2]]


def test_tails_are_exchanged_from_the_cut_on() -> None:
    children = np.empty((2, 4), dtype=np.uint8)
    exchange_tails(np.zeros((1, 4), np.uint8), np.ones((1, 4), np.uint8), np.array([1]), children)
    assert children.tolist() == [[0, 1, 1, 1], [1, 0, 0, 0]]


def test_codes_are_binary_numbers_over_the_largest() -> None:
    unit = np.empty((1, 2))
    decode_codes(np.array([[1, 0, 1, 0, 1, 1]], dtype=np.uint8), unit)
    assert np.allclose(unit, [[5 / 7, 3 / 7]])
