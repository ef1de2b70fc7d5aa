"""Small models that exercise what the generator has to get right."""

import pytest
import sympy as sp

from seatrial.core.equations import Model, Sheet


def awkward() -> Model:
    """Every construct at once: |x|, powers, roots, branches, shared bindings, Python keywords as names, outputs."""
    sheet = Sheet("awkward", "made up", "for tests")
    v, r = sheet.states("v r")
    delta = sheet.input("delta")
    n = sheet.input("n")
    Y_v = sheet.parameter("Y_v", -0.7, free=True)
    Lambda = sheet.parameter("lambda", 1.3, free=True)
    N_r = sheet.parameter("N_r", -0.4, free=True)
    power = sheet.parameter("power", 1.7)
    U = sheet.bind("U", sp.sqrt(v**2 + r**2 + sp.Float(0.1)), "speed")
    beta = sheet.bind("beta", sp.atan2(-v, U), "drift")
    sheet.bind("unused", sp.exp(-U), "nothing rests on it")
    F_N = sheet.bind("F_N", Lambda * U**2 * sp.sin(delta - beta) * n**3 / (1 + U) ** 2, "rudder")
    side = sheet.bind("side", sp.Piecewise((Y_v * v, beta > 0), (2 * Y_v * v, True)), "two sides")
    sheet.rate(v, side + F_N * sp.cos(delta) - v * sp.Abs(v), "sway")
    sheet.rate(r, N_r * r * sp.Abs(r) / U + sp.Rational(1, 3) * F_N + U**power, "yaw")
    sheet.output("v_dot", side + F_N * sp.cos(delta) - v * sp.Abs(v), "accelerometer")
    sheet.output("thrust", n * sp.Abs(n) * Lambda, "thrust")
    return sheet.model()


@pytest.fixture(scope="session")
def model() -> Model:
    return awkward()
