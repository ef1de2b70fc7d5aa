"""Models whose motion is known, or that have every kind of term."""

import pytest
import sympy as sp

from seatrial.core.equations import Model, Sheet


@pytest.fixture(scope="session")
def oscillator() -> Model:
    """x' = v, v' = -k x - c v + b u; linear, so that the matrix exponential is the truth."""
    sheet = Sheet("oscillator")
    x, v = sheet.states("x0 v")
    u = sheet.input("delta")
    k, c, b = (sheet.parameter(name, value) for name, value in (("k", 1.5), ("c", 0.3), ("b", 0.8)))
    force = sheet.bind("force", b * u - k * x)
    sheet.rate(x, v)
    sheet.rate(v, force - c * v)
    sheet.output("v_dot", force - c * v)
    return sheet.model()


@pytest.fixture(scope="session")
def nonlinear() -> Model:
    """A yaw-sway pair with every kind of term, two inputs and two outputs."""
    sheet = Sheet("nonlinear")
    v, r = sheet.states("v r")
    delta, n = sheet.input("delta"), sheet.input("n")
    a, b, c = (sheet.parameter(name, value) for name, value in (("a", -0.5), ("b", 0.7), ("c", 0.2)))
    U = sheet.bind("U", sp.sqrt(v**2 + 1), "speed")
    F = sheet.bind("F", b * n**2 * sp.sin(delta - c * v / U), "rudder")
    sheet.rate(v, a * v * sp.Abs(v) + F)
    sheet.rate(r, a * r * U - F / 2 + c * v * r)
    sheet.output("v_dot", F * U)
    sheet.output("thrust", b * n * delta * r)
    return sheet.model()


@pytest.fixture(scope="session")
def explosive() -> Model:
    """x' = a x^2 + u: leaves every bound in finite time."""
    sheet = Sheet("explosive")
    (x,) = sheet.states("u")
    command = sheet.input("delta")
    sheet.rate(x, sheet.parameter("a", 1.0) * x**2 + command)
    return sheet.model()
