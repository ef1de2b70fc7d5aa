"""Loops in a sea: against Lyapunov's equation, the complex step, the margins; what is near instability."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.physics.loops.loops_at_hand import FIN, RATE, ROLL, ROWS, SHAPED, by_lyapunov, second_order

from seatrial.core.values import Array, InputError
from seatrial.physics.loops import Exposure, HullFactor, Performance, Row, Seen, TransferLoop, exposure, margins
from seatrial.physics.loops.exposure import over_nodes
from seatrial.physics.loops.fin import ROLL as ROLLING
from seatrial.physics.loops.fin import Preamplifier, fin_loop
from seatrial.physics.loops.performance import rows_of
from seatrial.physics.sea.spectrum import ittc

HULL = HullFactor(100.0, 10.5, 3.4)
UPPER = np.array([100.0, 50.0, 100.0])
READINGS = list(Preamplifier)


def shaped(loop: TransferLoop) -> Exposure:
    return over_nodes(lambda w: np.abs(SHAPED.at(w)) ** 2, 1e-4, 1e4, loop.disturbance, "shaped noise")


def beam() -> Exposure:
    return exposure(ittc(3.3), 9.26, math.pi / 2.0, ROLLING, HULL)


@pytest.fixture(params=READINGS, ids=lambda reading: reading.name.lower())
def loop(request: pytest.FixtureRequest) -> TransferLoop:
    return fin_loop(request.param)


@pytest.fixture
def gains(rng: np.random.Generator) -> Array:
    return rng.random((400, 3)) * UPPER


def test_variances_equal_lyapunov_to_one_in_a_hundred_million(loop: TransferLoop, gains: Array) -> None:
    made = Performance(loop, shaped(loop), ROWS).of(gains)
    robust = np.flatnonzero(made.peak <= 5.0)
    assert len(robust) > 40
    expected = np.array([by_lyapunov(loop, gains[i]) for i in robust])
    np.testing.assert_allclose(made.variances[robust], expected, rtol=1e-8)


def test_nodes_that_settle_without_control_resolve_fragile_loops_less_and_less(
    loop: TransferLoop, gains: Array
) -> None:
    made = Performance(loop, shaped(loop), ROWS).of(gains)
    for low, high, limit in ((5.0, 10.0, 1e-7), (10.0, 20.0, 1e-3)):
        of = np.flatnonzero((made.peak > low) & (made.peak <= high))
        expected = np.array([by_lyapunov(loop, gains[i]) for i in of])
        np.testing.assert_allclose(made.variances[of], expected, rtol=limit)
    assert np.any(made.peak[np.isfinite(made.peak)] > 20.0)


def test_nodes_that_settle_under_control_resolve_any_loop(loop: TransferLoop, gains: Array) -> None:
    made = Performance(loop, shaped(loop), ROWS).of(gains)
    fragile = np.flatnonzero((made.peak > 50.0) & (made.peak < 150.0))[:3]
    assert fragile.size
    for i in fragile:
        own = loop.with_gains(gains[i])
        fine = over_nodes(lambda w: np.abs(SHAPED.at(w)) ** 2, 1e-4, 1e4, own.controlled, "shaped noise")
        found = Performance(own, fine, ROWS).of(gains[i]).variances[0]
        np.testing.assert_allclose(found, by_lyapunov(loop, gains[i]), rtol=1e-6)


def test_a_stable_loop_is_one_whose_poles_lie_left(loop: TransferLoop, gains: Array) -> None:
    made = Performance(loop, beam(), ROWS)
    found, quick = made.of(gains), made.of(gains, with_peak=False)
    right = np.array([np.any(loop.with_gains(k).closed_poles.real > 0.0) for k in gains])
    np.testing.assert_array_equal(np.isinf(found.peak), right)
    np.testing.assert_array_equal(np.isinf(found.variances), np.repeat(right[:, None], 3, axis=1))
    np.testing.assert_array_equal(found.variances, quick.variances)
    np.testing.assert_array_equal(quick.peak, np.where(right, np.inf, 0.0))


def test_the_peak_is_that_of_the_margins_within_half_a_per_cent(loop: TransferLoop, gains: Array) -> None:
    peaks = Performance(loop, beam(), ROWS).of(gains).peak
    some = np.flatnonzero(peaks <= 20.0)[::10]
    expected = [margins(loop.with_gains(gains[i])).peak for i in some]
    np.testing.assert_allclose(peaks[some], expected, rtol=5e-3)


def test_the_peak_is_found_beyond_all_open_poles() -> None:
    loop = second_order(0.1)
    sea = over_nodes(lambda w: np.exp(-(np.log(w) ** 2)), 1e-2, 1e2, loop.disturbance, "some noise")
    peaks = Performance(loop, sea, ROWS).of(np.array([[0.3], [1.0], [4.0]])).peak
    expected = [margins(loop.with_gains(np.array([k]))).peak for k in (0.3, 1.0, 4.0)]
    np.testing.assert_allclose(peaks, expected, rtol=0.02)


def test_without_gain_the_loop_does_what_the_sea_does(loop: TransferLoop) -> None:
    made = Performance(loop, beam(), ROWS)
    found = made.of(np.zeros(3))
    np.testing.assert_allclose(found.variances[0], made.uncontrolled, rtol=1e-12)
    assert found.peak[0] == 1.0
    assert made.uncontrolled[0] == pytest.approx(made.exposure.variance_of(loop.disturbance), rel=1e-12)


def test_slopes_equal_the_complex_step(loop: TransferLoop) -> None:
    made, k, h = Performance(loop, beam(), ROWS), np.array([11.0, 0.4, 32.0]), 1e-30
    w = made.exposure.omega_e
    terms = loop.open_terms(w)
    free = np.abs(loop.disturbance.at(w)) ** 2 * made.exposure.energy
    moved = free / np.abs(loop.plant.at(w)) ** 2
    slopes = made.slopes(k)
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
    v = made.of(steps).variances
    np.testing.assert_allclose(made.slopes(k), ((v[:3] - v[3:]) / (2.0 * h)).T, rtol=1e-6)


def test_the_slope_of_the_peak_equals_differences(loop: TransferLoop) -> None:
    made, h = Performance(loop, beam(), ROWS), 1e-4
    for k in (np.array([11.0, 0.4, 32.0]), np.array([4.0, 1.0, 12.0])):
        peaks = made.of(np.concatenate([k + h * np.eye(3), k - h * np.eye(3)])).peak
        np.testing.assert_allclose(made.peak_slope(k), (peaks[:3] - peaks[3:]) / (2.0 * h), rtol=1e-5, atol=1e-9)


def test_rows_in_the_wrong_order_are_refused(loop: TransferLoop) -> None:
    rows = (Row(Seen.ACTUATOR, np.ones_like), Row(Seen.OUTPUT, np.ones_like))
    with pytest.raises(InputError, match="rows on the output must precede"):
        Performance(loop, beam(), rows)


def test_an_actuator_that_moves_nothing_is_refused() -> None:
    with pytest.raises(InputError, match=r"the actuator alpha_f of loop 'fin washout' does not move phi at .* at rest"):
        Performance(fin_loop(K_alpha=0.0), beam(), ROWS)


def test_gains_of_another_number_are_refused(loop: TransferLoop) -> None:
    with pytest.raises(InputError, match="has 3 gains, not 2"):
        Performance(loop, beam(), ROWS).of(np.ones((5, 2)))


def test_gains_that_are_no_numbers_are_not_stable(loop: TransferLoop) -> None:
    found = Performance(loop, beam(), ROWS).of(np.array([[1.0, np.nan, 1.0]]))
    assert np.isinf(found.peak[0]) and np.all(np.isinf(found.variances))


def test_objectives_find_their_own_rows() -> None:
    rows, places = rows_of((RATE, ROLL, FIN))
    assert [row.seen for row in rows] == [Seen.OUTPUT, Seen.ACTUATOR, Seen.ACTUATOR]
    assert [rows[place[0]] for place in places] == [RATE.rows[0], ROLL.rows[0], FIN.rows[0]]


def test_a_disturbance_with_poles_of_its_own_has_variances_by_lyapunov_too(rng: np.random.Generator) -> None:
    loop = replace(fin_loop(), disturbance=replace(ROLLING, den=(2.0, 0.9, 1.0)))
    gains = rng.random((20, 3)) * 0.3 * UPPER
    made = Performance(loop, shaped(loop), ROWS).of(gains)
    robust = np.flatnonzero(made.peak <= 5.0)
    assert robust.size
    expected = np.array([by_lyapunov(loop, gains[i]) for i in robust])
    np.testing.assert_allclose(made.variances[robust], expected, rtol=1e-8)
