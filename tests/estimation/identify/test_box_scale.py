"""The stiffness of a box hull and its wave forces are one factor, which motions in waves alone do not show."""

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.identify.identifiability import box_scale, consequences
from seatrial.physics.models.heave_pitch import heave_pitch
from seatrial.physics.models.published import HEAVE_PITCH_STIFFNESSES, theoretical_coefficients
from seatrial.physics.simulate import replay

LABEL = "c33, c35, c53 and c55 with the forces of the box"


@pytest.fixture(scope="module")
def model() -> Model:
    return theoretical_coefficients(135).applied_to(heave_pitch())


@pytest.fixture(scope="module")
def found(model: Model) -> Estimation:
    return fitted(model, wave_forces(1.0), model)


def wave_forces(factor: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Forces of two regular waves, a factor larger than those that moved the ship."""
    time = 0.25 * np.arange(241)
    F3 = 4e5 * np.cos(1.1 * time) + 3e5 * np.cos(1.9 * time + 1.0)
    M5 = 5e6 * np.sin(1.1 * time) + 6e6 * np.cos(1.9 * time)
    return time, {"F3": factor * F3, "M5": factor * M5, "delta_f1": 0.0 * time, "delta_f2": 0.0 * time}


def fitted(
    model: Model,
    forces: tuple[np.ndarray, dict[str, np.ndarray]],
    truth: Model,
    method: EstimateMethod = EstimateMethod.OUTPUT_ERROR,
) -> Estimation:
    time, inputs = forces
    moved = replay(truth, Record.from_arrays("run", time, wave_forces(1.0)[1]), dict.fromkeys(truth.states, 0.0))
    noise = np.random.default_rng(2)
    motion = {
        "z": moved["z"] + 1e-3 * noise.standard_normal(241),
        "theta": moved["theta"] + 1e-4 * noise.standard_normal(241),
    }
    record = Record.from_arrays("run", time, {**inputs, **motion})
    settings = EstimateSettings(method=method)
    return estimate_model(model, Runs.one_session_each([record], 60.0), settings, EstimatorOptions(workers=1))


def test_every_coefficient_follows_the_stiffness_as_a_fit_with_ten_per_cent_more_shows(
    model: Model, found: Estimation
) -> None:
    stated = next(c for c in consequences(found, is_on_box=True) if c.parameter == LABEL)
    larger = model.with_values({n: 1.1 * model.parameters[n].value for n in HEAVE_PITCH_STIFFNESSES})
    again = fitted(larger, wave_forces(1.1), model)
    for name, change in stated.estimate_changes.items():
        before, after = (e.model.parameters[name].value for e in (found, again))
        assert after / before - 1.0 == pytest.approx(change, rel=1e-3, abs=1e-4)
    assert stated.misfit == pytest.approx(0.0, abs=1e-6)


def test_changes_are_over_the_final_estimate_where_another_one_was_simulated(model: Model) -> None:
    found = fitted(model, wave_forces(1.0), model, EstimateMethod.PREDICTION_ERROR)
    assert found.has_process_noise
    assert (
        found.model.parameters["b35"].value
        != found.shooting.common_parameters[found.shooting.problem.free.index("b35")]
    )
    stated = next(c for c in consequences(found, is_on_box=True) if c.parameter == LABEL)
    m, a33 = (found.model.parameters[n].value for n in ("m", "a33"))
    expected = {"b35": 0.1, "b53": 0.1, "b33": 0.1, "a33": 0.1 * (m + a33) / a33}
    assert {n: stated.estimate_changes[n] for n in expected} == pytest.approx(expected, rel=1e-6)


def test_no_single_stiffness_is_named_beside_it(found: Estimation) -> None:
    assert not {c.parameter for c in consequences(found, is_on_box=True)} & set(HEAVE_PITCH_STIFFNESSES)


def test_the_factor_is_a_symmetry_unless_a_fin_of_known_lift_moves_the_ship(model: Model) -> None:
    scale = box_scale(model)
    assert scale is not None
    symmetry = scale.symmetry(model, ("z", "theta"))
    assert symmetry is not None
    m, a33 = (model.parameters[n].value for n in ("m", "a33"))
    assert symmetry.change["a33"] == pytest.approx((m + a33) / a33)
    assert symmetry.change["b33"] == symmetry.change["c55"] == 1.0
    assert scale.symmetry(model.with_values({"lift_1": 1e5}), ("z", "theta")) is None


def test_where_stiffness_is_estimated_nothing_is_stated(model: Model) -> None:
    assert box_scale(model.with_parameters(model.parameters.freed("c33"))) is None
