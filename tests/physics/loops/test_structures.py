"""Richer controllers: what their blocks do, that the loop stays linear in its gains, what five gains are worth."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import InputError, Parameter
from seatrial.physics.loops import (
    EncounterSpectrum,
    HullFactor,
    LoopSignal,
    Performance,
    Term,
    WeightedVariance,
    margins,
    sea_disturbance,
)
from seatrial.physics.loops.structures import (
    ROLL,
    Preamplifier,
    band_pass,
    fin_loop,
    five_gain_loop,
    high_pass,
    low_pass,
    notch,
    with_filters,
    with_terms,
)
from seatrial.physics.sea.spectrum import ittc, jonswap

U, HULL = 18.0 * 1852.0 / 3600.0, HullFactor(100.0, 10.5, 3.4)
ROWS = (WeightedVariance(LoopSignal.OUTPUT, np.ones_like), WeightedVariance(LoopSignal.ACTUATOR, lambda w: w))
frequencies, dampings = st.floats(0.05, 20.0), st.floats(0.05, 2.0)


@given(frequencies, dampings)
def test_a_band_pass_is_one_in_its_middle_and_half_the_power_over_its_width(omega: float, damping: float) -> None:
    block = band_pass(omega, damping)
    assert block.frequency_response(np.array([omega]))[0] == pytest.approx(1.0, abs=1e-12)
    edges = omega * (np.array([-1.0, 1.0]) * damping + math.sqrt(1.0 + damping**2))
    assert np.abs(block.frequency_response(edges)) ** 2 == pytest.approx(0.5, rel=1e-9)
    assert edges[1] - edges[0] == pytest.approx(2.0 * damping * omega)


def test_low_band_and_high_pass_of_one_frequency_and_damping_add_up_to_one() -> None:
    omega = np.geomspace(0.1, 10.0, 50)
    parts = [create(1.3, 0.4).frequency_response(omega) for create in (low_pass, band_pass, high_pass)]
    np.testing.assert_allclose(np.sum(parts, axis=0), 1.0, rtol=1e-13)


@given(frequencies, dampings)
def test_a_low_pass_passes_at_rest_and_turns_by_a_quarter_at_its_frequency(omega: float, damping: float) -> None:
    block = low_pass(omega, damping)
    assert block.gain == pytest.approx(1.0)
    assert block.frequency_response(np.array([omega]))[0] == pytest.approx(-0.5j / damping, rel=1e-9)


@given(frequencies, dampings, st.floats(0.0, 0.9))
def test_a_notch_leaves_its_depth_and_nothing_else(omega: float, damping: float, depth: float) -> None:
    block = notch(omega, damping, depth)
    assert block.frequency_response(np.array([omega]))[0] == pytest.approx(depth, abs=1e-9)
    assert np.abs(block.frequency_response(np.array([1e-6 * omega, 1e6 * omega]))) == pytest.approx(1.0, abs=1e-4)


def test_added_terms_at_zero_change_nothing() -> None:
    loop = fin_loop()
    gain = Parameter("KX", 0.0, "1", -1.0, 1.0, free=True)
    richer = with_terms(loop, Term("KX", band_pass(0.8, 0.2)), gains=(gain,))
    omega = np.geomspace(0.01, 100.0, 50)
    assert richer.open_loop(omega) == pytest.approx(loop.open_loop(omega), rel=1e-12)
    assert richer.gains.names == ("KP", "KI", "KD", "KX")


def test_a_common_notch_multiplies_the_open_loop() -> None:
    loop, block, omega = fin_loop(), notch(2.0, 0.5, 0.1), np.geomspace(0.01, 100.0, 50)
    assert with_filters(loop, block).open_loop(omega) == pytest.approx(
        loop.open_loop(omega) * block.frequency_response(omega), rel=1e-12
    )


@cache
def seas() -> dict[str, EncounterSpectrum]:
    beam, peak = math.pi / 2.0, 2.0 * math.pi / ittc(3.3).modal_frequency
    return {
        "ITTC": sea_disturbance(ittc(3.3), U, beam, ROLL, HULL),
        "JONSWAP": sea_disturbance(jonswap(3.3, peak), U, beam, ROLL, HULL),
        "short-crested": sea_disturbance(ittc(3.3), U, beam, ROLL, HULL, spreading=1.0),
    }


@pytest.mark.parametrize("name", ["ITTC", "JONSWAP", "short-crested"])
def test_five_gains_roll_a_third_less_at_no_more_fin_rate(name: str) -> None:
    published, richer, sea = fin_loop(), five_gain_loop(fin_loop()), seas()[name]
    theirs = Performance(published, sea, ROWS).evaluate(published.gain_values).variances[0]
    ours = Performance(richer, sea, ROWS).evaluate(richer.gain_values).variances[0]
    assert ours[0] <= 0.66 * theirs[0]
    assert ours[1] <= theirs[1]


def test_five_gains_keep_their_margins() -> None:
    made = margins(five_gain_loop(fin_loop()))
    assert made.is_stable
    assert made.Ms <= 1.9
    assert made.gain > 2.0
    assert made.phase > math.radians(30.0)


def test_where_the_gains_found_do_not_suit_the_loop_keeps_its_own() -> None:
    loop = fin_loop(Preamplifier.PRINTED)
    richer = five_gain_loop(loop)
    assert richer.gain_values == pytest.approx([*loop.gain_values, 0.0, 0.0])
    assert margins(richer).Ms == pytest.approx(margins(loop).Ms, rel=1e-6)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: band_pass(0.0, 0.5), "band-pass: the frequency must be positive, not 0"),
        (lambda: low_pass(1.0, -1.0), "low-pass: the damping must be positive, not -1"),
        (lambda: notch(1.0, 0.5, 1.0), "from 0 to below 1, not 1"),
        (lambda: five_gain_loop(five_gain_loop(fin_loop())), "has a gain 'KB' already"),
        (lambda: with_terms(fin_loop(), Term("KX", low_pass(1.0)), gains=()), "one gain for each term"),
    ],
)  # fmt: skip
def test_refused(make, says: str) -> None:
    with pytest.raises(InputError, match=says):
        make()
