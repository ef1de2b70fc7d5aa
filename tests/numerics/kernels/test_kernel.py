"""Functions with one signature: compiled at first use, by any kind of use, and strict about their arguments."""

from collections.abc import Callable

import numpy as np
import pytest
from numba import void

from seatrial.numerics.kernels.integrate import evaluate
from seatrial.numerics.kernels.kernel import F8, FUNCTION_SIGNATURE, LEAN, OPTIONS, VECTOR, Kernel, kernel


def doubled() -> Kernel:
    @kernel(void(VECTOR, F8), **LEAN)
    def double(x, by):
        for i in range(x.size):
            x[i] *= by

    return double


def test_nothing_is_compiled_before_the_first_call() -> None:
    double, x = doubled(), np.ones(3)
    assert not double.overloads
    double(x, 2)
    assert x.tolist() == [2.0, 2.0, 2.0]
    assert len(double.overloads) == 1


@pytest.mark.parametrize("wrong", [np.ones(3, dtype=np.float32), np.ones((3, 3)), np.ones(6)[::2], [1.0]])
@pytest.mark.parametrize("is_first", [True, False])
def test_other_arguments_are_refused(wrong: object, *, is_first: bool) -> None:
    double = doubled()
    if not is_first:
        double(np.ones(1), 1.0)
    with pytest.raises(TypeError):
        double(wrong, 2.0)


def decay() -> Callable[..., None]:
    @kernel(FUNCTION_SIGNATURE, **OPTIONS)
    def rates(t, x, u, p, out):  # noqa: ARG001
        out[0] = -p[0] * x[0]

    return rates


def test_a_kernel_is_compiled_when_another_takes_it_as_argument() -> None:
    out = np.empty((2, 1))
    evaluate(decay(), np.array([[1.0], [2.0]]), np.empty((2, 0)), np.array([3.0]), 0.0, out)
    assert out[:, 0].tolist() == [-3.0, -6.0]


def test_a_kernel_is_compiled_when_another_calls_it() -> None:
    double = doubled()

    @kernel(void(VECTOR), **LEAN)
    def quadruple(x):
        double(x, 2.0)
        double(x, 2.0)

    x = np.ones(2)
    quadruple(x)
    assert x.tolist() == [4.0, 4.0]
