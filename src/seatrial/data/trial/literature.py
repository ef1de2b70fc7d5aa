"""Priors by the name of their source: published sets of coefficients, or formulas in the ship's main dimensions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from seatrial.core.values import Finding, InputError, Severity, Ship, spelling_hint
from seatrial.physics.hydro.dispersion import SEA_WATER
from seatrial.physics.hydro.empirical import (
    EmpiricalEstimate,
    HullForm,
    added_mass,
    clarke,
    displacement,
    interaction_coefficients,
    kijima,
    propulsion,
    yoshimura,
)
from seatrial.physics.models.published import PARAMETER_SETS, parameter_set
from seatrial.physics.models.typical_wind import SYMMETRIC, TYPICAL, TYPICAL_SPREAD

USUAL_PROPELLER = {"pitch_ratio": 0.75, "area_ratio": 0.5, "blades": 4.0}
"""P/D, A_E/A_0 and blades where `[ship]` does not state them; chosen: a merchant ship's fixed propeller."""


@dataclass(frozen=True)
class LiteraturePrior:
    """What a source says about one parameter; deviation 0: not how far it may be wrong."""

    mean: float
    source: str
    deviation: float = 0.0


def _interaction(form: HullForm, ship: Ship) -> EmpiricalEstimate:
    missing = [n for n in ("H_R", "A_R") if n not in ship.particulars]
    if missing:
        raise InputError(
            f"ship '{ship.name}' lacks {' and '.join(missing)} for priors_from = \"interaction\"; add it under [ship]"
        )
    return interaction_coefficients(form, ship.particulars["H_R"] ** 2 / ship.particulars["A_R"])


def _propulsion(form: HullForm, ship: Ship) -> EmpiricalEstimate:
    stated = {name: ship.particulars.get(name, usual) for name, usual in USUAL_PROPELLER.items()}
    return propulsion(form, stated["pitch_ratio"], stated["area_ratio"], round(stated["blades"]))


def _displacement(form: HullForm, ship: Ship) -> EmpiricalEstimate:
    return displacement(form, ship.particulars.get("rho", SEA_WATER))


FORMULAS: dict[str, Callable[[HullForm, Ship], EmpiricalEstimate]] = {
    "clarke": lambda form, _: clarke(form),
    "kijima": lambda form, _: kijima(form),
    "yoshimura": lambda form, _: yoshimura(form),
    "zhou": lambda form, _: added_mass(form),
    "interaction": _interaction,
    "propulsion": _propulsion,
    "displacement": _displacement,
    "wind": lambda _, __: EmpiricalEstimate(SYMMETRIC, TYPICAL, True, "any craft", TYPICAL_SPREAD),
}
_FORMULA_MODEL = "mmg"


def literature_priors(names: Sequence[str], ship: Ship, model: str) -> dict[str, LiteraturePrior]:
    """Means and citations by parameter; where two sources name a parameter the later one wins.

    Formulas are for the model mmg; published sets are for the model they were made for.

    Raises:
        InputError: an unknown source, one for another model, or a ship without the particulars a formula needs.
    """
    priors: dict[str, LiteraturePrior] = {}
    for source_name in names:
        _require_source_for_model(source_name, model)
        if source_name in FORMULAS:
            estimate = FORMULAS[source_name](HullForm.from_ship(ship), ship)
            values, source, deviations = estimate.values, estimate.source, estimate.deviations
        else:
            published = parameter_set(source_name)
            values, source, deviations = published.values, published.source, {}
        priors |= {
            name: LiteraturePrior(float(value), source, deviations.get(name, 0.0)) for name, value in values.items()
        }
    return priors


def _require_source_for_model(name: str, model: str) -> None:
    known = sorted((*FORMULAS, *PARAMETER_SETS))
    if name not in known:
        raise InputError(
            f"model.priors_from: unknown source '{name}'{spelling_hint(name, known)}; known: {', '.join(known)}"
        )
    source_model = _FORMULA_MODEL if name in FORMULAS else parameter_set(name).model
    if source_model != model:
        raise InputError(
            f"model.priors_from: '{name}' gives coefficients of model '{source_model}', in its prime system, not of "
            f"'{model}'; choose '{source_model}', or write priors under [model.priors]"
        )


def prior_range_findings(names: Sequence[str], ship: Ship) -> tuple[Finding, ...]:
    """Warnings `prior-range` for formulas whose data did not hold ships of this form."""
    findings = []
    for name in names:
        if name in FORMULAS:
            form = HullForm.from_ship(ship)
            estimate = FORMULAS[name](form, ship)
            if not estimate.valid:
                form_text = f"C_b {form.C_b:.3g}, L/B {form.L / form.B:.3g}, B/d {form.B / form.d:.3g}"
                findings.append(Finding(
                    Severity.WARNING, "prior-range",
                    f"ship '{ship.name}' lies outside the range of '{name}' ({estimate.source})",
                    f"{form_text}; fitted to {estimate.limits}",
                    "widen prior_sd_percent, or take another source",
                ))  # fmt: skip
    return tuple(findings)
