"""Empirical coefficients against published values of two hulls."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Ship
from seatrial.physics.hydro.empirical import (
    HullForm,
    added_mass,
    clarke,
    cross_flow_coefficients,
    interaction_coefficients,
    kijima,
    yoshimura,
)
from seatrial.physics.models.published import kvlcc2_l7

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
