"""Empirical coefficients and propeller series against published values."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Ship
from seatrial.physics.hydro.empirical import (
    HullForm,
    added_mass,
    clarke,
    cross_flow_coefficients,
    displacement,
    interaction_coefficients,
    interaction_wake,
    kijima,
    propulsion,
    thrust_coefficient,
    thrust_quadratic,
    yoshimura,
)
from seatrial.physics.models.published import ParameterSet, esso_osaka, kvlcc2_l7

KVLCC2 = HullForm.from_ship(kvlcc2_l7().ship)


def test_added_mass_of_a_waterjet_craft() -> None:
    """Song et al. 2025: m_x .0281 m, m_y .785 m, J_z .0699 m L^2; far from merchant proportions, and said so."""
    form = HullForm(9.8, 3.17, 0.71, 0.251)
    estimate = added_mass(form)
    m = form.mass_prime
    assert [round(v / m, 4) for v in estimate.values.values()][:2] == [0.0281, 0.785]
    assert abs(np.sqrt(estimate.values["J_z_prime"] / m) ** 2 - 0.0699) < 1e-4
    assert not estimate.valid


def test_added_mass_of_kvlcc2() -> None:
    published, estimate = kvlcc2_l7().values, added_mass(KVLCC2)
    assert estimate.valid
    for name, tolerance in (("m_x_prime", 0.10), ("m_y_prime", 0.03), ("J_z_prime", 0.03)):
        assert abs(estimate.values[name] / published[name] - 1) < tolerance


@pytest.mark.parametrize("method", [clarke, kijima, yoshimura])
def test_linear_derivatives_of_kvlcc2(method: type) -> None:
    published, values = kvlcc2_l7().values, method(KVLCC2).values
    for name in ("Y_v", "Y_r", "N_v", "N_r"):
        assert abs(values[name] / published[name] - 1) < 0.33, name


def test_errors_of_nonlinear_terms_are_those_on_two_published_ships() -> None:
    errors = dict[str, list[float]]()
    for ship in (kvlcc2_l7(), esso_osaka()):
        estimate = yoshimura(HullForm.from_ship(ship.ship))
        for name in estimate.deviations:
            if name in ship.values:
                errors.setdefault(name, []).append(ship.values[name] - estimate.values[name])
    for name, deviation in yoshimura(KVLCC2).deviations.items():
        assert deviation == pytest.approx(np.sqrt(np.mean(np.square(errors[name]))), rel=0.05), name


def test_every_hull_coefficient_has_an_estimate() -> None:
    from seatrial.physics.models.mmg import HULL

    assert set(yoshimura(KVLCC2).values) == set(HULL) - {"R_0"}
    assert set(interaction_coefficients(KVLCC2, 1.8).values) <= set(kvlcc2_l7().values)


def test_cross_flow_without_yaw_is_drag() -> None:
    fit = cross_flow_coefficients(1.0, 1.0, 1.0)
    v = 0.4
    assert abs(fit["Y_vvv"] * v**3 + v * abs(v)) < 0.06
    assert abs(fit["Y_vvr"]) < 1e-9
    assert fit["N_rrr"] < 0


def test_a_ship_without_beam_is_refused() -> None:
    with pytest.raises(InputError, match="lacks B, C_b"):
        HullForm.from_ship(Ship("raft", {"L": 3.0, "d": 0.2}))


@pytest.mark.parametrize("rho", [1000.0, 1025.0])
def test_the_block_coefficient_follows_from_a_stated_mass(rho: float) -> None:
    known = {"L": 3.0, "B": 0.5, "d": 0.2, "m": 210.0, "rho": rho}
    form = HullForm.from_ship(Ship("model", known))
    assert form.C_b == pytest.approx(210.0 / (rho * 0.3))
    assert displacement(form, rho).values["m"] == pytest.approx(210.0)
    assert HullForm.from_ship(Ship("model", known | {"C_b": 0.6})).C_b == 0.6
    with pytest.raises(InputError, match="lacks B for"):
        HullForm.from_ship(Ship("model", {"L": 3.0, "d": 0.2, "m": 210.0}))


def test_the_stated_scatter_is_that_of_two_published_tankers() -> None:
    ships = [(HullForm.from_ship(one.ship), one) for one in (kvlcc2_l7(), esso_osaka())]
    squares: dict[str, list[float]] = {}
    stated: dict[str, float] = {}
    for form, one in ships:
        rudder = one.ship.particulars["H_R"] ** 2 / one.ship.particulars["A_R"]
        for estimate in (interaction_coefficients(form, rudder), propulsion(form, 0.75, 0.5, 4)):
            stated |= estimate.deviations
            for name in estimate.deviations:
                squares.setdefault(name, []).append((estimate.values[name] - one.values[name]) ** 2)
    sides = squares.pop("gamma_R_plus") + squares.pop("gamma_R_minus")
    assert np.sqrt(np.mean(sides)) == pytest.approx(stated["gamma_R_plus"], abs=0.005)
    for name in ("t_P", "R_0"):  # whose scatter among ships is chosen, and larger
        assert np.sqrt(np.mean(squares.pop(name))) < stated[name]
    for name, values in squares.items():
        assert np.sqrt(np.mean(values)) == pytest.approx(stated[name], abs=0.01), name


def test_the_mass_is_that_of_the_displaced_water() -> None:
    form, particulars = HullForm.from_ship(kvlcc2_l7().ship), kvlcc2_l7().ship.particulars
    values = displacement(form, 1000.0).values
    assert values["m"] == pytest.approx(particulars["m"], rel=0.02)
    assert values["I_z"] == pytest.approx(particulars["I_z"], rel=0.02)
    assert interaction_wake(form) == interaction_coefficients(form, 1.8).values["w_P0"]


def test_the_quadratic_is_the_series_within_a_hundredth() -> None:
    J = np.linspace(0.0, 0.6, 13)
    for pitch_ratio in (0.6, 0.8, 1.0):
        k = thrust_quadratic(pitch_ratio, 0.55, 4)
        quadratic = k[0] + k[1] * J + k[2] * J**2
        np.testing.assert_allclose(quadratic, thrust_coefficient(J, pitch_ratio, 0.55, 4), atol=2e-3)


@pytest.mark.parametrize(
    ("ship", "pitch_ratio", "area_ratio", "blades"), [(kvlcc2_l7(), 0.721, 0.431, 4), (esso_osaka(), 0.715, 0.682, 5)]
)
def test_published_propellers_are_near(ship: ParameterSet, pitch_ratio: float, area_ratio: float, blades: int) -> None:
    """P/D, A_E/A_0 and blades of KVLCC2 (SIMMAN 2008) and Esso Osaka (Crane 1979); K_T of their MMG models."""
    J = np.linspace(0.0, 0.4, 9)
    published = ship.values["k_0"] + ship.values["k_1"] * J + ship.values["k_2"] * J**2
    np.testing.assert_allclose(thrust_coefficient(J, pitch_ratio, area_ratio, blades), published, rtol=0.09)


def test_more_pitch_gives_more_thrust() -> None:
    low, high = (thrust_coefficient(np.array([0.3]), pitch, 0.5, 4)[0] for pitch in (0.6, 1.0))
    assert 0.0 < low < high
