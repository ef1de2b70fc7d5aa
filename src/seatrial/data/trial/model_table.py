"""The model a trial chooses: equations by name, then values, freedom, bounds and priors, in that order."""

from collections.abc import Mapping
from types import MappingProxyType

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Parameters, Prior, Ship, si_unit, spelling_hint
from seatrial.data.trial.amounts import Amount
from seatrial.data.trial.earlier_result import EarlierResult
from seatrial.data.trial.literature import LiteraturePrior, literature_priors
from seatrial.data.trial.schema import ModelTable, PriorTable, ShipTable
from seatrial.physics.models import MODELS, model_named
from seatrial.physics.models.heave_pitch_coefficients import with_start_values
from seatrial.physics.models.published import parameter_set
from seatrial.physics.sensors import Sensors, with_sensors

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
    for name, known in literature.items():
        model = model.with_values({name: known.mean}, source=known.source)
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
    known = [*model.parameters.names, *COMMON_PARTICULARS]
    for symbol in ship.particulars:
        if symbol not in known:
            keys = ["name", "source", "scale", *sorted(set(known))]
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
        known = literature.get(p.name)
        if (
            known is not None
            and known.deviation
            and (p.free or (known == formulas.get(p.name) and p.value == known.mean))
        ):
            priors.setdefault(p.name, Prior(known.mean, known.deviation, known.source))
    if table.prior_sd_percent is None and any(not known.deviation for known in literature.values()):
        raise InputError(
            "model.priors_from says nothing about how far its values may be wrong; "
            "add prior_sd_percent, for example 25 for regressions of linear coefficients"
        )
    if table.prior_sd_percent is not None:
        share = table.prior_sd_percent / 100.0
        for p in parameters.free:
            known = literature.get(p.name, LiteraturePrior(p.value, p.source))
            spread = share * max(abs(known.mean), p.scale) or share
            priors.setdefault(p.name, Prior(known.mean, spread, known.source, is_spread_assumed=True))
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
