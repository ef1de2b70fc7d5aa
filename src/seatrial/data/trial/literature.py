"""Priors by the name of their source: published sets of coefficients, or formulas in the ship's main dimensions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from seatrial.core.values import Finding, InputError, Severity, Ship, spelling_hint
from seatrial.physics.hydro.empirical import (
    EmpiricalEstimate,
    HullForm,
    added_mass,
    clarke,
    interaction_coefficients,
    kijima,
    yoshimura,
)
from seatrial.physics.models.published import PARAMETER_SETS, parameter_set


@dataclass(frozen=True)
class LiteraturePrior:
    """What a source says about one parameter."""

    mean: float
    source: str


def _interaction(form: HullForm, ship: Ship) -> EmpiricalEstimate:
    missing = [n for n in ("H_R", "A_R") if n not in ship.particulars]
    if missing:
        raise InputError(
            f"ship '{ship.name}' lacks {' and '.join(missing)} for priors_from = \"interaction\"; add it under [ship]"
        )
    return interaction_coefficients(form, ship.particulars["H_R"] ** 2 / ship.particulars["A_R"])


FORMULAS: dict[str, Callable[[HullForm, Ship], EmpiricalEstimate]] = {
    "clarke": lambda form, _: clarke(form),
    "kijima": lambda form, _: kijima(form),
    "yoshimura": lambda form, _: yoshimura(form),
    "zhou": lambda form, _: added_mass(form),
    "interaction": _interaction,
}
_FORMULA_MODEL = "mmg"


def literature_priors(names: Sequence[str], ship: Ship, model: str) -> dict[str, LiteraturePrior]:
    """Means and citations by parameter; where two sources name a parameter the later one wins.

    Formulas are for the model mmg; published sets are for the model they were made for.

    Raises:
        InputError: an unknown source, one for another model, or a ship without the particulars a formula needs.
    """
    priors: dict[str, LiteraturePrior] = {}
    for name in names:
        _require_source_for_model(name, model)
        if name in FORMULAS:
            estimate = FORMULAS[name](HullForm.from_ship(ship), ship)
            values, source = estimate.values, estimate.source
        else:
            published = parameter_set(name)
            values, source = published.values, published.source
        priors |= {parameter: LiteraturePrior(float(value), source) for parameter, value in values.items()}
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
