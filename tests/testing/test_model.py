"""Models of others are checked as the built-in ones: what conforms passes, each violation has its sentence."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model, Sheet
from seatrial.physics.models import MODELS, model_named
from seatrial.physics.models.published import parameter_set, theoretical_coefficients
from seatrial.problems.twin_ships import twin_screw_ship
from seatrial.testing import ConformanceError, MirrorLaw, check_model

# parameters of the built-in models that change sign in the mirror (asymmetry, zeros, current), and those split by side
ODD = {"Y_0", "N_0", "Y_T", "N_T", "Y_dd", "N_dd", "Y_nn", "Y_nu", "N_nn", "N_nu", "delta_0", "current_east", "phi_0"}
SPLIT = {"C_2_plus": "C_2_minus", "gamma_R_plus": "gamma_R_minus", "command_1": "command_2"}
SPLIT |= {f"{n}_port": f"{n}_starboard" for n in ("c", "T", "zero", "span", "angle", "x", "y")}
ODD |= {"r_rest", "y_port", "y_starboard", "angle_port", "angle_starboard"}
LAW = MirrorLaw(frozenset(ODD), SPLIT)
TWINS = MirrorLaw(frozenset(ODD))  # the port side has the coefficients of the other side's flow


def complete(name: str) -> Model:
    """A built-in model with a value for every parameter."""
    if name == "mmg_twin":
        return twin_screw_ship()
    if name in ("mmg", "mmg_roll", "mmg_shallow"):
        rolling = {"GM": 0.1, "I_x": 600.0} if name == "mmg_roll" else {}
        return parameter_set("kvlcc2").applied_to(model_named(name).with_values(rolling))
    if name == "son_nomoto":
        return parameter_set("s175").applied_to(model_named(name))
    if name in ("heave_pitch", "heave_pitch_zoh"):
        return theoretical_coefficients(135).applied_to(model_named(name))
    model = model_named(name)
    return model.with_values(dict.fromkeys(model.parameters.missing, 1.0))


@pytest.mark.parametrize("name", sorted(MODELS))
def test_built_in_models_conform(name: str) -> None:
    law = TWINS if name == "mmg_twin" else LAW
    check_model(complete(name), None if name.startswith("heave_pitch") else law, points=5)


def steering(damping: float = 0.1, unit: str = "1/s", source: str = "Nomoto et al. 1957", cause: str = "") -> Model:
    """A first-order model, with a defect where `cause` names one."""
    sheet = Sheet("steering", source=source)
    r, delta = *sheet.states("r"), sheet.input("delta")
    a = sheet.parameter("a", damping, unit, "damping", free=True, lower=0.0)
    defects = {"": 0.0, "lopsided": r**2}
    sheet.rate(r, delta - a * r + defects[cause])
    return sheet.model()


def test_the_model_without_a_defect_conforms() -> None:
    check_model(steering(), MirrorLaw())


@pytest.mark.parametrize(
    ("model", "sentence"),
    [
        (lambda: steering(damping=float("nan")), "parameters without a value: a"),
        (lambda: steering(unit="furlong"), "'a' has the unit 'furlong'"),
        (lambda: steering(source=""), "names no source"),
        (lambda: steering(damping=-1.0), "lies outside its bounds"),
        (lambda: steering(cause="lopsided"), "'r' breaks the mirror law"),
        (lambda: model_named("nomoto").with_values({"T": 0.0}), "not finite"),
    ],
)
def test_violations_are_named(model, sentence: str) -> None:
    with pytest.raises(ConformanceError, match=sentence):
        check_model(model(), MirrorLaw())


def test_a_wrong_jacobian_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    model = steering()
    right = model.compiled

    def wrong(t: float, x: np.ndarray, u: np.ndarray, p: np.ndarray, out: np.ndarray, jacobian: np.ndarray) -> None:
        right.rates_tangent(t, x, u, p, out, jacobian)
        jacobian[0, 0] *= 1.01

    monkeypatch.setattr(Model, "compiled", property(lambda _: replace(right, rates_tangent=wrong)))
    with pytest.raises(ConformanceError, match=r"d\(r\)/d\(r\) is -0\.101, off by 0\.001"):
        check_model(model)
