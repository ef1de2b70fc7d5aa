"""Refits to other runs, against one Gauss-Newton step and against themselves."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.estimate.test_intervals import made

from seatrial.core.values import InputError
from seatrial.estimation.estimate.estimate import Estimate
from seatrial.estimation.estimate.intervals import intervals
from seatrial.estimation.estimate.replicates import drawn, left_out, stepped
from seatrial.estimation.estimate.settings import Intervals
from seatrial.estimation.information.covariance import jackknife
from seatrial.physics.models.nomoto import nomoto

RUNS = 8
WHITE = np.array([1.0, 1.1])


@pytest.fixture(scope="module")
def one() -> Estimate:
    """Eight noisy zigzags of a first-order ship."""
    return made(nomoto().with_values({"K": 0.15, "T": 8.0}), RUNS, 30.0)


def test_one_step_stands_for_a_refit(one: Estimate) -> None:
    full, fast = left_out(one), stepped(one)
    assert full.shape == fast.shape == (RUNS, one.problem.size)
    scatter = np.std(full, axis=0)
    assert np.all(scatter > 0)
    assert np.all(np.abs(fast - full) <= 0.05 * scatter)
    np.testing.assert_allclose(jackknife(fast, "").standard_error, jackknife(full, "").standard_error, rtol=0.03)


def test_a_run_left_out_is_not_looked_at(one: Estimate) -> None:
    """What the run measured changes nothing in the refit without it."""
    measured = one.problem.data.measured.copy()
    (first, *_, last) = one.problem.data.of_run(2)
    measured[one.problem.data.offsets[first] : one.problem.data.offsets[last + 1]] += 0.3
    spoiled = replace(one, problem=replace(one.problem, data=replace(one.problem.data, measured=measured)))
    np.testing.assert_array_equal(left_out(spoiled)[2], left_out(one)[2])
    assert not np.allclose(left_out(spoiled)[3], left_out(one)[3], rtol=1e-3)


@pytest.mark.parametrize("workers", [1, 3])
def test_a_bootstrap_repeats_itself_bit_for_bit(one: Estimate, workers: int) -> None:
    again = [drawn(one, 6, np.random.default_rng(4), workers=w) for w in (1, workers)]
    np.testing.assert_array_equal(*again)
    assert not np.array_equal(again[0], drawn(one, 6, np.random.default_rng(5)))


def test_bootstrap_and_jackknife_agree(one: Estimate) -> None:
    kinds = {k: intervals(one, WHITE, k, np.random.default_rng(1)) for k in (Intervals.JACKKNIFE, Intervals.BOOTSTRAP)}
    ratio = kinds[Intervals.BOOTSTRAP].interval.standard_error / kinds[Intervals.JACKKNIFE].interval.standard_error
    assert np.all((ratio > 0.5) & (ratio < 2.0)), "40 draws of 8 runs: some 12 % and 25 % of chance each"
    assert kinds[Intervals.JACKKNIFE].agreement == pytest.approx(1.0, abs=0.03)
    assert "each refitted" in kinds[Intervals.JACKKNIFE].interval.meaning
    assert "40 draws" in kinds[Intervals.BOOTSTRAP].interval.meaning


def test_progress_counts_the_refits(one: Estimate) -> None:
    counted: list[tuple[int, int]] = []
    left_out(one, progress=lambda done, total: counted.append((done, total)))
    assert counted[-1] == (RUNS, RUNS)


def test_too_few_runs_are_refused_with_their_number() -> None:
    few = made(nomoto().with_values({"K": 0.15, "T": 8.0}), 3, 30.0)
    with pytest.raises(InputError, match=r"jackknife leave whole runs out and need at least 4 training runs.* has 3"):
        intervals(few, WHITE, Intervals.JACKKNIFE)
