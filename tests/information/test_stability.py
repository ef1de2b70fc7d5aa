"""Course stability against the determinant written by hand, and its interval against drawn ships."""

import numpy as np
import pytest

from seatrial.information.stability import stability, straight_course
from seatrial.models.nomoto import nomoto
from seatrial.models.published import kvlcc2
from seatrial.models.waterjet import waterjet

SPEED = 0.8


def index_by_hand(values: dict[str, float]) -> float:
    """det of the sway-yaw equations of Song et al. 2025, eq. (1) linearised at v = r = 0, times (L/u)^2."""
    q, L, u = values["rho"] * values["L"] * values["d"] / 2, values["L"], SPEED
    sway, yaw = values["m"] + values["m_y"], values["I_z"] + values["J_z"]
    a = np.array(
        [
            [q * values["Y_v"] * u / sway, (q * values["Y_r"] * L * u - (values["m"] + values["m_x"]) * u) / sway],
            [q * L * values["N_v"] * u / yaw, q * L * values["N_r"] * L * u / yaw],
        ]
    )
    return float(np.linalg.det(a)) * (L / u) ** 2


def test_the_index_is_the_determinant_of_sway_and_yaw() -> None:
    model = waterjet()
    values = dict(zip(model.parameters.names, model.parameters.values, strict=True))
    found = stability(model, np.zeros((11, 11)), np.inf, SPEED, np.array([0.0, 1.866]), values["L"])
    assert found is not None
    assert found.index == pytest.approx(index_by_hand(values), rel=1e-9)
    assert found.lower == found.upper == found.index


def test_the_interval_is_that_of_drawn_ships(rng: np.random.Generator) -> None:
    model, inputs = waterjet(), np.array([0.0, 1.866])
    names = model.parameters.free_names
    spread = 0.01 * np.abs([model.parameters[n].value for n in names])
    found = stability(model, np.diag(spread**2), np.inf, SPEED, inputs, 9.8)
    drawn = [
        np.linalg.det(straight_course(model.with_values(dict(zip(names, values, strict=True))), SPEED, inputs))
        for values in np.array([model.parameters[n].value for n in names]) + spread * rng.standard_normal((2000, 11))
    ]
    assert found is not None
    half = 1.96 * float(np.std(drawn)) * (9.8 / SPEED) ** 2
    assert found.upper - found.index == pytest.approx(half, rel=0.1)


def test_words_follow_the_sign_and_the_interval() -> None:
    model, inputs = kvlcc2(), np.array([0.0, 10.4, 0.0, 0.0])
    certain, vague = (
        stability(model, spread * np.eye(len(model.parameters.free)), 11, 1.18, inputs, 7.0) for spread in (1e-8, 1.0)
    )
    assert certain is not None and vague is not None
    assert certain.index < 0 and "unstable on her course" in certain.text
    assert "cannot be told" in vague.text


def test_a_model_of_yaw_alone_is_stable_where_its_time_constant_is_positive() -> None:
    model = nomoto().with_values({"K": 0.1, "T": 8.0})
    found = stability(model, np.zeros((len(model.parameters.free),) * 2), np.inf, 2.0, np.zeros(1), 16.0)
    assert found is not None
    assert found.index == pytest.approx(1.0)
    assert "dies out by a factor e in 1 ship lengths" in found.text
