"""Loops by the thousand: Routh's test against roots, variances and peak against plain arithmetic."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from seatrial.numerics.kernels.loop import evaluate_loops, is_hurwitz, sensitivity_peaks, variance_gradients

EMPTY = np.empty((2, 0))
scale = st.sampled_from([-3.0, -1e-3, 1.0, 50.0])


def is_stable(row: np.ndarray) -> bool:
    return is_hurwitz(np.array(row, dtype=np.float64), len(row) - 1) == 1


@settings(max_examples=300)
@given(st.lists(st.floats(-10.0, 10.0), min_size=2, max_size=15))
def test_routh_agrees_with_the_roots_of_any_polynomial(row: list[float]) -> None:
    assume(abs(row[0]) > 1e-3)
    roots = np.roots(row)
    assume(np.abs(roots.real).min(initial=np.inf) > 1e-4)
    assert is_stable(np.array(row)) == np.all(roots.real < 0.0)


@settings(max_examples=300)
@given(
    st.lists(st.floats(0.05, 3.0), max_size=6),
    st.lists(st.tuples(st.floats(0.05, 3.0), st.floats(0.1, 5.0)), max_size=4),
    st.booleans(),
    scale,
)
def test_routh_agrees_with_the_roots_it_was_made_of(
    real: list[float], pairs: list[tuple[float, float]], one_is_right: bool, lead: float
) -> None:
    roots = np.array([-r for r in real] + [complex(-a, s * b) for a, b in pairs for s in (1.0, -1.0)])
    assume(roots.size)
    if one_is_right:
        wrong = np.abs(roots.real - roots.real[-1]) < 1e-12
        roots[wrong] = -np.conj(roots[wrong])
    assert is_stable(lead * np.poly(roots).real) != one_is_right


@pytest.mark.parametrize("degree", range(1, 15))
def test_a_chain_of_lags_is_stable_and_one_integrator_or_push_is_not(degree: int) -> None:
    lags = np.poly(-np.arange(1.0, degree + 1.0))
    assert is_stable(lags)
    assert is_stable(-lags)
    assert not is_stable(np.append(lags, 0.0))
    assert not is_stable(np.polymul(lags, (1.0, -1e-3)))


@pytest.mark.parametrize(
    "row", [(1.0, 0.0, 1.0), (0.0, 1.0, 1.0), (1.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0), (1.0, 2.0, np.nan)]
)
def test_the_axis_a_vanished_leading_coefficient_and_nan_are_not_stable(row: tuple[float, ...]) -> None:
    assert not is_stable(np.array(row))


def drawn(rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """L_i at 37 frequencies, weights, noise last; all loops are stable but the last: gains k of s^2 + k_0 s + k_1."""
    re, im = rng.normal(size=(2, 2, 37))
    return re, im, rng.random((2, 37)), rng.random((1, 37)), rng.random((4, 37)), rng.random((2, 37))


def test_variances_equal_the_sums_and_unstable_loops_are_infinite(rng: np.random.Generator) -> None:
    re, im, on_s, on_t, on_both, heard = drawn(rng)
    k = np.vstack([rng.random((9, 2)) + 0.1, [-0.5, 1.0]])
    d, n = np.array([1.0, 0.0, 0.0]), np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    peak, out = np.zeros(10), np.empty((10, 4))
    evaluate_loops(k, d, n, np.zeros(10, np.int64), re, im, on_s, on_t, on_both, heard, EMPTY, EMPTY, peak, out)
    L = k @ (re + 1j * im)
    S = np.abs(1.0 / (1.0 + L)) ** 2
    T = np.abs(L) ** 2 * S
    cross = 2.0 * np.real((1.0 / (1.0 + L)) * np.conj(L / (1.0 + L)) * (on_both[2] + 1j * on_both[3]))
    mixed = (S * on_both[0] + T * on_both[1] + cross).sum(axis=1, keepdims=True)
    expected = np.hstack([S @ on_s.T + T @ heard.T, T @ on_t.T, mixed])
    np.testing.assert_allclose(out[:9], expected[:9], rtol=1e-11)
    assert np.all(np.isinf(out[9]))
    assert list(peak) == [0.0] * 9 + [np.inf]


def test_the_peak_of_a_parabola_is_exact_and_of_no_loop_one() -> None:
    u = np.arange(-3.0, 4.0) - 0.37
    z = (0.2 + 0.1j) + (0.3 - 0.2j) * u + (0.1 + 0.15j) * u**2
    d, n = np.array([1.0, 1.0]), np.zeros((1, 2))
    peak, out = np.empty(2), np.empty((2, 0))
    no_rows, one = np.empty((0, 1)), np.zeros((1, 1))
    wide = (z - 1.0)[None]
    evaluate_loops(
        np.array([[1.0], [0.0]]),
        d,
        n,
        np.zeros(2, np.int64),
        one,
        one,
        no_rows,
        no_rows,
        no_rows,
        no_rows,
        wide.real.copy(),
        wide.imag.copy(),
        peak,
        out,
    )
    fine = np.linspace(-1.0, 1.0, 2_000_001)
    least = np.abs((0.2 + 0.1j) + (0.3 - 0.2j) * fine + (0.1 + 0.15j) * fine**2).min()
    assert peak[0] == pytest.approx(1.0 / least, rel=1e-9)
    assert peak[1] == 1.0


def test_slopes_equal_the_complex_step(rng: np.random.Generator) -> None:
    re, im, on_s, on_t, on_both, heard = drawn(rng)
    k, out, h = np.array([0.3, -0.2]), np.empty((4, 2)), 1e-30
    variance_gradients(k, re, im, on_s, on_t, on_both, heard, out)
    for i in range(2):
        moved = k + 1j * h * np.eye(2)[i]
        x, y = 1.0 + moved @ re, moved @ im
        s = 1.0 / (x * x + y * y)
        t = ((x - 1.0) ** 2 + y * y) * s
        mixed = on_both[0] * s + on_both[1] * t + 2.0 * s * ((x - 1.0) * on_both[2] + y * on_both[3])
        sums = np.concatenate([on_s @ s + heard @ t, on_t @ t, [mixed.sum()]])
        np.testing.assert_allclose(out[:, i], sums.imag / h, rtol=1e-10)


def test_peaks_of_the_sensitivity_are_its_largest_maxima_with_their_slopes() -> None:
    w, gains = np.linspace(0.05, 6.0, 40_001), np.array([2.0, 0.7])
    swings = [a / (b**2 - w**2 + 0.05j * b * w) for a, b in ((0.3, 0.8), (0.5, 1.6), (1.0, 3.0), (1.0, 5.0))]
    terms = np.stack([np.sum(swings, axis=0), 1j * w * swings[1]])

    def peaks_and_slopes(k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        peaks, slopes = np.empty(3), np.empty((3, 2))
        sensitivity_peaks(k, np.ascontiguousarray(terms.real), np.ascontiguousarray(terms.imag), peaks, slopes)
        return peaks, slopes

    values = 1.0 / np.abs(1.0 + gains @ terms)
    maxima = values[1:-1][(values[1:-1] > values[:-2]) & (values[1:-1] > values[2:])]
    peaks, slopes = peaks_and_slopes(gains)
    assert len(maxima) > 3
    np.testing.assert_allclose(peaks, np.sort(maxima)[:-4:-1], rtol=1e-4)
    for j, step in enumerate(1e-6 * np.eye(2)):
        differences = (peaks_and_slopes(gains + step)[0] - peaks_and_slopes(gains - step)[0]) / 2e-6
        np.testing.assert_allclose(slopes[:, j], differences, rtol=1e-5, atol=1e-6)
