"""What is said of estimated values is what another fit with other ones does."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.independent_ships import CRAFTS, FAULTS, posed

from seatrial.core.equations import Model
from seatrial.core.values import NOT_MEASURED, Array, Finding, Prior, Record, Severity
from seatrial.data.example_series import simulate_run, true_model, with_sensor_noise
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.data.trial.plausibility import ESTIMATED_VALUES
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import fit_output_error
from seatrial.estimation.identify import EstimatorOptions, Runs, estimate_model, identify
from seatrial.estimation.identify.assumed_values import (
    EstimatedValueEffect,
    _wrong_together,
    estimated_value_effects,
    estimated_value_shifts,
    finding_with_effects,
    with_effects,
    with_estimated_values,
)

FOUND = Finding(Severity.WARNING, ESTIMATED_VALUES, f"m_y is {NOT_MEASURED}", "marked", "measure", "only as far")
OTHER = Finding(Severity.WARNING, "lag", "another one")


def model() -> Model:
    """Few coefficients are free, so that a wrong added mass shows in them."""
    one = true_model()
    return one.with_parameters(one.parameters.only_free(["Y_v", "N_v", "N_r", "N_rr"]))


def estimated(name: str, factor: float = 1.0) -> Model:
    value = model().parameters[name].value
    return model().with_values({name: factor * value}, source=f"{NOT_MEASURED}: a rule")


@pytest.fixture(scope="module")
def record() -> Record:
    return with_sensor_noise(simulate_run(true_model(), "zigzag:20/20").resampled(1.0), np.random.default_rng(3), 3)


def fitted(one: Model, record: Record) -> Estimation:
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    return estimate_model(one, Runs.one_session_each([record], 9.8), settings, EstimatorOptions(workers=1))


def refitted(centre: Estimation, factor: float) -> Array:
    """The coefficients with another added mass, by the same objective: noise and effective numbers are held."""
    problem, optimum = centre.estimate.problem, centre.estimate.optimum
    other = problem.model.with_values({"m_y": factor * problem.model.parameters["m_y"].value})
    again = replace(problem, model=other)
    noise = dict(zip(problem.data.outputs, problem.noise.tolist(), strict=True))
    return fit_output_error(
        again, centre.estimate.common_parameters, optimum.local, noise, colour_rounds=0
    ).common_parameters  # fmt: skip


def test_the_change_is_that_of_a_fit_with_the_other_value(record: Record) -> None:
    centre = fitted(estimated("m_y"), record)
    (effect,) = estimated_value_effects(centre, estimated_value_shifts(centre))
    assert effect.name == "m_y" and effect.error == 0.1
    place = centre.estimate.problem.free.index(effect.coefficient)
    before, after = (refitted(centre, f)[place] for f in (0.995, 1.005))
    change = (after - before) / 0.01 * 0.1
    assert effect.share_of_interval == pytest.approx(abs(change) / centre.interval.half_width[place], rel=0.1)
    assert effect.relative_change == pytest.approx(change / centre.model.parameters[effect.coefficient].value, rel=0.1)


def test_without_estimated_values_no_information_is_computed(record: Record) -> None:
    found = fitted(model(), record)
    assert estimated_value_shifts(found) == () and with_estimated_values(found, ()) is found


def test_intervals_of_coefficients_hold_the_error_of_an_estimated_value(record: Record) -> None:
    """With the value 10 % off, the truth is two half intervals away at the value stated, and inside with its error."""
    found = fitted(estimated("m_y", 1.1), record)
    widened = with_estimated_values(found, estimated_value_shifts(found))
    truth = np.array([true_model().parameters[name].value for name in found.estimate.problem.free])
    away = np.abs(found.estimate.common_parameters[: len(truth)] - truth)
    assert np.max(away / found.interval.half_width[: len(truth)]) > 2.0
    assert np.all(away < widened.interval.half_width[: len(truth)])
    assert widened.interval.meaning.endswith("with m_y wrong by 10 % (standard deviation)")


@pytest.mark.long(every=2)
@pytest.mark.parametrize("name", ["c55", "I5"])
def test_intervals_hold_what_the_source_of_a_fixed_value_leaves_open(name: str) -> None:
    """A craft by its own equations, a stiffness or an inertia fixed one standard deviation of its source too high."""
    craft = CRAFTS["heave and pitch"]
    trial = posed(craft, FAULTS["clean"], 0)
    right = trial.model.parameters[name].value
    wrong = trial.model.with_values({name: 1.1 * right})

    def misses(one: Model) -> set[str]:
        fit = identify(replace(trial, model=one))
        ends = {c.name: (c.lower, c.upper) for c in fit.coefficients if c.name in craft.truth}
        return {n for n, (low, high) in ends.items() if not (low or 0.0) <= craft.truth[n] <= (high or 0.0)}

    assert "a55" in misses(wrong)
    assert not misses(wrong.with_parameters(wrong.parameters.with_priors({name: Prior(1.1 * right, 0.1 * right)})))


def effects(*shares: float) -> tuple[EstimatedValueEffect, ...]:
    return tuple(EstimatedValueEffect(f"m_{k}", 0.1, "Y_v", 0.2, share, 0.02) for k, share in enumerate(shares))


@pytest.mark.parametrize(("share", "prediction", "matters"), [
    (0.9, 0.9, False), (1.1, 0.0, True), (0.0, 1.1, True),
])  # fmt: skip
def test_a_value_matters_by_a_coefficient_or_by_predictions(share: float, prediction: float, *, matters: bool) -> None:
    assert EstimatedValueEffect("m", 0.1, "Y_v", 0.2, share, prediction).matters is matters


def test_what_matters_is_named_the_worst_first() -> None:
    warned = finding_with_effects(FOUND, effects(5.0, 4.0, 3.0, 2.0, 0.5, 0.1))
    assert warned.severity is Severity.WARNING and warned.message == FOUND.message
    assert warned.evidence.startswith(
        "m_0 10 % larger moves Y_v by +20 % (5.0 of half its interval by the records alone), and predictions"
    )
    assert "; m_3 too; m_4 and m_5 matter less; intervals of coefficients hold these errors" in warned.evidence
    assert warned.advice.startswith("measure m_0")


def test_where_none_matters_it_is_a_note() -> None:
    noted = finding_with_effects(FOUND, effects(0.5, 0.1))
    assert noted.severity is Severity.INFO and noted.evidence.startswith("none of them matters much: m_0 10 % larger")
    unheld = finding_with_effects(FOUND, ())
    assert unheld.severity is Severity.INFO and "holds none of them" in unheld.evidence


def test_other_findings_pass_unchanged(record: Record) -> None:
    other, of_values = with_effects((OTHER, FOUND), fitted(model(), record), ())
    assert other is OTHER and of_values == finding_with_effects(FOUND, ())


def test_of_an_open_sign_no_share_is_given() -> None:
    text = EstimatedValueEffect("D_P", 0.1, "w_P0", math.nan, 1.6, 0.018).sentence
    assert "moves w_P0 by 1.6 of half its interval by the records alone, and" in text and "nan" not in text


def test_levers_of_thrusters_are_wrong_together() -> None:
    """Both are estimated from one breadth: a lever of one side alone that is off makes the craft pull to a side."""
    together = {"y_port and y_starboard": ["y_port", "y_starboard"], "m": ["m"]}
    assert _wrong_together(["m", "y_port", "y_starboard"]) == together


def test_what_is_estimated_from_the_form_of_a_hull_is_wrong_with_its_mass_and_by_itself() -> None:
    assert _wrong_together(["m", "I_z", "rho"]) == {"m": ["m", "I_z"], "I_z": ["I_z"], "rho": ["rho"]}
    assert _wrong_together(["I_z"]) == {"I_z": ["I_z"]}
