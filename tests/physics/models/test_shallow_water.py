"""Shallow water: exactly the deep model where it is deep, the published factors, and exact flow past sections."""

import math

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.models.mmg import mmg, mmg_shallow
from seatrial.physics.models.published import SHARE_SPREAD, kvlcc2, kvlcc2_l7, share_name
from seatrial.physics.models.shallow_water import LEAST_RATIO


def shallow() -> Model:
    """The 7 m tanker in water of any depth."""
    return kvlcc2_l7().applied_to(mmg_shallow())


def rates(model: Model, x: Array, **inputs: float) -> Array:
    """Rates at a state."""
    out = np.empty(len(x))
    u = np.array([inputs.get(name, 0.0) for name in model.input_names])
    model.compiled.rates(0.0, x, u, model.parameters.values, out)
    return out


def factors(depth: float) -> dict[str, float]:
    """Factors on the coefficients of the tanker at a depth."""
    model = shallow()
    x, u = np.zeros((1, len(model.states))), np.zeros((1, len(model.inputs)))
    x[0, 0], u[0, model.input_names.index("depth")] = 1.0, depth
    found = model.forces(x, u)
    return {name: float(found[f"f_{name}"][0]) for name in SHARE_SPREAD}


def test_without_a_depth_the_model_is_that_of_deep_water(rng: np.random.Generator) -> None:
    for _ in range(20):
        x = rng.normal(size=6) * [1.0, 0.3, 0.1, 1.0, 1.0, 1.0]
        orders = {"n": 8.0 * rng.normal(), "delta": 0.4 * rng.normal()}
        np.testing.assert_allclose(rates(shallow(), x, **orders), rates(kvlcc2(), x, **orders), rtol=1e-13)


def test_far_from_the_bottom_the_factors_tend_to_one() -> None:
    for name, factor in factors(1e6).items():
        assert factor == pytest.approx(1.0, abs=1e-4), name


def test_factors_are_those_of_their_sources() -> None:
    """Written again from the print: draught over depth 2/3, KVLCC2."""
    L, B, d, C_b = 7.0, 1.27, 0.46, 0.81
    x, k = math.pi / 3, 2 * d / L

    def effective(q: float) -> float:
        return k / (1 / 3 + (x / math.tan(x)) ** q)

    fullness = 1.4 * C_b * B / L
    near = 0.5**0.82
    expected = {
        "Y_v": (math.pi / 2 * effective(2.3) + fullness) / (math.pi / 2 * k + fullness),
        "Y_r": effective(0.7) / k,
        "N_v": effective(1.7) / k,
        "N_r": (0.54 * effective(0.7) - effective(0.7) ** 2) / (0.54 * k - k**2),
        "m_y": (near + 0.413 + 0.032 * B / d + 0.129 * (B / d) ** 2) / near,
        "J_z": (near + 0.413 + 0.0192 * B / d + 0.00554 * (B / d) ** 2) / near,
        "R_0": 1 + 0.388 * 4 / 9,
        "w_P": math.cos(1.4 * C_b * 2 / 3),
        "t_P": 1 / (1 - 0.2 * 2 / 3 + 0.7295 * 4 / 9),
        "gamma_R": 1 + 0.0161 * 2 / 3 + 4.4222 * 4 / 9 - 4.9825 * 8 / 27,
    }
    assert factors(1.5 * d) == pytest.approx(expected, rel=1e-12)


def test_below_the_least_depth_factors_stay() -> None:
    d = 0.46
    assert factors(1.02 * d) == pytest.approx(factors(LEAST_RATIO * d), rel=1e-12)


def test_no_share_is_deep_water_at_any_depth(rng: np.random.Generator) -> None:
    without = shallow().with_values(dict.fromkeys(map(share_name, SHARE_SPREAD), 0.0))
    x = rng.normal(size=6)
    np.testing.assert_allclose(rates(without, x, n=9.0, depth=0.6), rates(kvlcc2(), x, n=9.0), rtol=1e-12)


def test_equations_in_deep_water_are_those_of_mmg() -> None:
    own = {b.name: b.text for b in mmg_shallow().bindings}
    unchanged = [b.name for b in mmg().bindings if own[b.name] == b.text]
    changed = {b.name for b in mmg().bindings} - set(unchanged)
    assert changed == {"X_H", "Y_H", "N_H", "w_P", "X_P", "v_R", "M_v", "M_r", "X_m"}


def sway_added_mass(breadth: float, depth: float, panels: int = 200) -> float:
    """Added mass of an elliptic section of draught 1 below a rigid surface, by sources on it and their images."""
    angle = np.linspace(0.0, 2.0 * np.pi, panels + 1)
    ends = breadth / 2 * np.cos(angle) + 1j * np.sin(angle)
    middle, step = (ends[1:] + ends[:-1]) / 2, np.diff(ends)
    size, normal, k = np.abs(step), step / np.abs(step) / 1j, np.pi / (2 * depth)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    slope, potential = np.zeros((2, panels, panels))
    for node, weight in zip(nodes, weights, strict=True):
        z = k * (middle[:, None] - middle - node / 2 * step)
        velocity = np.conj(k / (2 * np.pi) / np.tanh(z))
        slope += weight / 2 * size * np.real(velocity * np.conj(normal[:, None]))
        potential += weight / 2 * size * np.log(np.abs(np.sinh(z))) / (2 * np.pi)
    np.fill_diagonal(slope, 0.5)
    np.fill_diagonal(potential, size * (np.log(k * size / 2) - 1) / (2 * np.pi))
    sources = np.linalg.solve(slope, normal.real)
    return float(-np.sum(potential @ sources * normal.real * size) / 2)


def test_added_mass_in_sway_grows_as_that_of_elliptic_sections_do() -> None:
    """Of the change of m_y exact two-dimensional flow has what SHARE_SPREAD says."""
    breadth = 1.27 / 0.46
    deep = sway_added_mass(breadth, 100.0)
    assert deep == pytest.approx(math.pi / 2, rel=0.02)
    for ratio, share in ((1.2, 0.71), (1.5, 0.62), (2.0, 0.49), (5.0, 0.20)):
        exact = sway_added_mass(breadth, ratio) / deep - 1.0
        assert exact / (factors(ratio * 0.46)["m_y"] - 1.0) == pytest.approx(share, abs=0.01)
