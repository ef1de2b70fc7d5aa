"""The step in which numbers were written."""

import numpy as np
import pytest

from seatrial.numerics.resolution import local_resolution, resolution


@pytest.mark.parametrize("step", [1.0, 0.25, 0.1, 1e-3, np.radians(0.1), 1.0 / 3600.0])
def test_rounded_noise_has_the_step_it_was_rounded_to(step: float, rng: np.random.Generator) -> None:
    values = step * np.round(40.0 * rng.normal(size=400)) + 0.3 * step
    assert resolution(values) == pytest.approx(step, rel=1e-6)


def test_stamps_of_whole_seconds_and_of_milliseconds_are_seen(rng: np.random.Generator) -> None:
    time = 1.7e9 + np.cumsum(0.2 + 0.01 * rng.normal(size=500))
    assert resolution(np.floor(time)) == pytest.approx(1.0)
    assert resolution(np.round(time, 3)) == pytest.approx(1e-3, rel=1e-2)


def test_values_further_apart_than_a_step_still_show_it() -> None:
    assert resolution(np.array([0.0, 2.0, 5.0, 10.0, 13.0])) == pytest.approx(1.0)


def test_values_with_all_digits_have_none(rng: np.random.Generator) -> None:
    assert resolution(rng.normal(size=300)) == 0.0
    assert resolution(np.full(5, 3.2)) == resolution(np.array([0.1, 0.4, 0.4])) == 0.0
    assert resolution(np.array([np.nan, 1.0])) == 0.0


def test_a_few_interpolated_values_do_not_hide_it(rng: np.random.Generator) -> None:
    values = 0.5 * np.round(20.0 * rng.normal(size=400))
    values[7] = values[6] + 0.17
    assert resolution(values) == pytest.approx(0.5)


def test_the_step_of_numbers_of_three_digits_grows_with_them(rng: np.random.Generator) -> None:
    values = np.array([float(f"{value:.3g}") for value in np.linspace(0.1, 900.0, 20000)])
    steps = local_resolution(values)
    for low, high, step in ((2.0, 9.0, 0.01), (20.0, 90.0, 0.1), (200.0, 800.0, 1.0)):
        inside = (values > low) & (values < high)
        assert np.median(steps[inside]) == pytest.approx(step, rel=0.01) or step == 0.01
    degrees = np.radians(np.round(rng.normal(size=3000) * 20.0))
    np.testing.assert_allclose(local_resolution(degrees), np.radians(1.0), rtol=1e-6)
    noise = rng.normal(size=3000)
    assert np.median(local_resolution(noise)) < 1e-3 * np.median(np.abs(np.diff(noise)))
    assert np.isnan(local_resolution(np.array([np.nan, 1.0]))[0]) and not local_resolution(np.full(3, 2.0)).any()


def test_a_step_finer_than_the_least_that_counts_may_be_left_out(rng: np.random.Generator) -> None:
    for size, digits in ((30, 2), (400, 3), (3000, 1)):  # steps in one go, and one by one
        values = np.round(np.cumsum(rng.normal(size=size)), digits)
        step = resolution(values)
        assert step > 0.0
        assert resolution(values, least=0.5 * step) == step
        assert max(resolution(values, least=50.0), 50.0) == 50.0
