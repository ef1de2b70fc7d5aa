"""Changes that no record can show: those of known models are found, none elsewhere; moved models do the same."""

from collections.abc import Callable
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from tests.estimation.information.symmetry_models import (
    MOTION,
    NONE,
    SOME,
    begin,
    difference,
    free,
    hidden_scale,
    hidden_shift,
    powers,
    product,
    total,
    worst_difference,
    yaw,
)

from seatrial.core.equations import Model
from seatrial.estimation.information.generator import Generator
from seatrial.estimation.information.symmetries import (
    generators,
    refuse_unidentifiable,
    structural_symmetries,
)
from seatrial.physics.models.mmg import mmg
from seatrial.physics.models.published import esso_osaka, kvlcc2
from seatrial.physics.models.waterjet import waterjet


@pytest.mark.parametrize("case", NONE)
def test_models_without_a_symmetry_are_stated_to_have_none(case: str) -> None:
    make, outputs = NONE[case]
    assert structural_symmetries(make(), outputs) == ()
    refuse_unidentifiable(make(), outputs)


@pytest.mark.parametrize("case", SOME)
def test_symmetries_that_are_known_are_found(case: str) -> None:
    make, outputs, wanted = SOME[case]
    assert [set(s.parameters) for s in structural_symmetries(make(), outputs)] == [set(w) for w in wanted]


@pytest.mark.parametrize("case", [c for c in SOME if c not in ("hidden shift", "entangled")])
@pytest.mark.parametrize("step", [np.log(1.3), -0.4])
def test_finite_steps_leave_every_compared_output_as_it_is(case: str, step: float) -> None:
    make, outputs, _ = SOME[case]
    model = make()
    among = [p.name for p in model.parameters if p.free or p.name in ("A_j", "m_x", "m_y", "J_z", "x_T")]
    found = generators(model, outputs, among)
    assert found
    for g in found:
        assert g.is_finite
        moved = g.transformed_model(model, step)
        assert max(abs(v) for v in g.relative_change(model).values()) > 0.5
        assert worst_difference(model, moved, outputs, begin(model)) < 1e-9


def test_a_hidden_state_starts_where_it_then_belongs() -> None:
    model = hidden_shift()
    (g,) = generators(model, ("thrust",), model.parameters.free_names)
    assert g.hidden_states == ("state",)
    moved = g.transformed_model(model, 0.3)
    start = begin(model) - (moved.parameters["zero"].value - model.parameters["zero"].value)
    assert worst_difference(model, moved, ("thrust",), start) < 1e-9
    assert worst_difference(model, moved, ("thrust",), begin(model)) > 1e-3


def test_without_a_simple_law_the_direction_at_the_values_is_given() -> None:
    """0.8 b + c, b + d and d e stay: b up by 1, d down by 1, c down by 0.8, e up by e/d."""
    sheet, r, delta = yaw()
    b, c, d, e = free(sheet, "b c d e")
    sheet.rate(r, (0.8 * b + c) * delta - (b + d) * r + d * e * r**2)
    model = sheet.model()
    (g,) = generators(model, ("r",))
    assert not g.is_finite
    slope = {n: s / g.shift["b"] for n, s in g.shift.items()}
    assert slope == pytest.approx(
        {"b": 1.0, "c": -0.8, "d": -1.0, "e": model.parameters["e"].value / model.parameters["d"].value}
    )
    assert worst_difference(model, g.transformed_model(model, 1e-6), ("r",), begin(model)) < 1e-10
    (symmetry,) = structural_symmetries(model, ("r",))
    assert symmetry.text.startswith(
        "b, c, d and e have an effect in 3 combinations only and can change together (near their"
    )


def exact(model: Model, point: dict[str, mpmath.mpf]) -> list[mpmath.mpf]:
    """Rates and outputs, binding by binding, with 60 digits."""
    known = dict(point)

    def value(expression: sp.Expr) -> mpmath.mpf:
        symbols = sorted(expression.free_symbols, key=str)
        return mpmath.mpf(sp.lambdify(symbols, expression, "mpmath")(*(known[str(s)] for s in symbols)))

    for b in model.bindings:
        known[b.name] = value(b.expression)
    return [value(rate.expression) for rate in model.equations.rates] + [known[n] for n in model.outputs]


def exactly_moved(g: Generator, point: dict[str, mpmath.mpf], factor: Fraction) -> dict[str, mpmath.mpf]:
    """The finite transformation in exact arithmetic; a centre named after a parameter is minus that parameter."""
    moved = dict(point)
    for name in g.parameters:
        about = -point[g.centred_terms[name].split(" + ")[0]] if name in g.centred_terms else mpmath.mpf(0)
        scale = mpmath.mpf(factor.numerator) / factor.denominator
        moved[name] = (
            about + (point[name] - about) * scale ** g.power[name]
            if g.power[name]
            else point[name] + mpmath.mpf(g.shift[name]) / 3
        )
    return moved


@pytest.mark.parametrize("case", ["product", "sum", "difference", "ratio", "powers", "waterjet"])
def test_the_law_is_exact_to_fifty_digits(case: str) -> None:
    make, outputs, _ = SOME[case]
    model = make()
    held = ("L", "d", "m", "rho", "I_z", "alpha", "current_north", "current_east")
    found = generators(model, outputs, [n for n in model.parameters.names if n not in held])
    assert found
    rng = np.random.default_rng(5)
    with mpmath.workdps(60):
        for g in found:
            for _ in range(5):
                names = (*model.states, *model.input_names)
                point = {n: mpmath.mpf(float(rng.normal())) for n in names}
                point |= {
                    p.name: mpmath.mpf(p.value) * mpmath.mpf(float(rng.uniform(0.5, 2))) for p in model.parameters
                }
                here, there = exact(model, point), exact(model, exactly_moved(g, point, Fraction(13, 10)))
                assert max(abs(a - b) / (1 + abs(a)) for a, b in zip(here, there, strict=True)) < mpmath.mpf(10) ** -50


def test_waterjet_scalings_by_symbols() -> None:
    """S1: coefficients, thrust and total inertias; S2: the yaw row, its inertia and the nozzle's lever."""
    model, k = waterjet(), sp.Symbol("k", positive=True)
    whole: dict[sp.Symbol, sp.Expr] = {}
    for b in model.bindings:
        whole[sp.Symbol(b.name, real=True)] = b.expression.xreplace(whole)
    rates = [rate.expression.xreplace(whole) for rate in model.equations.rates]
    for symmetry in structural_symmetries(model, MOTION):
        change = {}
        for name in symmetry.parameters:
            symbol = sp.Symbol(name, real=True)
            carried = {"m_x": "m", "m_y": "m", "J_z": "I_z"}.get(name)
            about = sp.Symbol(carried, real=True) if carried else sp.Integer(0)
            change[symbol] = k * (symbol + about) - about
        assert all(sp.simplify(r.subs(change, simultaneous=True) - r) == 0 for r in rates)


def test_the_basis_is_complete_for_all_parameters() -> None:
    """24 of the waterjet: rank 17 by hand (see the class); every kind of trade is in the basis."""
    model = waterjet()
    found = generators(model, MOTION)
    assert len(found) == 7
    assert all(g.is_finite for g in found)
    for g in found:
        assert worst_difference(model, g.transformed_model(model, 0.1), MOTION, begin(model)) < 1e-9


@pytest.mark.parametrize(("make", "nullity"), [(kvlcc2, 13), (lambda: esso_osaka().applied_to(mmg()), 13)])
def test_directions_of_all_mmg_parameters_leave_the_motion_as_it_is(make: Callable[[], Model], nullity: int) -> None:
    """To first order of a small step, so the error is of second order."""
    model = make().with_values({"A_T": 0.3, "A_L": 1.1})
    found = generators(model, MOTION)
    assert len(found) == nullity
    for g in found:
        error = worst_difference(model, g.transformed_model(model, 1e-6), MOTION, begin(model))
        assert error < (1e-9 if g.is_finite else 1e-8), g


def test_rudder_force_of_mmg_is_known_only_as_products() -> None:
    model = kvlcc2()
    model = model.with_parameters(model.parameters.only_free(["f_alpha", "t_R", "a_H", "x_R_prime"]))
    (symmetry,) = structural_symmetries(model, MOTION)[:1]
    assert set(symmetry.parameters) == {"f_alpha", "t_R", "a_H", "x_R_prime"}
    assert "f_alpha is divided by it" in symmetry.text
    assert "1 - t_R" in symmetry.text
    assert "1 + a_H" in symmetry.text


def test_the_words_for_the_waterjet() -> None:
    first, second = structural_symmetries(waterjet(), ("u", "v", "r", "psi"))
    assert first.text.startswith(
        "X_uu, X_vv, X_rr, Y_v, Y_r, Y_vv, Y_vr, Y_rr, N_v, N_r, N_rr, A_j, m + m_x, m + m_y and I_z + J_z can all be "
        "scaled together by one common factor without any change of u, v, r or psi. Fix or give a prior for one of "
        "m_x, m_y, A_j"
    )
    assert second.text.startswith("N_v, N_r, N_rr, x_T and I_z + J_z can all be scaled together")
    assert "one of J_z, x_T" in second.text
    assert first.change["Y_v"] == first.change["A_j"] == 1.0
    assert first.change["m_x"] == pytest.approx(1.0 + 1.0 / 0.0281)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (product, "a can be multiplied by any factor if b is divided by it"),
        (total, "a can be raised by any amount if b is lowered by as much"),
        (difference, "a and b can both be raised by one common amount"),
        (powers, "k^"),
        (hidden_scale, "with servo, not measured, changed to fit,"),
    ],
)
def test_words_of_small_models(make: Callable[[], Model], words: str) -> None:
    (symmetry,) = structural_symmetries(make(), ("r",))
    assert words in symmetry.text
