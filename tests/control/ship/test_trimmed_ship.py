"""Plants of identified models against closed forms, python-control's linearisation, and quadrature over a swing."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.control.ship import (
    linearise,
    one_sided_plants,
    plant_and_disturbance,
    plant_text,
    rate_response,
    trim_ship,
    with_parameters,
)
from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.data.folder.model_file import ModelFile, ModelProvenance
from seatrial.physics.models import model_named
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.simulate import linear as harmonics

HULL = {"m": 3000.0, "I5": 9000.0, "c33": 8e4, "c55": 2.5e5, "c35": 4e3, "c53": 4e3}
COEFFICIENTS = {"a33": 2500.0, "a35": 300.0, "a53": 200.0, "a55": 7000.0}
DAMPING = {"b33": 9000.0, "b35": 900.0, "b53": -700.0, "b55": 2.4e4}
FIN = {"lift_1": 5e3, "x_f1": 3.0}
ROLL = {"b_1": 0.02, "b_2": 0.3, "b_3": 0.4, "c_1": 1.2, "c_3": -0.6, "c_5": 0.2, "K_alpha": 0.3}


def of(model: Model, **values: float) -> ModelFile:
    """A model file of known values."""
    return ModelFile(model.with_values(values))


def test_warnings_of_the_fit_go_with_the_ship() -> None:
    file = replace(of(model_named("nomoto"), K=0.2, T=5.0), provenance=ModelProvenance(warnings=("it diverges",)))
    assert trim_ship(file, output="psi", actuator="delta").warnings == ("it diverges",)


@given(K=st.floats(-0.5, 0.5).filter(lambda k: abs(k) > 1e-3), T=st.floats(0.5, 200.0))
def test_a_nomoto_ship_is_k_over_s_and_t_s_plus_one(K: float, T: float) -> None:
    plant, disturbance = plant_and_disturbance(
        trim_ship(of(model_named("nomoto"), K=K, T=T), output="psi", actuator="delta")
    )
    assert plant.num == pytest.approx((K / T,), rel=1e-14)
    assert plant.den == pytest.approx((1.0, 1.0 / T, 0.0), rel=1e-14, abs=0.0)
    assert disturbance is plant


def test_the_second_order_has_its_zero() -> None:
    made = of(model_named("nomoto2"), K=0.2, T_1=27.0, T_2=3.0, T_3=9.0)
    plant, _ = plant_and_disturbance(trim_ship(made, output="psi", actuator="delta"))
    assert plant.num == pytest.approx(tuple(0.2 * np.array([9.0, 1.0]) / 81.0), rel=1e-12)
    assert plant.den == pytest.approx((*np.polymul([1.0, 1.0 / 27.0], [1.0, 1.0 / 3.0]), 0.0), rel=1e-12, abs=0.0)


@pytest.mark.parametrize(
    ("name", "output", "actuator", "order"), [("waterjet", "psi", "delta", 3), ("waterjet", "u", "v_j", 1)]
)
def test_a_manoeuvring_model_is_linearised_as_python_control_does(
    name: str, output: str, actuator: str, order: int
) -> None:
    import control

    ship = trim_ship(ModelFile(model_named(name), approach={"v_j": 1.866}), output=output, actuator=actuator)
    model = ship.model

    def rates(_t: float, x: Array, u: Array, _params: object) -> Array:
        out = np.empty(len(x))
        model.compiled.rates(0.0, np.ascontiguousarray(x), np.ascontiguousarray(u), model.parameters.values, out)
        return out

    system = control.nlsys(rates, None, inputs=len(model.inputs), states=len(model.states), outputs=len(model.states))
    linear = system.linearize(ship.state, ship.inputs, eps=1e-6)
    row, column = model.states.index(output), model.input_names.index(actuator)
    turned = -1.0 if model.inputs[column].is_reversed else 1.0
    omega = np.geomspace(1e-3, 10.0, 30)
    plant, _ = plant_and_disturbance(ship)
    expected = turned * np.array([linear(1j * w)[row, column] for w in omega])
    assert plant.frequency_response(omega) == pytest.approx(expected, rel=1e-4)
    assert plant.order == order


def test_a_positive_rudder_turns_to_starboard_whichever_way_the_model_has_it() -> None:
    for model, drive in ((model_named("waterjet"), {"v_j": 1.866}), (kvlcc2(), {"n": 10.23})):
        plant, _ = plant_and_disturbance(trim_ship(ModelFile(model, approach=drive), output="psi", actuator="delta"))
        assert plant.num[0] > 0.0
        assert plant.den[-1] == 0.0


def test_a_kink_on_the_straight_course_is_taken_in_the_middle() -> None:
    ship = trim_ship(ModelFile(kvlcc2(), approach={"n": 10.23}), output="r", actuator="delta")
    plant, _ = plant_and_disturbance(ship)
    starboard, port = one_sided_plants(ship)
    assert starboard.den[1] != pytest.approx(port.den[1], rel=1e-3)
    assert plant.den[1] == pytest.approx(0.5 * (starboard.den[1] + port.den[1]), rel=1e-9)


def test_a_speed_asked_for_is_kept_by_what_drives_it() -> None:
    ship = trim_ship(ModelFile(kvlcc2(), approach={"n": 10.23}), output="u", actuator="n", speed=0.9)
    model, rates = ship.model, np.empty(6)
    model.compiled.rates(0.0, ship.state.copy(), ship.inputs.copy(), model.parameters.values, rates)
    assert ship.state[0] == pytest.approx(0.9, rel=1e-9)
    assert rates[:3] == pytest.approx(np.zeros(3), abs=1e-10)
    half = trim_ship(ModelFile(kvlcc2(), approach={"n": 10.23}), output="u", actuator="n", speed=0.45)
    assert ship.inputs == pytest.approx(2.0 * half.inputs, rel=1e-4)


def test_the_rudder_carries_asymmetry() -> None:
    file = of(model_named("nomoto"), delta_0=0.03)
    ship = trim_ship(file, output="psi", actuator="delta")
    assert ship.inputs[0] == pytest.approx(-0.03, abs=1e-12)
    again = with_parameters(ship, {"delta_0": -0.01})
    assert again.inputs[0] == pytest.approx(0.01, abs=1e-12)


def test_heave_and_pitch_answer_as_the_frequency_response_does() -> None:
    model = model_named("heave_pitch").with_values(HULL | COEFFICIENTS | DAMPING | FIN)
    omega = np.geomspace(0.2, 20.0, 25)
    known = harmonics.frequency_response(harmonics.linear_system(model, ("z", "theta")), omega)
    for row, output in enumerate(("z", "theta")):
        for disturbance in ("F3", "M5"):
            ship = trim_ship(ModelFile(model), output=output, actuator="delta_f1", disturbance=disturbance)
            for block, name in zip(plant_and_disturbance(ship), ("delta_f1", disturbance), strict=True):
                column = model.input_names.index(name)
                sign = -1.0 if model.inputs[column].is_reversed else 1.0
                assert block.frequency_response(omega) == pytest.approx(sign * known[:, row, column], rel=1e-9)


def test_a_bow_fin_that_lifts_raises_the_bow() -> None:
    model = model_named("heave_pitch").with_values(HULL | COEFFICIENTS | DAMPING | FIN | {"c35": 0.0, "c53": 0.0})
    plant, _ = plant_and_disturbance(trim_ship(ModelFile(model), output="theta", actuator="delta_f1", disturbance="M5"))
    assert plant.gain == pytest.approx(5e3 * 3.0 / 2.5e5, rel=1e-9)


def test_roll_is_linearised_by_first_harmonic_and_energy() -> None:
    ship = trim_ship(
        of(model_named("roll"), phi_0=0.02, **ROLL), output="phi", actuator="alpha_f", disturbance="alpha_w"
    )
    a = 0.25
    plant, disturbance = plant_and_disturbance(ship, a)
    theta = (np.arange(4000) + 0.5) * 2.0 * np.pi / 4000
    phi = a * np.sin(theta)
    restoring = ROLL["c_1"] * phi + ROLL["c_3"] * phi**3 + ROLL["c_5"] * phi**5
    assert plant.den[2] == pytest.approx(2.0 * np.mean(restoring * np.sin(theta)) / a, rel=1e-9)
    omega = np.sqrt(plant.den[2])
    p = a * omega * np.cos(theta)
    moment = ROLL["b_1"] * p + ROLL["b_2"] * p * np.abs(p) + ROLL["b_3"] * p**3
    assert plant.den[1] == pytest.approx(2.0 * np.mean(moment * np.cos(theta)) / (a * omega), rel=1e-3)
    assert plant.num == pytest.approx((0.3 * 1.2,))
    assert disturbance.num == pytest.approx((1.2,))
    assert ship.state[0] == pytest.approx(0.02)
    assert plant_and_disturbance(ship)[0].den == pytest.approx((1.0, 0.02, 1.2))


def test_a_ship_unstable_on_its_course_is_said_to_be() -> None:
    file = ModelFile(kvlcc2(), approach={"n": 10.23})
    unstable = with_parameters(trim_ship(file, output="psi", actuator="delta"), {"N_v": -0.14, "Y_v": -0.2})
    poles = plant_and_disturbance(unstable)[0].poles.real
    assert poles.max() > 0.0
    assert f"grows by a factor e in {1.0 / poles.max():.3g} s" in plant_text(unstable)
    assert "unstable" not in plant_text(trim_ship(of(model_named("nomoto")), output="psi", actuator="delta"))


def test_matrices_are_those_of_finite_differences() -> None:
    ship = trim_ship(ModelFile(kvlcc2(), approach={"n": 10.23}), output="psi", actuator="delta", speed=1.1)
    model, h = ship.model, 1e-5
    made = linearise(ship)

    def rates(x: Array) -> Array:
        out = np.empty(len(x))
        model.compiled.rates(0.0, x, ship.inputs.copy(), model.parameters.values, out)
        return out

    steps = h * np.eye(len(ship.state))
    differences = np.stack([(rates(ship.state + s) - rates(ship.state - s)) / (2.0 * h) for s in steps], axis=1)
    assert pytest.approx(differences, abs=2e-4) == made.A


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ({"output": "phi", "actuator": "delta"}, "no output"),
        ({"output": "psi", "actuator": "n"}, "no input"),
        ({"output": "psi", "actuator": "delta", "disturbance": "waves"}, "no input"),
        ({"output": "u", "actuator": "delta"}, "no effect"),
        ({"output": "psi", "actuator": "delta", "inputs": {"v_j": 0.0}}, "no steady speed"),
        ({"output": "psi", "actuator": "delta", "speed": 2.0, "inputs": {"v_j": 1.866}}, "not both"),
        ({"output": "psi", "actuator": "delta", "speed": -1.0}, "positive"),
    ],
)
def test_what_cannot_be_is_refused(names: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        trim_ship(ModelFile(model_named("waterjet"), approach={"v_j": 1.866}), **names)


def test_fins_without_effect_and_swings_that_do_not_come_back_are_refused() -> None:
    with pytest.raises(InputError, match="K_alpha"):
        trim_ship(of(model_named("roll")), output="phi", actuator="alpha_f")
    soft = of(model_named("roll"), K_alpha=0.3, c_3=-5.0)
    with pytest.raises(InputError, match="does not come back"):
        plant_and_disturbance(trim_ship(soft, output="phi", actuator="alpha_f"), 0.6)


def test_a_model_of_one_speed_refuses_another() -> None:
    file = of(model_named("nomoto"), U=5.0)
    with pytest.raises(InputError, match="where it was identified"):
        trim_ship(file, output="psi", actuator="delta", speed=8.0)
    silent = replace(file, model=file.model.with_values({"U": 0.0}))
    assert trim_ship(silent, output="psi", actuator="delta", speed=8.0).model.parameters["U"].value == 8.0


def test_a_yaw_acceleration_reaches_the_heading_through_the_ship() -> None:
    """r' = a - r / T of a Nomoto ship: psi = a / (s (s + 1 / T)); a state that is not there is refused."""
    model = model_named("nomoto").with_values({"K": 0.2, "T": 8.0})
    ship = trim_ship(ModelFile(model), output="psi", actuator="delta")
    w = np.geomspace(0.01, 1.0, 10)
    path = rate_response(ship, "r")
    np.testing.assert_allclose(path.frequency_response(w), 1.0 / (1j * w * (1j * w + 0.125)), rtol=1e-9)
    with pytest.raises(InputError, match="has no state 'q'"):
        rate_response(ship, "q")
