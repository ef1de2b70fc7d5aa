"""The craft of `gusts.py`: a steering model, a waterjet, a craft with two thrusters, roll in irregular waves."""

import math
from functools import cache
from types import MappingProxyType

import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.physics.models.roll import roll
from seatrial.physics.models.waterjet import waterjet
from seatrial.problems.disturbed_craft import NOMOTO, DisturbedCraft

# accelerations by a nozzle angle of 20 deg, and in surge a force of the same size as in sway
WATERJET = DisturbedCraft(
    "waterjet",
    waterjet(),
    {"u": 1.0e-3, "v": 2.5e-3, "r": 1.55e-3},
    {"u": 0.02, "v": 0.02, "r": math.radians(0.1), "psi": math.radians(0.2)},
    9.8,
    dict.fromkeys(waterjet().parameters.free_names, 0.0),
    held={"v_j": 1.866},
    start={"u": 0.8},
    bit_s=20.0,
    leg_s=120.0,
    amplitude=math.radians(20.0),
    limit=math.radians(25.0),
    course=math.radians(20.0),
    gain=1.5,
    rate_gain=20.0,
)


@cache
def twin_thrusters() -> Model:
    """A small craft with two fixed thrusters: linear and quadratic damping, thrust proportional to command."""
    sheet = Sheet("twin_thrusters", "for this benchmark", "craft with two thrusters")
    u, v, r, psi = sheet.states("u v r psi")
    port, starboard = sheet.input("command_1"), sheet.input("command_2")

    def free(name: str, value: float, unit: str) -> sp.Symbol:
        return sheet.parameter(name, value, unit, "for this benchmark", free=True)

    x_1, x_2, y_1, n_1, n_2 = (free(*p) for p in (("x_1", 0.2, "1/s"), ("x_2", 0.15, "1/m"), ("y_1", 0.8, "1/s"),
                                                  ("n_1", 1.0, "1/s"), ("n_2", 0.5, "1/rad")))  # fmt: skip
    t, b, y_r = free("t", 0.25, "m/s^2"), free("b", 0.6, "rad/s^2"), free("y_r", -0.1, "m/s")
    sheet.rate(u, v * r - x_1 * u - x_2 * u * sp.Abs(u) + t * (port + starboard), "surge")
    sheet.rate(v, -u * r - y_1 * v + y_r * r, "sway")
    sheet.rate(r, -n_1 * r - n_2 * r * sp.Abs(r) + b * (port - starboard), "yaw")
    sheet.rate(psi, r, "heading")
    return sheet.model()


THRUSTERS = DisturbedCraft(
    "thrusters",
    twin_thrusters(),
    {"u": 0.05, "v": 0.05, "r": 0.18},
    {"u": 0.02, "v": 0.02, "r": math.radians(0.3), "psi": math.radians(0.3)},
    1.2,
    {"x_1": 0.1, "x_2": 0.1, "y_1": 0.5, "n_1": 0.5, "n_2": 0.0, "t": 0.2, "b": 0.4, "y_r": 0.0},
    steered={"command_1": 1.0, "command_2": -1.0},
    held={"command_1": 0.5, "command_2": 0.5},
    start={"u": 0.79},
    slew=1.0,
    amplitude=0.15,
    limit=0.4,
    course=math.radians(20.0),
    gain=0.8,
    rate_gain=0.4,
)


def _roll() -> Model:
    model = roll().with_values({"b_1": 0.06, "c_1": 0.5, "K_alpha": 0.3, "r_w": 1.0})
    fixed = model.parameters.fixed("b_2", "b_3", "c_3", "c_5", "phi_0")
    return model.with_parameters(fixed.freed("K_alpha", "r_w"))


ROLL = DisturbedCraft(
    "roll",
    _roll(),
    {"p": 0.5 * 0.3 * math.radians(10.0)},
    {"phi": math.radians(0.05), "p": math.radians(0.05)},
    50.0,
    {"b_1": 0.02, "c_1": 1.0, "K_alpha": 0.1, "r_w": 0.8},
    steered={"alpha_f": 1.0},
    wave_slope="alpha_w",
    controlled="phi",
    rate="p",
    slew=math.radians(20.0),
    amplitude=math.radians(10.0),
    limit=math.radians(20.0),
    course=math.radians(5.0),
    gain=1.0,
    rate_gain=2.0,
    leg_s=10.0,
)
CRAFT = MappingProxyType({c.name: c for c in (NOMOTO, WATERJET, THRUSTERS, ROLL)})
