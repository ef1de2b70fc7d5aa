"""Models with known symmetries, and what the tests of symmetries share."""

from collections.abc import Sequence

import numpy as np
import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.core.values import Array
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.mmg import mmg
from seatrial.physics.models.nomoto import nomoto, nomoto2
from seatrial.physics.models.published import esso_osaka, kvlcc2
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.replay import trajectory

MOTION = ("u", "v", "r", "psi", "x0", "y0")
SHIP = {"L": 7.0, "m": 3270.0, "x_G": 0.25, "I_z": 1e4, "rho": 1000.0, "U_n": 1.2, "Y_vdot": -0.015, "N_rdot": -0.0008}
TYPICAL = {"u": 1.0, "delta": 0.2, "v_j": 1.9, "n": 10.0, "wind_speed": 3.0, "wind_direction": 1.0}


def freed(model: Model, *names: str) -> Model:
    return model.with_parameters(model.parameters.freed(*names))


def yaw() -> tuple[Sheet, sp.Symbol, sp.Symbol]:
    """A sheet with yaw rate and rudder."""
    sheet = Sheet("yaw", "made up")
    (r,) = sheet.states("r")
    return sheet, r, sheet.input("delta")


def free(sheet: Sheet, names: str, value: float = 0.7) -> list[sp.Symbol]:
    return [sheet.parameter(n, value + 0.1 * k, free=True) for k, n in enumerate(names.split())]


def gain_and_time() -> Model:
    sheet, r, delta = yaw()
    K, T = free(sheet, "K T")
    sheet.rate(r, (K * delta - r) / T)
    return sheet.model()


def product() -> Model:
    sheet, r, delta = yaw()
    a, b, c = free(sheet, "a b c")
    sheet.rate(r, a * b * delta - c * r)
    return sheet.model()


def total() -> Model:
    sheet, r, delta = yaw()
    a, b, c = free(sheet, "a b c")
    sheet.rate(r, c * delta - (a + b) * r)
    return sheet.model()


def difference() -> Model:
    sheet, r, delta = yaw()
    a, b, c = free(sheet, "a b c")
    sheet.rate(r, c * delta - (a - b) * r)
    return sheet.model()


def ratio() -> Model:
    """Moments over an inertia, one of which is known: N_r about its own, sum of two inertias."""
    sheet, r, delta = yaw()
    I_z = sheet.parameter("I_z", 2.0, "kg m^2")
    N_r, N_d = free(sheet, "N_r N_d")
    J_z = sheet.parameter("J_z", 1.0, "kg m^2")
    sheet.rate(r, (N_d * delta + N_r * r) / (I_z + J_z))
    return sheet.model()


def powers() -> Model:
    sheet, r, delta = yaw()
    a, b, c = free(sheet, "a b c")
    sheet.rate(r, a**2 * b * delta - b * c * r)
    return sheet.model()


def hidden_scale() -> Model:
    """The servo's angle is not measured: its unit is arbitrary."""
    sheet = Sheet("servo", "made up")
    r, servo = sheet.states("r servo")
    delta = sheet.input("delta")
    slew, lift, drag = free(sheet, "slew lift drag")
    sheet.rate(r, lift * servo - drag * r)
    sheet.rate(servo, slew * delta - servo)
    return sheet.model()


def hidden_shift() -> Model:
    """A filter with unknown zero at both ends."""
    sheet = Sheet("filter", "made up")
    (state,) = sheet.states("state")
    delta = sheet.input("delta")
    zero, drift = free(sheet, "zero drift")
    rate = sheet.parameter("rate", 0.5)
    sheet.rate(state, delta + drift - rate * state)
    sheet.output("thrust", state + zero, unit="N")
    return sheet.model()


def entangled() -> Model:
    """What a change of one does to the others depends on values: three parameters, two numbers."""
    sheet, r, delta = yaw()
    a, b, c = free(sheet, "a b c")
    sheet.rate(r, (a * b + c) * delta - b * r)
    return sheet.model()


def switched_off() -> Model:
    sheet, r, delta = yaw()
    K, C_X, unused = free(sheet, "K C_X unused")
    A_T = sheet.parameter("A_T", 0.0, "m^2")
    sheet.bind("elsewhere", unused * delta)
    sheet.rate(r, K * delta - r + A_T * C_X * r**2)
    return sheet.model()


NONE = {
    "gain and time": (gain_and_time, ("r",)),
    "nomoto": (nomoto, ("r", "psi")),
    "nomoto, heading only": (nomoto, ("psi",)),
    "nomoto2": (nomoto2, ("r", "psi")),
    "nomoto2, heading only": (nomoto2, ("psi",)),
    "abkowitz, added masses free": (lambda: freed(abkowitz().with_values(SHIP), "Y_vdot", "N_rdot"), MOTION),
    "mmg kvlcc2": (kvlcc2, MOTION),
    "mmg esso osaka": (lambda: esso_osaka().applied_to(mmg()), MOTION),
}
SOME = {
    "product": (product, ("r",), [("a", "b")]),
    "sum": (total, ("r",), [("a", "b")]),
    "difference": (difference, ("r",), [("a", "b")]),
    "ratio": (ratio, ("r",), [("N_r", "N_d", "J_z")]),
    "powers": (powers, ("r",), [("a", "b", "c")]),
    "hidden scale": (hidden_scale, ("r",), [("slew", "lift")]),
    "hidden shift": (hidden_shift, ("thrust",), [("zero", "drift")]),
    "entangled": (entangled, ("r",), [("a", "c")]),
    "waterjet": (
        waterjet,
        MOTION,
        [("m_x", "m_y", "J_z", "A_j", *COEFFICIENTS), ("J_z", "x_T", "N_v", "N_r", "N_rr")],
    ),
}


def outcome(model: Model, outputs: Sequence[str], start: Array) -> Array:
    """The compared outputs over 60 s of smooth random inputs, (samples, outputs)."""
    t = np.arange(0.0, 60.0, 0.1)
    rng = np.random.default_rng(11)
    waves = [sum(np.sin(rng.uniform(0.05, 0.6) * t + rng.uniform(0, 6)) for _ in range(3)) for _ in model.inputs]
    levels = [
        TYPICAL.get(i, 0.3) * (1.0 + 0.3 * w) if i != "delta" else 0.15 * w
        for i, w in zip(model.input_names, waves, strict=True)
    ]
    states, made = trajectory(model, np.ascontiguousarray(np.stack(levels, axis=1)), 0.1, start)
    both = np.concatenate([states, made], axis=1)
    return both[:, [model.observables.index(n) for n in outputs]]


def begin(model: Model) -> Array:
    return np.array([TYPICAL.get(s, 0.0) for s in model.states])


def worst_difference(model: Model, moved: Model, outputs: Sequence[str], start: Array) -> float:
    here, there = outcome(model, outputs, begin(model)), outcome(moved, outputs, start)
    assert np.abs(here).max() > 0.0
    return float((np.abs(there - here).max(axis=0) / np.abs(here).max(axis=0)).max())
