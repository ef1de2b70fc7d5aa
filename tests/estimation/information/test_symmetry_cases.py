"""Symmetries in special cases: what is refused, what a fixed value settles, singular and zero starts."""

import numpy as np
import pytest
import sympy as sp
from tests.estimation.information.symmetry_models import (
    MOTION,
    SHIP,
    SOME,
    begin,
    free,
    freed,
    switched_off,
    worst_difference,
    yaw,
)

from seatrial.core.equations import Model, Sheet
from seatrial.core.values import InputError, Prior
from seatrial.estimation.information.symmetries import (
    generators,
    refuse_unidentifiable,
    search_symmetries,
    structural_symmetries,
)
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.mmg import mmg
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import esso_osaka, kvlcc2
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet


def test_parameters_without_influence_are_stated_with_the_reason() -> None:
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
    symmetry = structural_symmetries(tanker, MOTION, ("X_sum", "Y_sum", "N_sum"))
    assert any("rho_air" in s.parameters for s in symmetry)


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
    symmetry = [set(s.parameters) for s in structural_symmetries(model, ("psi",))]
    assert len(symmetry) == 3
    assert set(g.parameters) in symmetry


def test_a_state_behind_a_zero_reaches_nothing() -> None:
    """Without a speed the first-order model moves nobody: its positions tell nothing."""
    (symmetry,) = structural_symmetries(nomoto(), ("x0", "y0"))
    assert symmetry.text == "K and T have no influence on x0 or y0 while U is 0: fix them, or change that value"
    assert structural_symmetries(nomoto().with_values({"U": 2.0}), ("x0", "y0")) == ()


def test_a_centre_that_is_another_parameter_is_named() -> None:
    """The rudder's lever counts from the point of the additional force: x_R - x_H scales with 1 + a_H."""
    model = kvlcc2()
    model = model.with_parameters(model.parameters.only_free(["f_alpha", "t_R", "a_H"]))
    symmetry = structural_symmetries(model, MOTION)
    (rudder,) = [s for s in symmetry if "f_alpha" in s.parameters]
    assert rudder.text.startswith(
        "1 - t_R, 1 + a_H and x_R_prime - x_H_prime can be multiplied by any factor if f_alpha is divided by it without"
    )
    assert "Fix or give a prior for x_R_prime; it is fixed here, and its error spreads to all" in rudder.text


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


def test_mass_and_inertia_set_the_scale_where_no_added_mass_does() -> None:
    ship = SHIP | {"Y_vdot": 0.0, "N_rdot": 0.0, "x_G": 0.0}
    model = abkowitz(["X_u", "Y_v", "Y_r", "N_v", "N_r", "N_d"]).with_values(ship)
    sway, yaw = structural_symmetries(model, MOTION)
    assert set(sway.parameters) == {"m", "X_u", "Y_v", "Y_r"}
    assert set(yaw.parameters) == {"I_z", "N_v", "N_r", "N_d"}
    assert "its error spreads to all" in sway.text


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
