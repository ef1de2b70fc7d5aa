"""Changes that no record can show: those of known models are found, none elsewhere; moved models do the same."""

from collections.abc import Callable, Sequence
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

from seatrial.core.equations import Model, Sheet
from seatrial.core.values import Array, InputError, Prior
from seatrial.estimation.information.generator import Generator
from seatrial.estimation.information.generators import generators, search_symmetries
from seatrial.estimation.information.symmetries import refuse_unidentifiable, structural_symmetries
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
    "abkowitz": (lambda: abkowitz().with_values(SHIP), MOTION),
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


@pytest.mark.parametrize("case", NONE)
def test_models_without_a_symmetry_are_told_to_have_none(case: str) -> None:
    make, outputs = NONE[case]
    assert structural_symmetries(make(), outputs) == ()
    refuse_unidentifiable(make(), outputs)


@pytest.mark.parametrize("case", SOME)
def test_symmetries_that_are_known_are_found(case: str) -> None:
    make, outputs, wanted = SOME[case]
    assert [set(s.parameters) for s in structural_symmetries(make(), outputs)] == [set(w) for w in wanted]


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
    (told,) = structural_symmetries(model, ("r",))
    assert told.text.startswith(
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
    for told in structural_symmetries(model, MOTION):
        change = {}
        for name in told.parameters:
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
    (told,) = structural_symmetries(model, MOTION)[:1]
    assert set(told.parameters) == {"f_alpha", "t_R", "a_H", "x_R_prime"}
    assert "f_alpha is divided by it" in told.text
    assert "1 - t_R" in told.text
    assert "1 + a_H" in told.text


def test_the_words_for_the_waterjet() -> None:
    first, second = structural_symmetries(waterjet(), ("u", "v", "r", "psi"))
    assert first.text.startswith(
        "X_uu, X_vv, X_rr, Y_v, Y_r, Y_vv, Y_vr, Y_rr, N_v, N_r, N_rr, A_j, m + m_x, m + m_y and I_z + J_z can all be "
        "scaled together by one common factor without any change of u, v, r or psi: fix or give a prior for one of "
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
    (told,) = structural_symmetries(make(), ("r",))
    assert words in told.text


def test_parameters_without_influence_are_told_with_the_reason() -> None:
    off, absent = sorted(structural_symmetries(switched_off(), ("r",)), key=lambda s: s.parameters)
    assert off.parameters == ("C_X",)
    assert off.text == "C_X has no influence on r while A_T is 0: fix it, or change that value"
    assert absent.text == "unused enters no equation that reaches r: fix it"


def test_free_parameters_that_trade_are_refused_unless_a_prior_settles_it() -> None:
    model = freed(waterjet(), "A_j", "m_x", "m_y", "J_z", "x_T")
    with pytest.raises(
        InputError, match=r"no record can distinguish the free parameters: .* one of m_x, m_y, A_j; and"
    ):
        refuse_unidentifiable(model, MOTION)
    half = model.with_parameters(model.parameters.with_priors({"A_j": Prior(0.035, 0.003)}))
    with pytest.raises(InputError, match=r"free parameters: x_T, N_v, N_r, N_rr and I_z \+ J_z can"):
        refuse_unidentifiable(half, MOTION)
    both = half.with_parameters(half.parameters.with_priors({"x_T": Prior(-4.4, 0.1)}))
    refuse_unidentifiable(both, MOTION)
    assert "prior here for A_j" in structural_symmetries(both, MOTION)[0].text


def test_fixing_one_of_those_named_for_each_settles_everything() -> None:
    model = freed(waterjet(), "A_j", "m_x", "m_y", "J_z", "x_T")
    for one in ("m_x", "m_y", "A_j"):
        for two in ("J_z", "x_T"):
            refuse_unidentifiable(model.with_parameters(model.parameters.fixed(one, two)), MOTION)


def test_measured_forces_tell_what_records_cannot() -> None:
    """Captive tests give the scale of all forces (S1) and of the yaw moment (S2); still air tells nothing of wind."""
    model = freed(waterjet(), "A_j", "m_x", "m_y", "J_z", "x_T")
    with pytest.raises(InputError, match="no record can distinguish"):
        refuse_unidentifiable(model, MOTION)
    refuse_unidentifiable(model, MOTION, ("X_sum", "Y_sum", "N_sum"))
    with pytest.raises(InputError, match="free parameters: x_T, N_v, N_r, N_rr and I_z"):
        refuse_unidentifiable(model, MOTION, ("X_sum", "Y_sum"))
    tanker = esso_osaka().applied_to(mmg())
    tanker = tanker.with_parameters(tanker.parameters.only_free(["C_X0", "C_X1", "C_X3", "C_Y1", "rho_air"]))
    told = structural_symmetries(tanker, MOTION, ("X_sum", "Y_sum", "N_sum"))
    assert any("rho_air" in s.parameters for s in told)


def test_heading_alone_leaves_the_unit_of_speed_open() -> None:
    """u and v are hidden then: speeds over k, with forces and inertias to fit, turn the ship as before."""
    model = waterjet()
    among = [p.name for p in model.parameters if p.free or p.name in ("m_x", "m_y", "alpha")]
    (g,) = generators(model, ("psi",), among)
    assert g.hidden_states == ("u", "v")
    assert g.power["alpha"] == 1
    start = begin(model)
    start[:2] /= 1.3
    moved = g.transformed_model(model, np.log(1.3))
    assert worst_difference(model, moved, ("psi",), start) < 1e-9
    assert worst_difference(model, moved, ("psi",), begin(model)) > 1e-3
    told = [set(s.parameters) for s in structural_symmetries(model, ("psi",))]
    assert len(told) == 3
    assert set(g.parameters) in told


def test_a_state_behind_a_zero_reaches_nothing() -> None:
    """Without a speed the first-order model moves nobody: its positions tell nothing."""
    (told,) = structural_symmetries(nomoto(), ("x0", "y0"))
    assert told.text == "K and T have no influence on x0 or y0 while U is 0: fix them, or change that value"
    assert structural_symmetries(nomoto().with_values({"U": 2.0}), ("x0", "y0")) == ()


def test_a_centre_that_is_another_parameter_is_named() -> None:
    """The rudder's lever counts from the point of the additional force: x_R - x_H scales with 1 + a_H."""
    model = kvlcc2()
    model = model.with_parameters(model.parameters.only_free(["f_alpha", "t_R", "a_H"]))
    told = structural_symmetries(model, MOTION)
    (rudder,) = [s for s in told if "f_alpha" in s.parameters]
    assert rudder.text.startswith(
        "1 - t_R, 1 + a_H and x_R_prime - x_H_prime can be multiplied by any factor if f_alpha is divided by it without"
    )
    assert "fix or give a prior for x_R_prime; it is fixed here, and its error spreads to all" in rudder.text


def test_roots_of_negative_states_are_not_asked_for() -> None:
    sheet = Sheet("tank", "made up")
    (level,) = sheet.states("level")
    inflow = sheet.input("inflow")
    a, b = free(sheet, "a b")
    sheet.rate(level, inflow - a * b * sp.sqrt(level))
    assert [s.parameters for s in structural_symmetries(sheet.model(), ("level",))] == [("a", "b")]


def test_rates_that_are_never_finite_are_refused() -> None:
    sheet = Sheet("broken", "made up")
    (level,) = sheet.states("level")
    (a,) = free(sheet, "a")
    sheet.rate(level, a * sp.sqrt(-1 - level**2))
    with pytest.raises(InputError, match="gives no finite rates"):
        structural_symmetries(sheet.model(), ("level",))


@pytest.mark.parametrize("seed", range(6))
def test_products_of_powers_obey_the_rank_of_their_exponents(seed: int) -> None:
    """Three monomials in six parameters: what hides is what no exponent sees (Buckingham's theorem)."""
    rng = np.random.default_rng(seed)
    exponents = rng.integers(-2, 3, size=(3, 6)) * rng.integers(0, 2, size=(3, 6))
    sheet, r, delta = yaw()
    symbols = free(sheet, "a b c d e f")
    one, two, three = (sp.Mul(*(s ** int(p) for s, p in zip(symbols, row, strict=True))) for row in exponents)
    sheet.rate(r, one * delta - two * r - three * r**3)
    model = sheet.model()
    found = generators(model, ("r",))
    assert len(found) == 6 - np.linalg.matrix_rank(exponents)
    for g in found:
        powers = np.array([g.power.get(n, 0) for n in model.parameters.names])
        silent = not exponents[:, powers != 0].any()
        assert silent or not (exponents @ powers).any()
        assert silent or not any(g.shift.values())


def test_a_start_at_zero_is_no_knowledge() -> None:
    """Coefficients that start at 0 before a fit count as any value."""
    model = waterjet().with_values(dict.fromkeys(COEFFICIENTS, 0.0))
    assert [set(s.parameters) for s in structural_symmetries(model, MOTION)] == [set(w) for w in SOME["waterjet"][2]]


@pytest.mark.parametrize(
    ("model", "outputs", "message"),
    [
        (nomoto(), ("psy",), "has no output 'psy'"),
        (nomoto(), (), "no output is compared"),
        (mmg(), ("psi",), "needs values of L, d"),
    ],
)
def test_bad_input(model: Model, outputs: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        structural_symmetries(model, outputs)


def test_singular_values_have_a_gap_of_decades() -> None:
    for model in (waterjet(), kvlcc2(), abkowitz().with_values(SHIP)):
        model = model.with_parameters(model.parameters.only_free(model.parameters.names))
        singular = np.linalg.svd(search_symmetries(model, MOTION).effects, compute_uv=False)
        small = singular[singular < 1e-9]
        assert small.max() < 1e-13
        assert singular[len(singular) - len(small) - 1] > 1e-7
