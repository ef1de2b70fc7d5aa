"""The published fin stabiliser: constants as printed, both readings, the calibration that is ours."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.physics.loops.example_loops import ROWS

from seatrial.physics.loops import HullFactor, Performance, TransferLoop, margins, sea_disturbance
from seatrial.physics.loops.structures import (
    DERIVATIVE,
    GYRO,
    INTEGRAL,
    K_ALPHA,
    ROLL,
    SERVO,
    K_alpha_at,
    Preamplifier,
    fin_loop,
    published_gains,
)
from seatrial.physics.sea.spectrum import ittc

S = 1j * np.geomspace(1e-2, 50.0, 30)
OMEGA = S.imag
KNOT = 1852.0 / 3600.0


def reduction(loop: TransferLoop) -> float:
    """Of the rms roll at 18 kn in beam seas of 3.3 m, per cent."""
    sea = sea_disturbance(ittc(3.3), 18.0 * KNOT, math.pi / 2.0, ROLL, HullFactor(100.0, 10.5, 3.4))
    made = Performance(loop, sea, ROWS)
    return 100.0 * (1.0 - math.sqrt(made.evaluate(loop.gain_values).variances[0, 0] / made.uncontrolled_variances[0]))


def test_blocks_are_those_printed() -> None:
    np.testing.assert_allclose(GYRO.frequency_response(OMEGA), 400.0 * S / (S**2 + 80.0 * S + 4000.0), rtol=1e-12)
    np.testing.assert_allclose(SERVO.frequency_response(OMEGA), 550.0 / (S**2 + 15.0 * S + 225.0), rtol=1e-12)
    np.testing.assert_allclose(ROLL.frequency_response(OMEGA), 1.0 / (1.43242 * S**2 + 0.3796 * S + 1.0), rtol=1e-12)
    np.testing.assert_allclose(
        DERIVATIVE.frequency_response(OMEGA), 0.064 * S / ((0.064 * S + 1.0) * (0.18 * S + 1.0)), rtol=1e-12
    )
    np.testing.assert_allclose(INTEGRAL.frequency_response(OMEGA), 1.0 / (24.607 * S + 1.0), rtol=1e-12)
    assert SERVO.gain == pytest.approx(2.444, abs=5e-4)


def test_roll_has_the_period_and_damping_stated() -> None:
    assert 2.0 * math.pi / abs(ROLL.poles[0]) == pytest.approx(7.52, abs=5e-3)
    assert -ROLL.poles[0].real / abs(ROLL.poles[0]) == pytest.approx(0.159, abs=5e-4)


def test_both_readings_share_their_lags() -> None:
    lag = (30.0 * S + 1.0) * (0.056 * S + 1.0)
    np.testing.assert_allclose(Preamplifier.PRINTED.block(7.0).frequency_response(OMEGA), 7.0 / lag, rtol=1e-12)
    np.testing.assert_allclose(Preamplifier.WASHOUT.block(7.0).frequency_response(OMEGA), 210.0 * S / lag, rtol=1e-12)


@pytest.mark.parametrize("reading", list(Preamplifier), ids=lambda reading: reading.name.lower())
def test_the_open_loop_is_the_product_of_the_diagram(reading: Preamplifier) -> None:
    loop = fin_loop(reading)
    controller = 11.053 + 0.428 * INTEGRAL.frequency_response(OMEGA) + 32.736 * DERIVATIVE.frequency_response(OMEGA)
    expected = (
        0.256
        * SERVO.frequency_response(OMEGA)
        * controller
        * reading.block().frequency_response(OMEGA)
        * GYRO.frequency_response(OMEGA)
        * ROLL.frequency_response(OMEGA)
    )
    np.testing.assert_allclose(loop.open_loop(OMEGA), expected, rtol=1e-11)


@pytest.mark.parametrize(("reading", "digits"), [(Preamplifier.PRINTED, 0), (Preamplifier.WASHOUT, 2)])
def test_the_calibrated_gain_is_the_root_in_the_digits_given(reading: Preamplifier, digits: int) -> None:
    root = brentq(
        lambda log_K: reduction(fin_loop(reading, K_q=math.exp(log_K))) - 75.92,
        math.log(0.7 * reading.value), math.log(1.4 * reading.value), xtol=1e-10,
    )  # fmt: skip
    assert round(math.exp(float(root)), digits) == reading.value  # type: ignore[arg-type]


def test_margins_of_the_paper_s_gains() -> None:
    assert margins(fin_loop(Preamplifier.PRINTED)).Ms == pytest.approx(5.45, abs=0.03)
    assert margins(fin_loop(Preamplifier.WASHOUT)).Ms == pytest.approx(1.32, abs=5e-3)


def test_gains_are_free_within_the_box_searched() -> None:
    gains = published_gains()
    assert [(p.name, p.value, p.lower, p.upper) for p in gains.free] == [
        ("KP", 11.053, 0.0, 100.0),
        ("KI", 0.428, 0.0, 50.0),
        ("KD", 32.736, 0.0, 100.0),
    ]


def test_the_fins_act_with_the_square_of_the_speed() -> None:
    assert K_alpha_at(22.0, 18.0) == pytest.approx(K_ALPHA * (22.0 / 18.0) ** 2, rel=1e-14)
    assert fin_loop(K_alpha=0.5).plant.gain == pytest.approx(0.5)
    np.testing.assert_allclose(
        fin_loop(K_alpha=0.5).disturbance.frequency_response(OMEGA), ROLL.frequency_response(OMEGA)
    )
