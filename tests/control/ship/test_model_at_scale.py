"""A model at another scale moves as the same one, in times that are longer by the root of the ratio."""

from dataclasses import replace

import numpy as np
import pytest
from tests.control.loop_files import heave_and_pitch

from seatrial.control.ship import model_at_scale
from seatrial.core.values import InputError, Ship
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.models.published import kvlcc2, kvlcc2_full

RATIO = 45.7


def accelerations(file: ModelFile, states: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    rates = np.empty(len(file.model.states))
    file.model.compiled.rates(0.0, states, inputs, file.model.parameters.values, rates)
    return rates


def test_a_tanker_of_dimensionless_coefficients_turns_as_its_model() -> None:
    """u' is the same at both sizes, r' over the ratio, both Froude scaled."""
    small = ModelFile(kvlcc2(), ship=Ship("model", {"L": 7.0, "B": 1.27, "x_R_prime": -0.5}), approach={"u": 1.2})
    large = model_at_scale(small, RATIO)
    names, inputs = large.model.states, large.model.input_names
    size = {"u": 0.5, "v": 0.5, "r": -0.5, "x0": 1.0, "y0": 1.0}
    x = np.array([{"u": 1.1, "v": -0.1, "r": 0.05, "psi": 0.3}.get(name, 0.0) for name in names])
    u = np.array([{"delta": 0.2, "n": 10.0}.get(name, 0.0) for name in inputs])
    grown = x * RATIO ** np.array([size.get(name, 0.0) for name in names])
    slowed = u * RATIO ** np.array([-0.5 if name == "n" else 0.0 for name in inputs])
    one, other = accelerations(small, x, u), accelerations(large, grown, slowed)
    wanted = one * RATIO ** np.array([size.get(name, 0.0) - 0.5 for name in names])
    np.testing.assert_allclose(other, wanted, rtol=1e-9, atol=1e-15)
    assert large.ship is not None
    assert large.ship.length == pytest.approx(kvlcc2_full().ship.length, rel=1e-3)
    assert large.ship.particulars["B"] == pytest.approx(1.27 * RATIO)
    assert large.approach["u"] == pytest.approx(1.2 * RATIO**0.5)


def test_covariances_of_dimensional_coefficients_grow_with_them() -> None:
    model = heave_and_pitch()
    file = ModelFile(model, covariance=np.eye(len(model.parameters.free_names)))
    large = model_at_scale(file, 2.0)
    assert large.model.parameters["c33"].value == pytest.approx(4.0 * model.parameters["c33"].value)
    assert large.model.parameters["a55"].value == pytest.approx(32.0 * model.parameters["a55"].value)
    b53 = large.model.parameters.free_names.index("b53")
    # kg m/s: mass and length over time, 3 + 1 - 1/2
    assert large.covariance[b53, b53] == pytest.approx(2.0**7)


def test_a_unit_without_an_exponent_is_named() -> None:
    model = heave_and_pitch()
    odd = model.with_parameters(replace(model.parameters, items=(
        *(replace(p, unit="furlong") if p.name == "a33" else p for p in model.parameters),
    )))  # fmt: skip
    with pytest.raises(InputError, match="parameter a33: no Froude exponent is known for unit 'furlong'"):
        model_at_scale(ModelFile(odd), 2.0)
