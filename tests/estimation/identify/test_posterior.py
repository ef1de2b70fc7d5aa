"""Sampling of a fit's posterior: on simulated truth, with process noise, written and read back, and what is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from standard_craft import NOMOTO
from tests.estimation.identify.conftest import NOISE, TRUTH, WriteTrial, square, steered

import seatrial as st
from seatrial.core.results import Fit, Posterior
from seatrial.core.values import Record
from seatrial.data.folder.model_file import joint_prior
from seatrial.data.folder.result_folder import load_fit, model_of_fit, save_result
from seatrial.data.trial import EstimateSettings, load_trial
from seatrial.data.trial.priors import EarlierResult
from seatrial.estimation.estimate import IntervalMethod
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.nonlinear_intervals import sample_posterior, sampling_findings
from seatrial.numerics.sampling import ChainSettings
from seatrial.physics.models.nomoto import nomoto
from seatrial.problems.disturbed_craft import Disturbance, independent_nomoto

OFFSETS = "[estimate]\noffsets = { delta = { sd = 3, unit = 'deg' } }\ndelays = { delta = 0 }"
Z_95 = 1.96
"""Standard deviations of a normal distribution in half of its 95 % interval."""


@pytest.fixture(scope="module")
def records() -> tuple[Record, ...]:
    rng, truth = np.random.default_rng(5), nomoto().with_values(TRUTH)
    runs = [steered(truth, square(300, phase=9.0 * i), rng, NOISE) for i in range(3)]
    return tuple(replace(run, name=f"run {i}") for i, run in enumerate(runs))


def estimated(records: tuple[Record, ...], workers: int = 1) -> Estimation:
    settings = EstimateSettings(delays={"delta": 0.0})  # simulated: the timing is known
    return estimate_model(nomoto(), Runs.one_session_each(records, 8.0), settings, EstimatorOptions(workers=workers))


def assert_agrees_with_the_bound(posterior: Posterior, estimation: Estimation) -> None:
    """Ends of the credible intervals, within four Monte Carlo errors of a quantile, are those of the information."""
    interval, centre = estimation.interval, estimation.estimate.common_parameters
    for i, c in enumerate(posterior.coefficients):
        sd = interval.standard_error[i]
        # sqrt(p (1 - p) / n) over the normal density 0.0584 at 1.96 standard deviations
        error = 4.0 * sd * np.sqrt(0.025 * 0.975 / c.effective_size) / 0.0584
        assert c.lower == pytest.approx(centre[i] - Z_95 * sd, abs=error)
        assert c.upper == pytest.approx(centre[i] + Z_95 * sd, abs=error)
        assert c.r_hat <= 1.01


def test_white_residuals_give_the_bound(records: tuple[Record, ...]) -> None:
    estimation = estimated(records)
    sampled, posterior = sample_posterior(estimation, seed=0)
    assert posterior.is_converged
    assert min(c.effective_size for c in posterior.coefficients) >= 400.0
    assert posterior.tempering == {}
    assert sampling_findings(posterior) == []
    assert_agrees_with_the_bound(posterior, estimation)
    draws = posterior.points.reshape(-1, len(posterior.coefficients))
    np.testing.assert_allclose(np.cov(draws, rowvar=False), sampled.interval.covariance, rtol=1e-9)


def test_draws_are_the_same_bits_whatever_the_number_of_workers(records: tuple[Record, ...]) -> None:
    few = ChainSettings(most_steps=100)
    one, two = (sample_posterior(estimated(records[:1], n), 3, settings=few)[1] for n in (1, 2))
    np.testing.assert_array_equal(one.points, two.points)


def test_process_noise_is_drawn_with_the_coefficients() -> None:
    rng = np.random.default_rng(8)
    (record,) = independent_nomoto(NOMOTO, Disturbance(1.0, 0.0), 1, rng, is_closed=False, seconds=100.0)
    estimation = estimated((record,))
    assert estimation.has_process_noise
    enough = ChainSettings(effective_size=150.0, r_hat=1.05)
    _, posterior = sample_posterior(estimation, seed=1, settings=enough)
    assert posterior.is_converged
    assert [c.name for c in posterior.coefficients] == ["K", "T"]
    for c, error in zip(posterior.coefficients, estimation.interval.standard_error, strict=False):
        assert 0.9 < c.standard_deviation / error < 1.6  # of 100 s the disturbance, too, is known roughly: wider
        assert c.lower < NOMOTO.model.parameters[c.name].value < c.upper


@pytest.fixture(scope="module")
def fit(records: tuple[Record, ...]) -> Fit:
    ship = st.Ship("craft", {"L": 8.0})
    runs = (st.Run(records[0]), st.Run(records[1], st.Role.VALIDATE))
    return identify(st.Trial(ship, runs, nomoto()), intervals=IntervalMethod.SAMPLING)


def test_the_fit_takes_its_intervals_from_the_draws(fit: Fit) -> None:
    assert fit.posterior is not None
    assert fit.intervals.startswith("posterior sampled by 4 chains")
    assert fit.posterior.other_intervals != fit.intervals
    spread = np.sqrt(np.diag(fit.covariance))  # without errors of instruments, which intervals hold too
    for c, error in zip(fit.posterior.coefficients, spread, strict=True):
        lower, upper, slack = fit[c.name].lower, fit[c.name].upper, 0.2 * c.standard_deviation
        assert lower is not None and upper is not None
        assert c.lower - slack <= lower <= c.lower and c.upper <= upper <= c.upper + slack
        assert error == pytest.approx(c.standard_deviation)


def test_the_draws_are_kept_in_the_folder(fit: Fit, tmp_path: Path) -> None:
    assert fit.posterior is not None
    again = load_fit(save_result(fit, tmp_path / "out"))
    assert again.posterior is not None
    assert again.posterior.coefficients == fit.posterior.coefficients
    np.testing.assert_array_equal(again.posterior.points, fit.posterior.points)
    with np.load(tmp_path / "out" / "posterior.npz") as file:
        assert file["names"].tolist() == [c.name for c in fit.posterior.coefficients]
        np.testing.assert_array_equal(file["points"], fit.posterior.points)
        assert file["log_density"].shape == file["points"].shape[:2]


def test_two_days_one_after_the_other_say_what_both_say_together(records: tuple[Record, ...]) -> None:
    """The earlier fit as a prior with its correlations; a hundredth of its variances is added on the way."""
    ship = st.Ship("craft", {"L": 8.0})
    first = identify(st.Trial(ship, (st.Run(records[0]),), nomoto(), noise=NOISE))
    earlier = EarlierResult("nomoto", "fit of monday", joint_prior(model_of_fit(first)), frozenset())
    priors = {n: st.Prior(p.mean, p.deviation, p.source) for n, p in earlier.priors.items()}
    model = nomoto().with_parameters(nomoto().parameters.with_priors(priors))
    held = earlier.joint_prior_of(model.parameters)
    second = identify(st.Trial(ship, (st.Run(records[1]),), model, noise=NOISE, joint_priors=(held,)))
    both = identify(st.Trial(ship, tuple(st.Run(r) for r in records[:2]), nomoto(), noise=NOISE))
    alone = identify(st.Trial(ship, (st.Run(records[1]),), model, noise=NOISE))
    names = both.model.parameters.free_names
    errors, of_second = (np.sqrt(np.diag(fit.covariance)) for fit in (both, second))
    for name, error in zip(names, errors, strict=True):
        assert second[name].estimate == pytest.approx(both[name].estimate, abs=0.05 * error)
    np.testing.assert_allclose(of_second, errors, rtol=0.02)
    correlation = both.covariance[0, 1] / np.sqrt(both.covariance[0, 0] * both.covariance[1, 1])
    assert abs(correlation) > 0.3  # so that leaving it out shows
    assert abs(alone["K"].estimate / both["K"].estimate - 1) > abs(second["K"].estimate / both["K"].estimate - 1)


def test_what_has_no_likelihood_is_not_sampled(trial_of: WriteTrial) -> None:
    trial = load_trial(trial_of({"a": 0.0, "b": 0.0}))
    published = replace(trial, estimate=trial.estimate.with_method("svr"))
    with pytest.raises(st.InputError, match="method 'svr' gives no intervals"):
        identify(published, intervals=IntervalMethod.SAMPLING)


def test_offsets_of_sessions_are_drawn_with_the_coefficients(trial_of: WriteTrial) -> None:
    trial = load_trial(trial_of({"a": 0.02, "b": -0.03, "c": 0.0}, more=OFFSETS))
    fit = identify(trial, intervals=IntervalMethod.SAMPLING)
    for offset, truth in zip(fit.offsets, (0.02, -0.03, 0.0), strict=True):
        assert offset.standard_error is not None
        assert abs(offset.estimate - truth) < 4 * offset.standard_error
