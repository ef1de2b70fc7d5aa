"""A result names the versions it rests on."""

import platform

import numpy as np

from seatrial import __version__
from seatrial.core.values.versions import versions


def test_python_and_what_computes_are_named() -> None:
    named = versions()
    assert named["python"] == platform.python_version() and named["numpy"] == np.__version__
    assert {"scipy", "numba", "sympy"} <= set(named)
    assert named["seatrial"] == __version__  # not that of an install that the checkout has left behind
