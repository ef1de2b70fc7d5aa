"""Autocorrelation, the whiteness test and paired errors, against processes that are known."""

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter

from seatrial.estimation.information.whiteness import (
    FALSE_ALARMS,
    autocorrelation,
    is_no_worse,
    standard_error,
    variance_inflation,
    whiteness_p,
    whiteness_test,
)


def ar1(rng: np.random.Generator, phi: float, size: int) -> np.ndarray:
    return lfilter([1.0], [1.0, -phi], rng.standard_normal(size + 200))[200:]


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.9])
def test_of_an_autoregressive_process(rng: np.random.Generator, phi: float) -> None:
    """rho_k = phi^k; the tolerance is four of Bartlett's standard errors."""
    rho = autocorrelation([ar1(rng, phi, 100_000)], 12)
    error = np.sqrt((1 + phi**2) / (1 - phi**2) / 100_000)
    np.testing.assert_allclose(rho, phi ** np.arange(13), atol=4 * error)


def test_pieces_are_not_joined() -> None:
    """A constant of one sign, then of the other: within pieces every product is positive."""
    rho = autocorrelation([np.ones(10), -np.ones(10)], 3)
    np.testing.assert_allclose(rho, [1.0, 0.9, 0.8, 0.7])


def test_against_the_plain_sum(rng: np.random.Generator) -> None:
    e = rng.standard_normal(37)
    direct = [np.sum(e[: 37 - k] * e[k:]) for k in range(9)]
    np.testing.assert_allclose(autocorrelation([e], 8), np.array(direct) / direct[0], atol=1e-12)


def test_pieces_of_one_length_count_as_one_by_one(rng: np.random.Generator) -> None:
    pieces = [rng.standard_normal(length) for length in (*[40] * 30, 17, *[40] * 5, 3)]
    total = np.zeros(13)
    for e in pieces:
        kept = min(12, len(e) - 1) + 1
        total[:kept] += np.fft.irfft(np.abs(np.fft.rfft(e, 64)) ** 2, 64)[:kept]
    np.testing.assert_allclose(autocorrelation(pieces, 12), total / total[0], atol=1e-14)


def test_short_pieces_and_gaps(rng: np.random.Generator) -> None:
    e = rng.standard_normal(500)
    gappy = e.copy()
    gappy[100:110] = np.nan
    filled = np.where(np.isfinite(gappy), gappy, 0.0)
    np.testing.assert_array_equal(autocorrelation([gappy], 5), autocorrelation([filled], 5))
    assert autocorrelation([e[:3], e[3:6]], 10)[3:] == pytest.approx(0.0)
    np.testing.assert_array_equal(autocorrelation([np.zeros(5)], 3), [1.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("phi", [0.5, 0.9])
def test_inflation_of_an_autoregressive_process(rng: np.random.Generator, phi: float) -> None:
    """Exactly (1 + phi) / (1 - phi)."""
    exact = (1 + phi) / (1 - phi)
    assert variance_inflation(phi ** np.arange(400)) == pytest.approx(exact, rel=1e-6)
    estimated = variance_inflation(autocorrelation([ar1(rng, phi, 200_000)], 400))
    assert estimated == pytest.approx(exact, rel=0.1)


def test_inflation_is_that_of_the_mean(rng: np.random.Generator) -> None:
    means = [np.mean(ar1(rng, 0.8, 400)) for _ in range(1500)]
    expected = variance_inflation(0.8 ** np.arange(400)) / 400 / (1 - 0.8**2)
    assert np.var(means) == pytest.approx(expected, rel=0.15)


def test_p_values_of_white_noise_are_uniform(rng: np.random.Generator) -> None:
    p = [whiteness_p(autocorrelation([rng.standard_normal(1000)], 20), 1000) for _ in range(600)]
    assert stats.kstest(p, "uniform").pvalue > 0.01
    assert 0.02 < np.mean(np.array(p) < 0.05) < 0.09


def test_colour_is_found(rng: np.random.Generator) -> None:
    assert whiteness_p(autocorrelation([ar1(rng, 0.3, 1000)], 20), 1000) < 1e-6


def test_too_few_samples_say_nothing() -> None:
    assert whiteness_p(np.array([1.0]), 1) == 1.0


RUNS, ROWS = 400, 2000


def test_white_noise_fails_as_often_as_stated() -> None:
    """False alarms in either of two channels: at most the stated 2 %, within three standard errors of 400 runs."""
    rng = np.random.default_rng(1)
    failed = sum(not whiteness_test([rng.standard_normal((ROWS, 2))]).is_white for _ in range(RUNS))
    assert failed / RUNS <= FALSE_ALARMS + 3.0 * np.sqrt(FALSE_ALARMS / RUNS)


@pytest.mark.parametrize(("lag", "share"), [(1, 0.2), (60, 0.3)])
def test_short_and_long_correlation_are_seen(lag: int, share: float) -> None:
    noise = np.random.default_rng(2).standard_normal((ROWS, 2))
    noise[lag:, 1] += share * noise[:-lag, 1].copy()
    test = whiteness_test([noise])
    assert not test.is_white
    assert test.p_values[0] > test.level > test.p_values[1]
    assert test.smallest == pytest.approx(2.0 * test.p_values[1])


def test_missing_samples_count_as_none() -> None:
    noise = np.random.default_rng(3).standard_normal((ROWS, 1))
    noise[::3] = np.nan
    assert whiteness_test([noise[:900], noise[900:]]).is_white


def test_standard_error_is_that_of_the_mean(rng: np.random.Generator) -> None:
    excess = rng.standard_normal(9)
    assert standard_error(excess) == pytest.approx(stats.sem(excess))
    assert np.isinf(standard_error(excess[:1]))


def test_it_is_the_one_sided_paired_t_test(rng: np.random.Generator) -> None:
    for shift in np.linspace(-1.0, 2.0, 31):
        excess = shift + rng.standard_normal(4)
        is_worse = stats.ttest_1samp(excess, 0.0, alternative="greater").pvalue < 0.05
        assert is_no_worse(excess, 0.0) == (not is_worse)


def test_what_is_negligible_is_no_worse_however_regular() -> None:
    assert is_no_worse(np.full(4, 0.2), 0.3)
    assert not is_no_worse(np.full(4, 0.4), 0.3)
    assert not is_no_worse(np.array([0.0, 0.0, np.inf, 0.0]), 0.3)
