"""Priors by their source: published coefficients, formulas, an earlier result of the same ship."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from seatrial.core.values import Array, Finding, InputError, Parameters, Prior, Severity, Ship, spelling_hint
from seatrial.core.values.files import is_file, is_folder
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
from seatrial.physics.hydro.excitation import SEA_WATER
from seatrial.physics.models.published import (
    FURUKAWA,
    HIGHER_ORDER,
    HIGHER_ORDER_SPREAD,
    HOLTROP,
    KIJIMA,
    LI_WU,
    PARAMETER_SETS,
    SHARE_SPREAD,
    SYMMETRIC,
    TAYLOR,
    TWIN_SPREAD,
    TYPICAL,
    TYPICAL_SPREAD,
    parameter_set,
    share_name,
    twin_screw_formulas,
)
from seatrial.physics.models.registry import family_of

# Priors by the name of their source: published sets of coefficients, or formulas in the ship's main dimensions.

USUAL_PROPELLER = {"pitch_ratio": 0.75, "area_ratio": 0.5, "blades": 4.0}
"""P/D, A_E/A_0 and blades where `[ship]` does not state them; chosen: a merchant ship's fixed propeller."""


@dataclass(frozen=True)
class LiteraturePrior:
    """What a source says about one parameter; deviation 0: not how far it may be wrong."""

    mean: float
    source: str
    deviation: float = 0.0


def _interaction(ship: Ship) -> EmpiricalEstimate:
    missing = [n for n in ("H_R", "A_R") if n not in ship.particulars]
    if missing:
        raise InputError(
            f"ship '{ship.name}' lacks {' and '.join(missing)} for priors_from = \"interaction\"; add it under [ship]"
        )
    return interaction_coefficients(HullForm.from_ship(ship), ship.particulars["H_R"] ** 2 / ship.particulars["A_R"])


def _propulsion(ship: Ship) -> EmpiricalEstimate:
    stated = {name: ship.particulars.get(name, usual) for name, usual in USUAL_PROPELLER.items()}
    form = HullForm.from_ship(ship)
    return propulsion(form, stated["pitch_ratio"], stated["area_ratio"], round(stated["blades"]))


def _twin_screws(ship: Ship) -> EmpiricalEstimate:
    if "D_P" not in ship.particulars:
        raise InputError(f"ship '{ship.name}' lacks D_P for priors_from = \"twin_screws\"; add it under [ship]")
    form = HullForm.from_ship(ship)
    values = twin_screw_formulas(form.C_b, form.B, form.d, ship.particulars["D_P"])
    return EmpiricalEstimate(
        values, f"w_P0 {TAYLOR}; t_P {HOLTROP}", valid=True, limits="any ship with two screws", deviations=TWIN_SPREAD
    )


def _displacement(ship: Ship) -> EmpiricalEstimate:
    return displacement(HullForm.from_ship(ship), ship.particulars.get("rho", SEA_WATER))


def _shallow(ship: Ship) -> EmpiricalEstimate:
    shares = {share_name(name): sd for name, sd in SHARE_SPREAD.items()}
    values = {**dict.fromkeys(shares, 1.0), "C_b": HullForm.from_ship(ship).C_b}
    source = f"{KIJIMA}; {LI_WU}; {FURUKAWA}; spread chosen"
    return EmpiricalEstimate(values, source, valid=True, limits="any ship", deviations=shares)


@dataclass(frozen=True)
class Formula:
    """Formulas that say of a ship what coefficients of a model are likely.

    Attributes:
        estimate: ship -> coefficients, how far they may be wrong, and whether the ship is within their range.
        model: whose prime system they are in; its family takes them.
    """

    estimate: Callable[[Ship], EmpiricalEstimate]
    model: str = "mmg"


def _of_form(formula: Callable[[HullForm], EmpiricalEstimate]) -> Formula:
    return Formula(lambda ship: formula(HullForm.from_ship(ship)))


FORMULAS: Mapping[str, Formula] = MappingProxyType({
    "clarke": _of_form(clarke),
    "kijima": _of_form(kijima),
    "yoshimura": _of_form(yoshimura),
    "zhou": _of_form(added_mass),
    "interaction": Formula(_interaction),
    "propulsion": Formula(_propulsion),
    "displacement": Formula(_displacement),
    "twin_screws": Formula(_twin_screws),
    "shallow": Formula(_shallow),
    "wind": Formula(lambda _: EmpiricalEstimate(SYMMETRIC, TYPICAL, True, "any craft", TYPICAL_SPREAD)),
    "higher_order": Formula(
        lambda _: EmpiricalEstimate(
            dict.fromkeys(HIGHER_ORDER_SPREAD, 0.0), HIGHER_ORDER, True, "any ship", HIGHER_ORDER_SPREAD
        ),
        "abkowitz",
    ),
})  # fmt: skip


def literature_priors(names: Sequence[str], ship: Ship, model: str) -> dict[str, LiteraturePrior]:
    """Means and citations by parameter; where two sources name a parameter the later one wins.

    Formulas and published sets are for the model they were made for. Models of its family take both.

    Raises:
        InputError: an unknown source, one for another model, or a ship without the particulars a formula needs.
    """
    priors: dict[str, LiteraturePrior] = {}
    for source_name in names:
        _require_source_for_model(source_name, model)
        if source_name in FORMULAS:
            estimate = FORMULAS[source_name].estimate(ship)
            values, source, deviations = estimate.values, estimate.source, estimate.deviations
        else:
            published = parameter_set(source_name)
            values, source, deviations = published.values, published.source, {}
        priors |= {
            name: LiteraturePrior(float(value), source, deviations.get(name, 0.0)) for name, value in values.items()
        }
    return priors


def _require_source_for_model(name: str, model: str) -> None:
    sources = sorted((*FORMULAS, *PARAMETER_SETS))
    if name not in sources:
        raise InputError(
            f"model.priors_from: unknown source '{name}'{spelling_hint(name, sources)}; known: {', '.join(sources)}"
        )
    source_model = FORMULAS[name].model if name in FORMULAS else parameter_set(name).model
    if family_of(model) != source_model:
        raise InputError(
            f"model.priors_from: '{name}' gives coefficients of model '{source_model}', in its prime system, not of "
            f"'{model}'; choose '{source_model}', or write priors under [model.priors]"
        )


def prior_range_findings(names: Sequence[str], ship: Ship) -> tuple[Finding, ...]:
    """Warnings `prior-range` for formulas whose data did not hold ships of this form."""
    findings = []
    for name in names:
        if name in FORMULAS:
            estimate = FORMULAS[name].estimate(ship)
            if not estimate.valid:
                form = HullForm.from_ship(ship)
                form_text = f"C_b {form.C_b:.3g}, L/B {form.L / form.B:.3g}, B/d {form.B / form.d:.3g}"
                findings.append(Finding(
                    Severity.WARNING, "prior-range",
                    f"ship '{ship.name}' lies outside the range of '{name}' ({estimate.source})",
                    f"{form_text}; fitted to {estimate.limits}",
                ))  # fmt: skip
    return tuple(findings)


# Priors from an earlier result of the same ship: what yesterday's records say is what is known before today's.


@dataclass(frozen=True, eq=False)
class JointPrior:
    """What an earlier result says of several coefficients together.

    Attributes:
        names: of the coefficients; mean: (n,); covariance: (n, n); both SI.
    """

    names: tuple[str, ...]
    mean: Array
    covariance: Array

    def restricted(self, names: Collection[str]) -> "JointPrior":
        """Return what it says of some of them, whatever the others are."""
        rows = [i for i, name in enumerate(self.names) if name in names]
        return JointPrior(tuple(self.names[i] for i in rows), self.mean[rows], self.covariance[np.ix_(rows, rows)])


@dataclass(frozen=True, eq=False)
class EarlierResult:
    """What a result says of its coefficients before new records.

    Attributes:
        model: name of its equations; source: what it is, in a phrase; joint_prior: of its free coefficients.
        digests: SHA-256 of the files that it was estimated from.
    """

    model: str
    source: str
    joint_prior: JointPrior
    digests: frozenset[str]

    @property
    def priors(self) -> dict[str, LiteraturePrior]:
        """Mean and standard deviation of each coefficient by itself."""
        prior = self.joint_prior
        deviations = np.sqrt(np.diag(prior.covariance))
        return {
            name: LiteraturePrior(float(mean), self.source, float(sd))
            for name, mean, sd in zip(prior.names, prior.mean, deviations, strict=True)
        }

    def joint_prior_of(self, parameters: Parameters) -> JointPrior:
        """Return what it says of those free parameters whose priors are its own."""
        marginal = {n: Prior(prior.mean, prior.deviation, prior.source) for n, prior in self.priors.items()}
        return self.joint_prior.restricted(
            {p.name for p in parameters.free if p.prior and p.prior == marginal.get(p.name)}
        )


ResultReader = Callable[[Path], EarlierResult]


def earlier_results(
    names: Iterable[str], home: Path, expand: Callable[[str], str], read: ResultReader | None
) -> dict[str, EarlierResult]:
    """Return the results among the sources of priors, by the name in the trial file: folders with a model.toml.

    Args:
        home: folder of the trial file, from which paths count; expand: puts environment variables in.

    Raises:
        InputError: a folder that holds no such result.
    """
    folders = {name: home / expand(name) for name in names if "/" in name or is_folder(home / name)}
    for name, folder in folders.items():
        if read is None or not is_file(folder / "model.toml"):
            raise InputError(
                f"model.priors_from: '{name}' is no result of identify (no {folder / 'model.toml'}); give the DIR of "
                "'seatrial identify TRIAL --out DIR'"
            )
    return {name: read(folder) for name, folder in folders.items() if read is not None}
