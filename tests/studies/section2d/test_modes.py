"""One motion over many periods: truth comes back, errors are honest, too few periods are refused."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial_studies.section2d.modes import MeasuredResponse, Oscillator, SectionTheory, fit_oscillator

TRUE = Oscillator(46.8, 2300.0, gain=1.15, delay=-0.02, distance=0.03, extra_added_mass=-2.0, quadratic_damping=200.0)
FREE = ("gain", "delay", "distance", "extra_added_mass", "quadratic_damping")
SCALES = {"delay": 0.02, "distance": 0.02, "extra_added_mass": 2.0, "quadratic_damping": 100.0}
START = replace(TRUE, gain=1.0, delay=0.0, distance=0.0, extra_added_mass=0.0, quadratic_damping=50.0)


def observed(omega: float, error: complex = 0.0, wave: float = 0.012) -> MeasuredResponse:
    theory = SectionTheory(
        35.0 + 2.0 * (omega - 5.5) ** 2, 80.0 - 20.0 * (omega - 5.5), 900.0 - 200.0 * (omega - 5.5) + 300.0j
    )
    one = MeasuredResponse(omega, omega**2 / 9.81, wave, 1.0, 0.005, theory)
    return replace(one, response=TRUE.measured_response(one) * (1.0 + error))


OMEGAS = (4.9, 5.2, 5.4, 5.9, 7.0, 7.8)


def test_the_truth_comes_back_without_noise() -> None:
    found = fit_oscillator(START, [observed(w) for w in OMEGAS], FREE, SCALES)
    assert [getattr(found.oscillator, n) for n in FREE] == pytest.approx([getattr(TRUE, n) for n in FREE], rel=1e-5)
    assert found.misfit < 1e-6


def test_the_errors_stated_are_those_made(rng: np.random.Generator) -> None:
    fits = [
        fit_oscillator(START, [observed(w, 0.005 * complex(*rng.standard_normal(2))) for w in OMEGAS], FREE, SCALES)
        for _ in range(60)
    ]
    for name in ("extra_added_mass", "quadratic_damping", "gain"):
        made = np.std([getattr(f.oscillator, name) for f in fits])
        stated = np.sqrt(np.mean([f.errors[name] ** 2 for f in fits]))
        assert stated == pytest.approx(made, rel=0.35)


def test_quadratic_damping_bites_more_in_higher_waves_and_not_in_none() -> None:
    one = observed(5.4)
    linear = replace(TRUE, quadratic_damping=0.0)
    sizes = [abs(TRUE.motion_response(one.theory, 5.4, a)) for a in (1e-9, 0.006, 0.012, 0.024)]
    assert sizes[0] == pytest.approx(abs(linear.motion_response(one.theory, 5.4, 0.012)), rel=1e-6)
    assert sizes == sorted(sizes, reverse=True)


def test_the_amplitude_balances_the_equivalent_damping() -> None:
    one = observed(5.4)
    z = TRUE.motion_response(one.theory, 5.4, 0.012)
    damping = one.theory.damping + TRUE.extra_equivalent_damping(one.theory, 5.4, 0.012)
    spring = 2300.0 - 5.4**2 * (46.8 + one.theory.added_mass - 2.0)
    assert z * (spring + 5.4j * damping) == pytest.approx(one.theory.excitation, rel=1e-8)


def test_more_unknowns_than_periods_give_is_refused() -> None:
    with pytest.raises(InputError, match="cannot be identified from 2 wave periods"):
        fit_oscillator(START, [observed(5.0), observed(6.0)], FREE)
    with pytest.raises(InputError, match="has no 'mass'"):
        fit_oscillator(START, [observed(5.0)], ("mass",))
