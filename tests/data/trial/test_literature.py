"""Priors by the name of their source: values, citations, ranges and what is refused."""

import pytest

from seatrial.core.values import InputError, Severity, Ship
from seatrial.data.trial.model_table import build_trial_model
from seatrial.data.trial.priors import literature_priors, prior_range_findings
from seatrial.data.trial.schema import ModelTable
from seatrial.physics.hydro.empirical import CLARKE, HullForm, clarke, yoshimura
from seatrial.physics.models.published import HIGHER_ORDER_SPREAD, kvlcc2_l7

TANKER = kvlcc2_l7().ship


def table(**keys: object) -> ModelTable:
    """`[model]` of the MMG model."""
    return ModelTable.model_validate({"name": "mmg"} | keys)


def test_priors_and_starts_come_from_the_source_and_cite_it() -> None:
    sources = {"priors_from": ["kvlcc2", "clarke"], "prior_sd_percent": 25}
    model = build_trial_model(table(**sources), TANKER)
    mean = clarke(HullForm.from_ship(TANKER)).values["Y_v"]
    p = model.parameters["Y_v"]
    assert p.prior is not None
    assert (p.value, p.prior.mean) == (mean, mean)
    assert p.prior.standard_deviation == pytest.approx(0.25 * abs(mean))
    assert p.source == p.prior.source == CLARKE
    cubic = model.parameters["Y_vvv"].prior
    assert cubic is not None
    assert cubic.mean == -1.607, "what the later source does not name stays with the earlier one"
    assert "Yasukawa" in cubic.source


def test_a_start_of_its_own_keeps_its_source_beside_the_priors() -> None:
    keys = {"parameter_set": "kvlcc2", "priors_from": "clarke", "prior_sd_percent": 25, "start": {"N_r": -0.05}}
    model = build_trial_model(table(**keys), TANKER)
    assert model.parameters["Y_v"].value == -0.315
    assert "Yasukawa" in model.parameters["Y_v"].source
    assert f"prior: {CLARKE}" in model.parameters["Y_v"].source
    assert model.parameters["N_r"].value == -0.05
    prior = model.parameters["N_r"].prior
    assert prior is not None
    assert prior.mean == clarke(HullForm.from_ship(TANKER)).values["N_r"]


def test_stated_priors_win() -> None:
    keys = {"parameter_set": "kvlcc2", "priors_from": "clarke", "prior_sd_percent": 25}
    model = build_trial_model(table(**keys, priors={"Y_v": {"mean": -0.4, "sd": 0.01, "source": "own"}}), TANKER)
    prior = model.parameters["Y_v"].prior
    assert prior is not None
    assert (prior.mean, prior.standard_deviation, prior.source) == (-0.4, 0.01, "own")


def test_a_fixed_value_of_a_source_keeps_its_spread() -> None:
    """It is what intervals hold of it; a value of the user's own has none."""
    keys = {"priors_from": ["kvlcc2", "propulsion"], "prior_sd_percent": 25, "free": ["Y_v"]}
    by_formula = build_trial_model(table(**keys), TANKER).parameters["t_P"]
    assert by_formula.prior is not None and not by_formula.free
    assert (by_formula.prior.mean, by_formula.prior.standard_deviation) == (by_formula.value, 0.05)
    for own in ({"parameter_set": "kvlcc2"}, {"fixed": {"t_P": 0.2}}):
        assert build_trial_model(table(**keys, **own), TANKER).parameters["t_P"].prior is None


def test_terms_beyond_the_linear_ones_are_near_zero_without_dimensions_of_the_hull() -> None:
    keys = {"name": "abkowitz", "priors_from": "higher_order", "free": ["N_d", "N_vvr"], "start": {"U_n": 6.0}}
    boat = Ship("boat", {"L": 8.0, "m": 3000.0, "x_G": 0.0, "I_z": 12000.0, "rho": 1025.0})
    parameters = build_trial_model(ModelTable.model_validate(keys), boat).parameters
    prior, held = parameters["N_vvr"].prior, parameters["X_dd"]
    assert prior is not None and (prior.mean, prior.standard_deviation) == (0.0, HIGHER_ORDER_SPREAD["N_vvr"])
    assert parameters["N_d"].prior is None
    assert not held.free and held.prior is not None, "what is held at zero all the same widens the intervals"


def test_later_sources_win() -> None:
    form = HullForm.from_ship(TANKER)
    both = literature_priors(("clarke", "yoshimura"), TANKER, "mmg")
    assert both["Y_v"].mean == yoshimura(form).values["Y_v"]
    assert literature_priors(("yoshimura", "clarke"), TANKER, "mmg")["Y_v"].mean == clarke(form).values["Y_v"]


def test_a_ship_outside_the_range_is_warned_of() -> None:
    assert prior_range_findings(("yoshimura", "kvlcc2"), TANKER) == ()
    barge = Ship("barge", {"L": 60.0, "B": 30.0, "d": 2.0, "C_b": 0.95})
    (finding,) = prior_range_findings(("clarke",), barge)
    assert (finding.severity, finding.code) == (Severity.WARNING, "prior-range")
    assert "L/B 2" in finding.text
    assert "L/B 5-8" in finding.text


def test_what_cannot_be_is_refused() -> None:
    for names, model, ship, sentence in (
        (("clark",), "mmg", TANKER, "unknown source 'clark'.*clarke"),
        (("clarke",), "abkowitz", TANKER, "'clarke' gives coefficients of model 'mmg'.*not of 'abkowitz'"),
        (("higher_order",), "mmg", TANKER, "'higher_order' gives coefficients of model 'abkowitz'.*not of 'mmg'"),
        (("kvlcc2",), "waterjet", TANKER, "'kvlcc2' gives coefficients of model 'mmg'"),
        (("clarke",), "mmg", Ship("s", {"L": 60.0}), "lacks B, d, C_b"),
        (("interaction",), "mmg", Ship("s", {"L": 7.0, "B": 1.2, "d": 0.4, "C_b": 0.8}), "lacks H_R and A_R"),
    ):
        with pytest.raises(InputError, match=sentence):
            literature_priors(names, ship, model)
    with pytest.raises(InputError, match="priors_from says nothing about how far"):
        build_trial_model(table(parameter_set="kvlcc2", priors_from="clarke"), TANKER)
