"""All estimators through one door: without noise they find the craft, and noise tells them apart."""

import numpy as np
import pytest
from tests.estimation.regress.linear import zigzags

from seatrial.core.values import InputError
from seatrial.data.example_series import with_sensor_noise
from seatrial.estimation.regress.pipeline import standard_estimators
from seatrial.physics.models.waterjet import TABLE_2, waterjet

TRUE = np.array(list(TABLE_2.values()))
BLANK = waterjet().with_values(dict.fromkeys(TABLE_2, 0.0))


def errors(name: str, seed: int | None) -> np.ndarray:
    """Relative errors of one estimator on the zigzags, with sensor noise where a seed is given."""
    record = zigzags() if seed is None else with_sensor_noise(zigzags(), np.random.default_rng(seed), seed)
    (estimator,) = [e for e in standard_estimators(20.0) if e.name == name]
    return np.abs(estimator.estimate(BLANK, [record]).values / TRUE - 1.0)


@pytest.mark.parametrize(
    "name",
    [
        "central differences, least squares",
        "central differences, ridge",
        "weak form, least squares",
        "weak form, instrumental variables",
    ],
)
def test_without_noise_methods_of_second_order_are_near(name: str) -> None:
    """No coefficient more than .4 % off in 415 s; the whole series of 2075 s is the benchmark's."""
    assert errors(name, None).max() < 0.004


def test_euler_differences_cost_a_tenth_even_without_noise() -> None:
    """First order in the step of .1 s."""
    assert errors("Euler differences, least squares", None).max() > 0.1


def test_differencing_makes_noise_fatal() -> None:
    """Coefficients hundreds of per cent off, where the weak form is near."""
    assert np.median(errors("Euler, differenced and centred", 1)) > 5.0
    assert np.median(errors("weak form, least squares", 1)) < 0.6


def test_names_are_stated_apart_and_a_hidden_state_is_refused() -> None:
    """One row a name; the craft without its sway velocity, heading and position cannot be regressed."""
    names = [e.name for e in standard_estimators(20.0)]
    assert len(set(names)) == len(names)
    with pytest.raises(InputError, match="neither holds nor implies 'v'"):
        standard_estimators(20.0)[0].estimate(BLANK, [zigzags().without("v", "x0", "y0")])
