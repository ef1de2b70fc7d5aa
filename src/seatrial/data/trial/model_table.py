"""The model that a trial chooses, what it needs, and what is filled from where."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from seatrial.core.equations import Model
from seatrial.core.equations.model import ZERO_BY_DEFAULT
from seatrial.core.values import (
    Finding,
    InputError,
    Parameter,
    Parameters,
    Prior,
    Severity,
    Ship,
    si_unit,
    spelling_hint,
)
from seatrial.data.trial.amounts import Amount
from seatrial.data.trial.priors import USUAL_PROPELLER, EarlierResult, LiteraturePrior, literature_priors
from seatrial.data.trial.schema import ModelTable, PriorTable, ShipTable
from seatrial.physics.hydro.empirical import HullForm, added_mass
from seatrial.physics.models import MODELS, model_named
from seatrial.physics.models.published import kvlcc2_l7, parameter_set, with_start_values
from seatrial.physics.sensors import Sensors, with_sensors

# What a model needs, what is filled from where, and the tables of a trial file to begin with.

# formulas that fill what nobody tested, in the order in which later ones win
_MMG_SOURCES = ("yoshimura", "zhou", "interaction", "propulsion", "displacement")
_SOURCES: Mapping[str, tuple[str, ...]] = {
    "mmg": _MMG_SOURCES,
    "mmg_twin": (*_MMG_SOURCES, "twin_screws"),
    "mmg_shallow": (*_MMG_SOURCES, "shallow"),
    "abkowitz": ("higher_order",),
}
_FORM = ("L", "B", "d", "C_b", "D_P", "H_R", "A_R")  # what the formulas take, and the model besides
_PRIOR_PERCENT = (
    50  # of a coefficient whose scatter is not known; ours: linear ones are good to 25, cubic to their order
)
_INTERACTION = ("t_P", "w_P0", "gamma_R_plus", "gamma_R_minus")
_MEANINGS = {
    "L": "m, between perpendiculars", "B": "m, breadth", "d": "m, draught", "C_b": "block coefficient",
    "H_R": "m, span of the rudder", "A_R": "m^2, area of the rudder",
}  # fmt: skip


@dataclass(frozen=True)
class FilledValue:
    """A parameter that nobody needs to state: where its value comes from, and how far that may be wrong.

    deviation: standard deviation of the prior; 0: `prior_sd_percent` of the value, or none where it is fixed.
    """

    name: str
    source: str
    deviation: float


@dataclass(frozen=True)
class ModelGuide:
    """What a model needs.

    Attributes:
        name, source: of its equations.
        inputs: channels that act on the model.
        observables: channels that are compared with it, of which one is needed.
        optional_inputs: those of the inputs that are zero where they are not recorded.
        needed: particulars to state under `[ship]` -> unit and meaning.
        free: parameters that are estimated by default.
        filled: parameters with a value by formula, or by default in the model.
        trial: the tables `[ship]`, `[model]` of a trial file to fill in.
    """

    name: str
    source: str
    inputs: tuple[str, ...]
    optional_inputs: tuple[str, ...]
    observables: tuple[str, ...]
    needed: Mapping[str, str]
    free: tuple[str, ...]
    filled: tuple[FilledValue, ...]
    trial: str


def model_guide(name: str) -> ModelGuide:
    """Return what a built-in or installed model needs and what is filled from where.

    Raises:
        InputError: there is no such model; the nearest name is given.
    """
    model, sources = model_named(name), _SOURCES.get(name, ())
    priors = literature_priors(sources, _example_ship(), name) if sources else {}
    needed = _needed(model, priors, has_form=_take_form(sources))
    free = tuple(p.name for p in model.parameters.free)
    return ModelGuide(
        name, model.equations.source, model.input_names,
        tuple(name for name in model.input_names if name in ZERO_BY_DEFAULT), model.observables, needed, free,
        tuple(_filled(model, priors)), _trial_tables(model, sources, needed, free),
    )  # fmt: skip


def _example_ship() -> Ship:
    """A ship with what the formulas take and nothing else: which parameters they fill does not depend on it."""
    tanker = kvlcc2_l7().ship
    return Ship(tanker.name, {name: tanker.particulars[name] for name in _FORM})


def _take_form(sources: Sequence[str]) -> bool:
    """Whether formulas are in the dimensions of hull, propeller and rudder."""
    return any(name in _MMG_SOURCES for name in sources)


def _needed(model: Model, priors: Mapping[str, LiteraturePrior], *, has_form: bool) -> dict[str, str]:
    missing = [p for p in model.parameters if p.name in model.parameters.missing and p.name not in priors]
    words = {p.name: _words(p) for p in missing}
    form = {name: _MEANINGS[name] for name in _FORM if name in _MEANINGS} if has_form else {}
    return {"L": _MEANINGS["L"]} | form | {name: text for name, text in words.items() if name not in form}


def _words(parameter: Parameter) -> str:
    return ", ".join(part for part in (parameter.unit if parameter.unit != "1" else "", parameter.meaning) if part)


def _filled(model: Model, priors: Mapping[str, LiteraturePrior]) -> list[FilledValue]:
    filled = {n: prior for n, prior in priors.items() if n in model.parameters and n not in _FORM}
    by_formula = [FilledValue(n, prior.source, prior.deviation) for n, prior in filled.items()]
    stated = {"L", *priors, *model.parameters.missing}
    fixed = [p for p in model.parameters if p.name not in stated]
    return by_formula + [FilledValue(p.name, _stated(p), 0.0) for p in fixed]


def _stated(parameter: Parameter) -> str:
    """The default of a model and its origin; of a coefficient that starts at zero only that."""
    origin = f"default of the model ({parameter.source})" if parameter.source else "default of the model"
    return "starts at zero" if parameter.value == 0.0 else origin


def _trial_tables(model: Model, sources: tuple[str, ...], needed: Mapping[str, str], free: tuple[str, ...]) -> str:
    lines = ["[ship]", 'name = "..."', *(_particular(name, text) for name, text in needed.items())]
    if _take_form(sources):
        usual = USUAL_PROPELLER.items()
        lines += [f"# {name} = {value:g}    # of the propeller, where it is known" for name, value in usual]
    lines += ["", "[model]", f'name = "{model.name}"']
    lines += [f"priors_from = [{_quoted_list(sources)}]"] if sources else []
    if _take_form(sources):
        lines += [
            f"prior_sd_percent = {_PRIOR_PERCENT}    # of coefficients whose scatter is not known",
            f"free = [{_quoted_list((*free, *_INTERACTION))}]",
        ]
    if model.name == "thrusters":
        lines += [
            "", "[[thruster]]    # one for each thruster", 'name = "port"', "x = -0.5    # m forward of the origin",
            "y = -0.3    # m to starboard", 'command = { channel = "command_1", unit = "1" }',
        ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _particular(name: str, text: str) -> str:
    """A line to fill in; the length, which every trial needs, is no comment, and zero is refused until it is stated."""
    return f"{name} = 0.0    # {text}" if name == "L" else f"# {name} = 0.0    # {text}; required"


def _quoted_list(names: tuple[str, ...]) -> str:
    return ", ".join(f'"{name}"' for name in names)


# The model a trial chooses: equations by name, then values, freedom, bounds and priors, in that order.

Bounds = Mapping[str, tuple[float, float]]
COMMON_PARTICULARS = {
    "L": "m", "B": "m", "d": "m", "m": "kg", "I_z": "kg m^2", "k_xx": "m", "k_xx_prime": "m", "GM": "m", "x_G": "m",
    "C_b": "1", "volume": "m^3", "D_P": "m", "x_P": "m", "A_R": "m^2", "H_R": "m", "x_R": "m", "A_T": "m^2",
    "A_L": "m^2", "rho": "kg/m^3", "pitch_ratio": "1", "area_ratio": "1", "blades": "1",
}  # fmt: skip
"""Particulars that people state although not every model asks for them -> SI unit."""


_SIZES = frozenset((*COMMON_PARTICULARS, "I5", "c33", "c55")) - {"x_G", "x_P", "x_R", "GM"}
"""Particulars that are lengths, areas, masses, ratios or stiffnesses of a craft that floats: never negative."""


def ship_of(table: ShipTable) -> Ship:
    """Name, source, scale and particulars in SI units.

    Raises:
        InputError: the length is missing or not positive, a size is negative, or a unit measures something else.
    """
    for name, unit in table.units.items():
        if si_unit(unit)[1] != (wanted := COMMON_PARTICULARS.get(name, si_unit(unit)[1])):
            raise InputError(f"ship.{name}: '{unit}' is no unit of this particular; write one of {wanted}")
    for name, value in table.particulars.items():
        if name in _SIZES and value < 0.0:
            raise InputError(f"ship.{name} = {value:g}: a size is never negative; correct its sign")
    if not table.particulars.get("L", 0.0) > 0.0:
        raise InputError("key 'ship.L' is missing or not positive; give the length between perpendiculars in m")
    return Ship(table.name, table.particulars, table.source, table.scale)


def build_trial_model(
    table: ModelTable, ship: Ship, own_model: Model | None = None, layout: str = "", sensors: Sensors | None = None,
    results: Mapping[str, EarlierResult] = MappingProxyType({}),
) -> Model:  # fmt: skip
    """The model of `[model]` for this ship, ready to be estimated.

    layout: of its thrusters, as `model_named` takes it; sensors: what stands between its motion and the records.
    results: earlier fits among the sources of priors, by their name there.

    Later ones win: the model's own values, those of `priors_from`, the parameter set, the ship's particulars, `start`,
    `fixed`.

    Raises:
        InputError: unknown model, parameter set, source of priors, parameter or particular; a value outside its bounds
            or missing.
    """
    model = own_model or model_named(table.name, layout)
    craft, model = model, with_sensors(model, sensors or Sensors())
    literature = _sourced_priors(table, ship, model, results)
    for name, prior in literature.items():
        model = model.with_values({name: prior.mean}, source=prior.source)
    if table.parameter_set is not None:
        published = parameter_set(table.parameter_set)
        model = model.with_values(published.values, source=published.source)
    _refuse_unknown_particulars(ship, model)
    parameters = model.parameters
    parameters = _with_amounts(parameters, table.start, "model.start", "start value of the trial file")
    parameters = _with_amounts(parameters, table.fixed, "model.fixed", "fixed in the trial file")
    own_ship = _without_particulars(ship, (*table.start, *table.fixed))
    model = with_start_values(
        model.with_parameters(_with_free_and_fixed(parameters, table, craft)), own_ship
    ).with_ship(own_ship)
    bounds = table.bounds if own_model is None else _bounds_in_common(table, model, layout)
    bounded = _with_bounds(model.parameters, bounds)
    formulas = literature_priors([name for name in table.priors_from if name not in results], ship, model.name)
    return model.with_parameters(_with_priors(bounded, table, literature, formulas))


def _sourced_priors(
    table: ModelTable, ship: Ship, model: Model, results: Mapping[str, EarlierResult]
) -> dict[str, LiteraturePrior]:
    """What the sources of `priors_from` say, later ones win: literature, and earlier results."""
    priors: dict[str, LiteraturePrior] = {}
    for name in table.priors_from:
        result = results.get(name)
        if result is None:
            priors |= literature_priors((name,), ship, model.name)
        elif result.model != model.name:
            raise InputError(
                f"model.priors_from: '{name}' is a fit of model '{result.model}', not of '{model.name}'; choose a "
                "result of this model"
            )
        else:
            priors |= {n: prior for n, prior in result.priors.items() if n in model.parameters}
    return priors


def _bounds_in_common(table: ModelTable, own_model: Model, layout: str) -> Bounds:
    """The bounds without those of parameters that only the model has in whose place the user's own stands."""
    replaced = model_named(table.name, layout).parameters if table.name in MODELS else ()
    return {n: ends for n, ends in table.bounds.items() if n in own_model.parameters or n not in replaced}


def _without_particulars(ship: Ship, names: tuple[str, ...]) -> Ship:
    kept = {name: value for name, value in ship.particulars.items() if name not in names}
    return Ship(ship.name, kept, ship.source, ship.scale)


def _refuse_unknown_particulars(ship: Ship, model: Model) -> None:
    allowed = [*model.parameters.names, *COMMON_PARTICULARS]
    for symbol in ship.particulars:
        if symbol not in allowed:
            keys = ["name", "source", "scale", *sorted(set(allowed))]
            raise InputError(f"unknown key 'ship.{symbol}'{spelling_hint(symbol, keys)}")


def _refuse_unknown(where: str, names: tuple[str, ...], parameters: Parameters) -> None:
    for name in names:
        if name not in parameters:
            raise InputError(f"{where}: unknown parameter '{name}'{spelling_hint(name, list(parameters.names))}")


def _with_amounts(parameters: Parameters, amounts: Mapping[str, Amount], where: str, source: str) -> Parameters:
    _refuse_unknown(where, tuple(amounts), parameters)
    for name, amount in amounts.items():
        if amount.unit is not None and si_unit(amount.unit)[1] != parameters[name].unit:
            raise InputError(
                f"{where}.{name}: '{amount.unit}' is no unit of this parameter, which is in {parameters[name].unit}"
            )
    return parameters.with_values({name: amount.in_si for name, amount in amounts.items()}, source)


def _with_free_and_fixed(parameters: Parameters, table: ModelTable, craft: Model) -> Parameters:
    """Free what the trial frees and the sensors' coefficients; fix what it fixes."""
    if table.free is not None:
        _refuse_unknown("model.free", table.free, parameters)
        for name in table.free:
            if name in table.fixed:
                raise InputError(f"model: parameter '{name}' is named under both 'free' and 'fixed'; keep one")
        of_sensors = (p.name for p in parameters.free if p.name not in craft.parameters)
        parameters = parameters.only_free((*table.free, *of_sensors))
    return parameters.fixed(*table.fixed)


def _with_bounds(parameters: Parameters, bounds: Bounds) -> Parameters:
    _refuse_unknown("model.bounds", tuple(bounds), parameters)
    for name, (lower, upper) in bounds.items():
        if not lower < upper:
            raise InputError(
                f"model.bounds.{name}: lower bound {lower:g} is not below upper bound {upper:g}; swap them"
            )
        parameters = parameters.bounded(name, lower, upper)
    for p in parameters.free:
        if not p.lower <= p.value <= p.upper:
            raise InputError(
                f"parameter '{p.name}' starts at {p.value:g}, outside its bounds {p.lower:g} to {p.upper:g}; "
                "change model.start or model.bounds"
            )
    return parameters


def _with_priors(
    parameters: Parameters, table: ModelTable, literature: Mapping[str, LiteraturePrior],
    formulas: Mapping[str, LiteraturePrior],
) -> Parameters:  # fmt: skip
    """Stated priors; for the other free parameters `prior_sd_percent` of the literature's value, or of their start.

    A fixed parameter that has the value of a formula has its prior too, where that knows how far it may be wrong.
    Values of an earlier result are wrong together, not each by its own.
    """
    _refuse_unknown("model.priors", tuple(table.priors), parameters)
    priors = {name: _prior(parameters, name, prior) for name, prior in table.priors.items()}
    for p in parameters:
        sourced = literature.get(p.name)
        if (
            sourced is not None
            and sourced.deviation
            and (p.free or (sourced == formulas.get(p.name) and p.value == sourced.mean))
        ):
            priors.setdefault(p.name, Prior(sourced.mean, sourced.deviation, sourced.source))
    if table.prior_sd_percent is None and any(not sourced.deviation for sourced in literature.values()):
        raise InputError(
            "model.priors_from says nothing about how far its values may be wrong; "
            "add prior_sd_percent, for example 25 for regressions of linear coefficients"
        )
    if table.prior_sd_percent is not None:
        share = table.prior_sd_percent / 100.0
        for p in parameters.free:
            sourced = literature.get(p.name, LiteraturePrior(p.value, p.source))
            spread = share * max(abs(sourced.mean), p.scale) or share
            priors.setdefault(p.name, Prior(sourced.mean, spread, sourced.source, is_spread_assumed=True))
    return _with_prior_sources(parameters.with_priors(priors), literature)


def _with_prior_sources(parameters: Parameters, literature: Mapping[str, LiteraturePrior]) -> Parameters:
    """Free parameters that start elsewhere than at their prior from literature name both sources."""
    for p in parameters.free:
        if p.prior is not None and p.name in literature and p.prior.source not in p.source:
            parameters = parameters.with_values({p.name: p.value}, f"{p.source}; prior: {p.prior.source}")
    return parameters


def _prior(parameters: Parameters, name: str, prior: PriorTable) -> Prior:
    mean = parameters[name].value if prior.mean is None else prior.mean
    return Prior(mean, prior.sd, prior.source or "trial file")


# A warning where added masses are left at zero: inertias that are too small then scale all forces.

ADDED_MASSES = {"X_udot": "m_x_prime", "Y_vdot": "m_y_prime", "N_rdot": "J_z_prime"}
"""Acceleration derivative -> the added mass of the formula, of opposite sign and over rho/2 L^2 d instead of L^3."""


def added_mass_findings(model: Model, ship: Ship) -> tuple[Finding, ...]:
    """Return a warning `added-mass-zero` where a model has acceleration derivatives and all are fixed at zero."""
    if not has_held_added_masses(model) or any(model.parameters[name].value for name in ADDED_MASSES):
        return ()
    names = ", ".join(ADDED_MASSES)
    return (Finding(
        Severity.WARNING, "added-mass-zero", f"the added masses {names} are 0: motions show forces per mass, so that "
        "all coefficients come out too small by the share of the mass that is missing", "", _advice(ship),
    ),)  # fmt: skip


def has_held_added_masses(model: Model) -> bool:
    """Return whether a model has acceleration derivatives and all of them are fixed."""
    parameters = model.parameters
    return all(name in parameters.names and not parameters[name].free for name in ADDED_MASSES)


def _advice(ship: Ship) -> str:
    """The edit, with numbers where the ship's form is known."""
    try:
        estimate = added_mass(form := HullForm.from_ship(ship))
    except InputError:
        return (
            "give X_udot, Y_vdot and N_rdot (negative, over rho/2 L^3 and L^5) under [model.fixed]; with B, d and C_b "
            "under [ship] this message gives estimates"
        )
    values = ", ".join(f"{name} = {-estimate.values[key] * form.d / form.L:.2g}" for name, key in ADDED_MASSES.items())
    return f"under [model.fixed] give {values} ({estimate.source})"
