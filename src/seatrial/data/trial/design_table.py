"""The table `[design]` of a trial file into a `Brief`: amounts in SI, names and limits tested against the model."""

import math
from collections.abc import Mapping

from seatrial.core.equations import Model
from seatrial.core.results import Actuator, TrialLimits
from seatrial.core.values import NOTATION, InputError, si_unit, spelling_hint
from seatrial.data.trial.amounts import Amount
from seatrial.data.trial.schema import DesignTable, InputTable
from seatrial.data.trial.trial import DesignRequest

_HALF_TURN = math.pi
_MIN_SAMPLES = 20


def design_request(table: DesignTable, model: Model, length: float) -> DesignRequest:
    """The brief that the table describes, for a ship of that length [m].

    Raises:
        InputError: an amount of another kind, an unknown input, one both moved and held, a limit that cannot be kept.
    """
    duration = _positive_si_amount(table.duration, "s", "design.duration")
    if duration * table.rate < _MIN_SAMPLES:
        raise InputError(
            f"design.duration: {duration:g} s at {table.rate:g} Hz are fewer than {_MIN_SAMPLES} samples; "
            "make it longer, or raise design.rate"
        )
    return DesignRequest(
        duration=duration,
        rate=table.rate,
        actuators=tuple(_actuator(name, entry, model, duration) for name, entry in table.inputs.items()),
        held=_constant_inputs(table.held, tuple(table.inputs), model),
        limits=_limits(table, length),
        speed=_approach_speed(table.speed, model),
        criterion=table.criterion,
        draws=table.draws,
        prior_fraction=table.prior_percent / 100.0,
    )


def _actuator(name: str, table: InputTable, model: Model, duration: float) -> Actuator:
    where = f"design.inputs.{name}"
    _require_input(name, where, model)
    factor = _si_factor(table.unit, _input_unit(name), f"{where}.unit")
    if table.hold > duration:
        raise InputError(f"{where}.hold = {table.hold:g} s is longer than the trial of {duration:g} s; shorten it")
    if _input_unit(name) == "rad" and max(abs(table.lower), abs(table.upper)) * factor >= _HALF_TURN:
        raise InputError(
            f"{where}: {math.degrees(max(abs(table.lower), abs(table.upper)) * factor):g} degrees are no angle to "
            f'order; write the range with its unit, such as unit = "deg"'
        )
    rate = math.inf if table.rate is None else table.rate * factor
    return Actuator(name, table.lower * factor, table.upper * factor, rate, table.hold)


def _constant_inputs(amounts: Mapping[str, Amount], designed_inputs: tuple[str, ...], model: Model) -> dict[str, float]:
    for name in amounts:
        _require_input(name, f"design.held.{name}", model)
        if name in designed_inputs:
            raise InputError(f"design: input '{name}' is named under both 'inputs' and 'held'; keep one")
    return {name: _si_amount(amount, _input_unit(name), f"design.held.{name}") for name, amount in amounts.items()}


def _limits(table: DesignTable, length: float) -> TrialLimits:
    drift = math.inf if table.drift is None else _positive_si_amount(table.drift, "rad", "design.drift")
    room = math.inf if table.sea_room is None else _positive_si_amount(table.sea_room, "m", "design.sea_room")
    if math.isfinite(drift) and drift >= _HALF_TURN:
        raise InputError(
            f"design.drift: {math.degrees(drift):g} degrees are no limit of a drift angle; write it with its unit, "
            'such as { value = 20, unit = "deg" }, or leave it out'
        )
    if room < length:
        raise InputError(
            f"design.sea_room: {room:g} m are less than the ship's length of {length:g} m; no manoeuvre keeps within"
        )
    return TrialLimits(drift, room, table.every_ship)


def _approach_speed(amount: Amount | None, model: Model) -> float | None:
    if amount is None:
        return None
    if "u" not in model.states:
        raise InputError(f"design.speed: model '{model.name}' has no surge velocity u to approach with; leave it out")
    return _positive_si_amount(amount, "m/s", "design.speed")


def _require_input(name: str, where: str, model: Model) -> None:
    if name not in model.input_names:
        raise InputError(
            f"{where}: '{name}' is no input of model '{model.name}'{spelling_hint(name, [*model.input_names])}"
        )


def _input_unit(name: str) -> str:
    return NOTATION[name].unit if name in NOTATION else "1"


def _si_factor(unit: str, expected: str, where: str) -> float:
    factor, known = si_unit(unit)
    if known != expected:
        raise InputError(f"{where}: '{unit}' is no unit of what is measured in {expected}; write one that is")
    return factor


def _si_amount(amount: Amount, si_unit: str, where: str) -> float:
    return amount.value * (_si_factor(amount.unit, si_unit, where) if amount.unit else 1.0)


def _positive_si_amount(amount: Amount, si_unit: str, where: str) -> float:
    value = _si_amount(amount, si_unit, where)
    if not value > 0.0:
        raise InputError(f"{where} = {amount.value:g} is not positive; give a positive one")
    return value
