"""Sensitivities against central differences of the computed trajectory, column by column."""

from dataclasses import replace

import numpy as np
import pytest
from tests.numerics.kernels.case import KernelCase

from seatrial.core.equations import Model


def moved(case: KernelCase, kind: str, i: int, step: float) -> KernelCase:
    if kind in ("p", "start"):
        changed = getattr(case, kind).copy()
        changed[:, i] += step
        return replace(case, **{kind: changed})
    row = list(getattr(case, kind))
    row[i] += step
    return replace(case, **{kind: tuple(row)})


@pytest.fixture(scope="module")
def case(nonlinear: Model) -> KernelCase:
    rng = np.random.default_rng(5)
    inputs = np.array([0.2, 0.8]) + np.cumsum(rng.normal(0.0, 0.03, (60, 2)), axis=0)
    start = np.array([[0.3, -0.2], [0.5, 0.1]])
    p = nonlinear.parameters.values * np.array([[1.0, 1.0, 1.0], [1.1, 0.9, 1.05]])
    return KernelCase(nonlinear, inputs, (0, 25, 60), 0.1, start, p, 2, (1.1, 0.9), (0.03, -0.02), (0.037, 0.113))


def test_every_column_equals_central_differences(case: KernelCase) -> None:
    _, s, failed = case.run_tangent()
    assert (failed == -1).all()
    for k, (kind, i) in enumerate(case.columns()):
        step = 1e-6
        upper, lower = moved(case, kind, i, step).run()[0], moved(case, kind, i, -step).run()[0]
        differences = (upper - lower) / (2 * step)
        scale = np.abs(differences).max()
        assert scale > 1e-3, f"column {kind} {i} has no effect: the test would not see an error"
        np.testing.assert_allclose(s[:, :, k], differences, atol=2e-8 * max(scale, 1.0), err_msg=f"{kind} {i}")


def test_the_trajectory_is_the_plain_one(case: KernelCase) -> None:
    np.testing.assert_allclose(case.run_tangent()[0], case.run()[0], rtol=1e-13, atol=1e-14)


def test_initial_states_start_from_unity(case: KernelCase) -> None:
    s = case.run_tangent()[1]
    for first in case.offsets[:-1]:
        np.testing.assert_array_equal(s[first, :2, -2:], np.eye(2))
        np.testing.assert_array_equal(s[first, :2, :-2], 0.0)


def test_a_diverging_segment_is_flagged_and_the_next_one_is_not_harmed(explosive: Model) -> None:
    case = KernelCase(explosive, np.zeros((80, 1)), (0, 40, 80), 0.1, np.array([[1.0], [0.1]]), np.ones((2, 1)))
    y, s, failed = case.run_tangent()
    assert 10 <= failed[0] <= 14 and failed[1] == -1
    assert np.isnan(s[failed[0] : 40]).all() and np.isnan(y[failed[0] : 40]).all()
    assert np.isfinite(s[40:]).all() and np.isfinite(y[40:]).all()
