"""Results compared field by field, to the last bit."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np

from seatrial.core.equations import Model


def assert_equal(one: object, other: object, place: str = "") -> None:
    """Fail where two values differ in type or in any bit; NaN equals NaN, a NumPy float the number it holds."""
    assert type(one) is type(other) or isinstance(one, float), place
    if isinstance(one, Model):
        assert (one.equation_hash, one.parameters) == (other.equation_hash, other.parameters), place
    elif isinstance(one, np.ndarray):
        assert np.array_equal(one, other, equal_nan=True), place
    elif is_dataclass(one) and not isinstance(one, type):
        for field in fields(one):
            assert_equal(getattr(one, field.name), getattr(other, field.name), f"{place}.{field.name}")
    elif isinstance(one, Mapping):
        assert list(one) == list(other), place
        for key in one:
            assert_equal(one[key], other[key], f"{place}[{key}]")
    elif isinstance(one, tuple):
        assert len(one) == len(other), place
        for i, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_equal(a, b, f"{place}[{i}]")
    else:
        assert one == other or (one != one and other != other), place
