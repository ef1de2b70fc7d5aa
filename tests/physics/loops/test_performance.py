"""Loops in a sea: against Lyapunov's equation, the complex step, the margins; what is near instability."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.physics.loops.example_loops import FIN, RATE, ROLL, ROWS, SHAPED, lyapunov_variances, second_order

from seatrial.core.values import Array, InputError
from seatrial.physics.loops import (
    Block,
    EncounterSpectrum,
    HullFactor,
    LoopSignal,
    Performance,
    TransferLoop,
    WeightedVariance,
    margins,
    sea_disturbance,
)
from seatrial.physics.loops.encounter_spectrum import disturbance_spectrum
from seatrial.physics.loops.performance import distinct_variances
from seatrial.physics.loops.structures import ROLL as ROLLING
from seatrial.physics.loops.structures import Preamplifier, fin_loop
from seatrial.physics.sea.spectrum import ittc

HULL = HullFactor(100.0, 10.5, 3.4)
UPPER = np.array([100.0, 50.0, 100.0])
READINGS = list(Preamplifier)


def shaped(loop: TransferLoop) -> EncounterSpectrum:
    return disturbance_spectrum(
        lambda w: np.abs(SHAPED.frequency_response(w)) ** 2, 1e-4, 1e4, loop.disturbance, "shaped noise"
    )


def beam() -> EncounterSpectrum:
    return sea_disturbance(ittc(3.3), 9.26, math.pi / 2.0, ROLLING, HULL)


@pytest.fixture(params=READINGS, ids=lambda reading: reading.name.lower())
def loop(request: pytest.FixtureRequest) -> TransferLoop:
    return fin_loop(request.param)


@pytest.fixture
def gains(rng: np.random.Generator) -> Array:
    return rng.random((400, 3)) * UPPER


def test_variances_equal_lyapunov_to_one_in_a_hundred_million(loop: TransferLoop, gains: Array) -> None:
    made = Performance(loop, shaped(loop), ROWS).evaluate(gains)
    robust = np.flatnonzero(made.Ms <= 5.0)
    assert len(robust) > 40
    expected = np.array([lyapunov_variances(loop, gains[i]) for i in robust])
    np.testing.assert_allclose(made.variances[robust], expected, rtol=1e-8)


def test_nodes_that_settle_without_control_resolve_fragile_loops_less_and_less(
    loop: TransferLoop, gains: Array
) -> None:
    made = Performance(loop, shaped(loop), ROWS).evaluate(gains)
    for low, high, limit in ((5.0, 10.0, 1e-7), (10.0, 20.0, 1e-3)):
        of = np.flatnonzero((made.Ms > low) & (made.Ms <= high))
        expected = np.array([lyapunov_variances(loop, gains[i]) for i in of])
        np.testing.assert_allclose(made.variances[of], expected, rtol=limit)
    assert np.any(made.Ms[np.isfinite(made.Ms)] > 20.0)


def test_nodes_that_settle_under_control_resolve_any_loop(loop: TransferLoop, gains: Array) -> None:
    made = Performance(loop, shaped(loop), ROWS).evaluate(gains)
    fragile = np.flatnonzero((made.Ms > 50.0) & (made.Ms < 150.0))[:3]
    assert fragile.size
    for i in fragile:
        own = loop.with_gains(gains[i])
        d, n = own.polynomials
        num, den = np.polymul(own.disturbance.num, d), np.polymul(own.disturbance.den, d + own.gain_values @ n)
        controlled = Block("controlled", tuple(num), tuple(den))
        fine = disturbance_spectrum(
            lambda w: np.abs(SHAPED.frequency_response(w)) ** 2, 1e-4, 1e4, controlled, "shaped noise"
        )
        found = Performance(own, fine, ROWS).evaluate(gains[i]).variances[0]
        np.testing.assert_allclose(found, lyapunov_variances(loop, gains[i]), rtol=1e-6)


def test_a_stable_loop_is_one_whose_poles_lie_left(loop: TransferLoop, gains: Array) -> None:
    made = Performance(loop, beam(), ROWS)
    found, quick = made.evaluate(gains), made.evaluate(gains, with_Ms=False)
    right = np.array([np.any(loop.with_gains(k).closed_loop_poles.real > 0.0) for k in gains])
    np.testing.assert_array_equal(np.isinf(found.Ms), right)
    np.testing.assert_array_equal(np.isinf(found.variances), np.repeat(right[:, None], 3, axis=1))
    np.testing.assert_array_equal(found.variances, quick.variances)
    np.testing.assert_array_equal(quick.Ms, np.where(right, np.inf, 0.0))


def test_the_peak_is_that_of_the_margins_within_half_a_per_cent(loop: TransferLoop, gains: Array) -> None:
    peaks = Performance(loop, beam(), ROWS).evaluate(gains).Ms
    some = np.flatnonzero(peaks <= 20.0)[::10]
    expected = [margins(loop.with_gains(gains[i])).Ms for i in some]
    np.testing.assert_allclose(peaks[some], expected, rtol=5e-3)


def test_the_peak_is_found_beyond_all_open_poles() -> None:
    loop = second_order(0.1)
    sea = disturbance_spectrum(lambda w: np.exp(-(np.log(w) ** 2)), 1e-2, 1e2, loop.disturbance, "some noise")
    peaks = Performance(loop, sea, ROWS).evaluate(np.array([[0.3], [1.0], [4.0]])).Ms
    expected = [margins(loop.with_gains(np.array([k]))).Ms for k in (0.3, 1.0, 4.0)]
    np.testing.assert_allclose(peaks, expected, rtol=0.02)


def test_without_gain_the_loop_does_what_the_sea_does(loop: TransferLoop) -> None:
    made = Performance(loop, beam(), ROWS)
    found = made.evaluate(np.zeros(3))
    np.testing.assert_allclose(found.variances[0], made.uncontrolled_variances, rtol=1e-12)
    assert found.Ms[0] == 1.0
    assert made.uncontrolled_variances[0] == pytest.approx(made.spectrum.response_variance(loop.disturbance), rel=1e-12)


def test_slopes_equal_the_complex_step(loop: TransferLoop) -> None:
    made, k, h = Performance(loop, beam(), ROWS), np.array([11.0, 0.4, 32.0]), 1e-30
    w = made.spectrum.omega_e
    terms = loop.open_loop_terms(w)
    free = np.abs(loop.disturbance.frequency_response(w)) ** 2 * made.spectrum.energy
    moved = free / np.abs(loop.plant.frequency_response(w)) ** 2
    slopes = made.variance_gradients(k)
    for i in range(3):
        stepped = k + 1j * h * np.eye(3)[i]
        x, y = 1.0 + stepped @ terms.real, stepped @ terms.imag
        s = 1.0 / (x * x + y * y)
        t = ((x - 1.0) ** 2 + y * y) * s
        expected = np.array([(s * free).sum(), (t * moved).sum(), (t * w**2 * moved).sum()]).imag / h
        np.testing.assert_allclose(slopes[:, i], expected, rtol=1e-9)


def test_slopes_equal_differences_of_the_evaluation(loop: TransferLoop) -> None:
    made, k, h = Performance(loop, beam(), ROWS), np.array([11.0, 0.4, 32.0]), 1e-4
    steps = np.concatenate([k + h * np.eye(3), k - h * np.eye(3)])
    v = made.evaluate(steps).variances
    np.testing.assert_allclose(made.variance_gradients(k), ((v[:3] - v[3:]) / (2.0 * h)).T, rtol=1e-6)


def test_the_slope_of_the_peak_equals_differences(loop: TransferLoop) -> None:
    made, h = Performance(loop, beam(), ROWS), 1e-4
    for k in (np.array([11.0, 0.4, 32.0]), np.array([4.0, 1.0, 12.0])):
        peaks = made.evaluate(np.concatenate([k + h * np.eye(3), k - h * np.eye(3)])).Ms
        np.testing.assert_allclose(
            made.sensitivity_peaks(k)[1][0], (peaks[:3] - peaks[3:]) / (2.0 * h), rtol=1e-5, atol=1e-9
        )


def test_rows_in_the_wrong_order_are_refused(loop: TransferLoop) -> None:
    rows = (WeightedVariance(LoopSignal.ACTUATOR, np.ones_like), WeightedVariance(LoopSignal.OUTPUT, np.ones_like))
    with pytest.raises(InputError, match="rows on the output must precede"):
        Performance(loop, beam(), rows)


def test_an_actuator_that_moves_nothing_is_refused() -> None:
    with pytest.raises(InputError, match=r"the actuator alpha_f of loop 'fin washout' does not move phi at .* at rest"):
        Performance(fin_loop(K_alpha=0.0), beam(), ROWS)


def test_gains_of_another_number_are_refused(loop: TransferLoop) -> None:
    with pytest.raises(InputError, match="has 3 gains, not 2"):
        Performance(loop, beam(), ROWS).evaluate(np.ones((5, 2)))


def test_gains_that_are_no_numbers_are_not_stable(loop: TransferLoop) -> None:
    found = Performance(loop, beam(), ROWS).evaluate(np.array([[1.0, np.nan, 1.0]]))
    assert np.isinf(found.Ms[0]) and np.all(np.isinf(found.variances))


def test_objectives_find_their_own_rows() -> None:
    rows, places = distinct_variances((RATE, ROLL, FIN))
    assert [row.signal for row in rows] == [LoopSignal.OUTPUT, LoopSignal.ACTUATOR, LoopSignal.ACTUATOR]
    assert [rows[place[0]] for place in places] == [RATE.variances[0], ROLL.variances[0], FIN.variances[0]]


def test_a_disturbance_with_poles_of_its_own_has_variances_by_lyapunov_too(rng: np.random.Generator) -> None:
    loop = replace(fin_loop(), disturbance=replace(ROLLING, den=(2.0, 0.9, 1.0)))
    gains = rng.random((20, 3)) * 0.3 * UPPER
    made = Performance(loop, shaped(loop), ROWS).evaluate(gains)
    robust = np.flatnonzero(made.Ms <= 5.0)
    assert robust.size
    expected = np.array([lyapunov_variances(loop, gains[i]) for i in robust])
    np.testing.assert_allclose(made.variances[robust], expected, rtol=1e-8)
