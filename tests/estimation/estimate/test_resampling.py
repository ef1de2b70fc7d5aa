"""Refits to other runs, against one Gauss-Newton step and against themselves."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.estimate.test_intervals import made

from seatrial.core.values import InputError
from seatrial.estimation.estimate.intervals import (
    bootstrap_fits,
    estimate_uncertainty,
    fits_without,
    full_jackknife,
    one_step_by_run,
    one_step_jackknife,
)
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.settings import IntervalMethod
from seatrial.estimation.information.covariance import jackknife
from seatrial.physics.models.nomoto import nomoto

RUNS = 8
WHITE = np.array([1.0, 1.1])


@pytest.fixture(scope="module")
def one() -> PointEstimate:
    """Eight noisy zigzags of a first-order ship."""
    return made(nomoto().with_values({"K": 0.15, "T": 8.0}), RUNS, 30.0)


def test_one_step_stands_for_a_refit(one: PointEstimate) -> None:
    full, fast = full_jackknife(one), one_step_jackknife(one)
    assert full.shape == fast.shape == (RUNS, one.problem.size)
    scatter = np.std(full, axis=0)
    assert np.all(scatter > 0)
    assert np.all(np.abs(fast - full) <= 0.05 * scatter)
    np.testing.assert_allclose(jackknife(fast, "").standard_error, jackknife(full, "").standard_error, rtol=0.03)


def test_a_run_by_itself_is_what_a_fit_to_it_alone_gives(one: PointEstimate) -> None:
    by_run = one_step_by_run(one)
    alone = fits_without(one, [[r for r in range(RUNS) if r != k] for k in range(RUNS)])
    free = len(one.problem.free)
    assert np.all(np.abs(by_run.values - alone)[:, :free] <= 0.3 * by_run.deviations[:, :free])


def test_a_run_left_out_is_not_looked_at(one: PointEstimate) -> None:
    """What the run measured changes nothing in the refit without it."""
    measured = one.problem.data.measured.copy()
    (first, *_, last) = one.problem.data.run_segments(2)
    measured[one.problem.data.offsets[first] : one.problem.data.offsets[last + 1]] += 0.3
    spoiled = replace(one, problem=replace(one.problem, data=replace(one.problem.data, measured=measured)))
    np.testing.assert_array_equal(full_jackknife(spoiled)[2], full_jackknife(one)[2])
    assert not np.allclose(full_jackknife(spoiled)[3], full_jackknife(one)[3], rtol=1e-3)


@pytest.mark.parametrize("workers", [1, 3])
def test_a_bootstrap_repeats_itself_bit_for_bit(one: PointEstimate, workers: int) -> None:
    again = [bootstrap_fits(one, 6, np.random.default_rng(4), workers=w) for w in (1, workers)]
    np.testing.assert_array_equal(*again)
    assert not np.array_equal(again[0], bootstrap_fits(one, 6, np.random.default_rng(5)))


def test_bootstrap_and_jackknife_agree(one: PointEstimate) -> None:
    kinds = {
        k: estimate_uncertainty(one, WHITE, k, np.random.default_rng(1))
        for k in (IntervalMethod.JACKKNIFE, IntervalMethod.BOOTSTRAP)
    }
    ratio = (
        kinds[IntervalMethod.BOOTSTRAP].interval.standard_error
        / kinds[IntervalMethod.JACKKNIFE].interval.standard_error
    )
    assert np.all((ratio > 0.5) & (ratio < 2.0)), "40 draws of 8 runs: some 12 % and 25 % of chance each"
    assert kinds[IntervalMethod.JACKKNIFE].one_step_ratio == pytest.approx(1.0, abs=0.03)
    assert "each refitted" in kinds[IntervalMethod.JACKKNIFE].interval.meaning
    assert "40 draws" in kinds[IntervalMethod.BOOTSTRAP].interval.meaning


def test_progress_counts_the_refits(one: PointEstimate) -> None:
    counted: list[tuple[int, int]] = []
    full_jackknife(one, report_progress=lambda done, total: counted.append((done, total)))
    assert counted[-1] == (RUNS, RUNS)


def test_too_few_runs_are_refused_with_their_number() -> None:
    few = made(nomoto().with_values({"K": 0.15, "T": 8.0}), 3, 30.0)
    with pytest.raises(InputError, match=r"jackknife leave whole runs out and need at least 4 training runs.* has 3"):
        estimate_uncertainty(few, WHITE, IntervalMethod.JACKKNIFE)
