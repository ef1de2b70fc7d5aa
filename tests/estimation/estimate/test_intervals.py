"""Which interval a fit gets, and what it is worth."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Prior, Record
from seatrial.estimation.estimate.intervals import estimate_uncertainty
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import replay
from seatrial.physics.simulate.batch import InputCorrection

WHITE, COLOURED = np.array([1.0, 1.1]), np.array([1.0, 16.0])


@pytest.fixture(scope="module")
def model() -> Model:
    return nomoto().with_values({"K": 0.15, "T": 8.0})


def made(model: Model, runs: int, seconds: float | None) -> PointEstimate:
    rng, records = np.random.default_rng(5), []
    for i in range(runs):
        time = 0.5 * np.arange(241)
        delta = 0.3 * np.sign(np.sin(0.12 * time + i))
        record = replay(model, Record.from_arrays(f"run {i}", time, {"delta": delta}), {"r": 0.0})
        psi = record.channel("psi").with_values(record["psi"] + 0.01 * rng.standard_normal(241))
        r = record.channel("r").with_values(record["r"] + 0.005 * rng.standard_normal(241))
        records.append(record.with_channel("psi", psi).with_channel("r", r))
    problem = OutputError(
        model, cut_segments(model, records, ("r", "psi"), seconds), np.array([0.005, 0.01]), workers=1
    )
    return PointEstimate(problem, levenberg_marquardt(problem, problem.start(), problem.measured_initial_states()))


def test_white_residuals_get_the_information_matrix(model: Model) -> None:
    one = made(model, 6, None)
    interval = estimate_uncertainty(one, WHITE).interval
    assert interval.meaning.startswith("information matrix, every sample counted as independent")
    np.testing.assert_allclose(interval.covariance, np.linalg.inv(one.optimum.normal.without_local()[1]), rtol=1e-8)


@pytest.mark.parametrize(
    ("runs", "seconds", "says"), [(6, 30.0, "jackknife over 6 runs"), (2, 10.0, "sandwich over 24 blocks")]
)
def test_coloured_residuals_get_what_the_runs_allow(model: Model, runs: int, seconds: float, says: str) -> None:
    one = made(model, runs, seconds)
    interval = estimate_uncertainty(one, COLOURED).interval
    assert says in interval.meaning
    plain = estimate_uncertainty(one, WHITE).interval
    ratio = interval.standard_error / plain.standard_error
    assert np.all((ratio > 0.3) & (ratio < 3.0)), "residuals of this record are white: all intervals agree roughly"


def with_prior_on(one: PointEstimate, mean: float, deviation: float) -> PointEstimate:
    """The same data with a prior on K, searched again."""
    model = one.problem.model
    priors = model.parameters.with_priors({"K": Prior(mean, deviation)})
    problem = replace(one.problem, model=model.with_parameters(priors))
    return PointEstimate(problem, levenberg_marquardt(problem, one.common_parameters, one.optimum.local))


@pytest.mark.parametrize("inflation", [WHITE, COLOURED])
@pytest.mark.parametrize(("runs", "seconds", "deviation"), [(6, 30.0, 0.0015), (2, 10.0, 0.005), (1, None, 0.0015)])
def test_intervals_hold_the_truth_beside_a_prior_that_is_wrong(
    model: Model, runs: int, seconds: float | None, deviation: float, inflation: np.ndarray
) -> None:
    """With K 0.15 in the records and a prior of 0.18, 6 or 20 standard deviations off, the optimum is between."""
    one = made(model, runs, seconds)
    wrong = with_prior_on(one, 0.18, deviation)
    interval, error = estimate_uncertainty(wrong, inflation).interval, np.abs(wrong.common_parameters - [0.15, 8.0])
    assert error[0] > 2.0 * np.linalg.inv(wrong.optimum.normal.without_local()[1])[0, 0] ** 0.5, "the prior moves K"
    assert np.all(error < interval.half_width)


def test_a_prior_that_the_records_bear_out_widens_nothing(model: Model) -> None:
    one = with_prior_on(made(model, 1, None), 0.15, 0.0015)
    interval = estimate_uncertainty(one, WHITE).interval
    np.testing.assert_allclose(interval.covariance, np.linalg.inv(one.optimum.normal.without_local()[1]), rtol=1e-8)


def counted(one: PointEstimate, inflation: np.ndarray) -> PointEstimate:
    """The same data with samples counted as their effective number, searched again."""
    problem = replace(one.problem, inflation=inflation)
    return PointEstimate(problem, levenberg_marquardt(problem, one.common_parameters, one.optimum.local))


def test_few_runs_and_segments_count_effective_samples_once(model: Model) -> None:
    one = made(model, 1, None)
    alike = np.array([9.0, 9.0])
    widened = estimate_uncertainty(counted(one, alike), alike).interval
    np.testing.assert_allclose(
        widened.standard_error, 3.0 * estimate_uncertainty(one, WHITE).interval.standard_error, rtol=1e-3
    )
    assert "effective number" in widened.meaning


def test_effective_samples_leave_the_optimum_without_priors(model: Model) -> None:
    """Equal inflation of all channels scales the cost and nothing else."""
    one = made(model, 2, None)
    again = counted(one, np.array([4.0, 4.0]))
    np.testing.assert_allclose(again.common_parameters, one.common_parameters, rtol=1e-8)
    assert again.optimum.solution.value == pytest.approx(one.optimum.solution.value / 4.0, rel=1e-9)


def test_offsets_of_a_run_get_the_information_of_that_run(model: Model) -> None:
    """A run left out moves its own offset back to the prior mean: that is no error of the offset."""
    one = made(model, 6, 30.0)
    zero = Nuisance(InputCorrection("delta", "zero"), Prior(0.0, 0.05), "rad")
    problem = replace(one.problem, nuisances=(zero,))
    start = np.concatenate([one.common_parameters, np.zeros(6)])
    freed = PointEstimate(problem, levenberg_marquardt(problem, start, one.optimum.local))
    interval = estimate_uncertainty(freed, COLOURED).interval
    of_offsets = np.linalg.inv(freed.optimum.normal.without_local()[1])[-6:, -6:]
    np.testing.assert_allclose(interval.covariance[-6:, -6:], of_offsets, rtol=1e-6, atol=1e-12)
    assert "jackknife" in interval.meaning
