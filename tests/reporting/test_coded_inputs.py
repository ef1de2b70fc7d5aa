"""Inputs of a slider page are exact, and small where a logger writes few digits."""

import base64
import json

import numpy as np
import pytest

from seatrial.reporting.resimulation import _coded

SAMPLES = 5000


def decoded(coded: object) -> np.ndarray:
    if isinstance(coded, float):
        return np.full(SAMPLES, coded)
    if isinstance(coded, dict):
        places = np.frombuffer(base64.b64decode(coded["index"]), "<u2" if coded["wide"] else "<u1")
        return np.frombuffer(base64.b64decode(coded["table"]), "<f8")[places]
    assert isinstance(coded, str)
    return np.frombuffer(base64.b64decode(coded), "<f8")


@pytest.mark.parametrize(("digits", "most_kilobytes"), [(0, 8), (1, 20), (2, 54), (12, 54)])
def test_a_column_comes_back_to_the_bit(digits: int, most_kilobytes: float, rng: np.random.Generator) -> None:
    rudder = np.radians(np.round(20.0 * np.sin(0.01 * np.arange(SAMPLES)) + rng.standard_normal(SAMPLES), digits))
    coded = _coded(rudder)
    np.testing.assert_array_equal(decoded(coded), rudder)
    assert len(json.dumps(coded)) < 1e3 * most_kilobytes


def test_a_constant_column_is_its_value() -> None:
    assert _coded(np.full(SAMPLES, 1.5)) == 1.5
