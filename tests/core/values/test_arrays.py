"""Arrays are frozen; covariances become correlations."""

import numpy as np
import pytest

from seatrial.core.values import frozen
from seatrial.core.values.arrays import correlation_matrix


def test_correlation_of_a_covariance() -> None:
    assert np.allclose(correlation_matrix(np.array([[4.0, -1.0], [-1.0, 1.0]])), [[1.0, -0.5], [-0.5, 1.0]])
    assert np.isnan(correlation_matrix(np.diag([1.0, 0.0]))[1]).all()


def test_a_frozen_array_is_a_copy_that_cannot_be_written() -> None:
    source = np.zeros(3)
    copy = frozen(source)
    source[0] = 1.0
    assert copy[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        copy[1] = 2.0
