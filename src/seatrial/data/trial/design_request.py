"""The manoeuvre that is to be designed: table `[design]` of a trial file, a value in Python."""

import math
from collections.abc import Mapping
from dataclasses import replace
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import Field, GetCoreSchemaHandler, model_validator
from pydantic.dataclasses import dataclass
from pydantic_core.core_schema import CoreSchema, no_info_after_validator_function

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, InputError, si_unit, spelling_hint
from seatrial.data.trial.amounts import (
    STRICT_FIELDS,
    Amount,
    PositiveAngle,
    PositiveDuration,
    PositiveLength,
    PositiveSpeed,
    SiAmount,
    Unit,
    raises_input_error,
)
from seatrial.data.trial.settings import Positive

if TYPE_CHECKING:
    from seatrial.core.results import Actuator, TrialLimits

_HALF_TURN = math.pi
"""No angle of a rudder or of drift reaches half a turn [rad]: degrees without their unit do."""

_MIN_SAMPLES = 20
"""Fewest samples of a manoeuvre; chosen."""


class DesignCriterion(StrEnum):
    """Which relative standard error is made small: of the least certain coefficient, or their root mean square."""

    WORST = "worst"
    MEAN = "mean"


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class InputRange:
    """`[design.inputs.NAME]`: what may be done with an input.

    Attributes:
        lower, upper: its range, in `unit`; rate: its largest rate, in `unit` per second, None where it may jump.
        unit: of the range.
        hold: shortest time between two orders [s].
    """

    lower: float
    upper: float
    unit: Unit
    rate: Positive | None = None
    hold: Positive

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if not self.lower < self.upper:
            raise ValueError(
                f"lower = {self.lower:g} is not below upper = {self.upper:g}; give a range, the smaller first"
            )
        return self

    def actuator(self, name: str) -> "Actuator":
        """Return the input of that name with its range and rate in SI units."""
        from seatrial.core.results import Actuator

        factor = si_unit(self.unit)[0]
        rate = math.inf if self.rate is None else self.rate * factor
        return Actuator(name, self.lower * factor, self.upper * factor, rate, self.hold)


class _BySymbol:
    """Validates amounts by symbol and keeps their SI values; a stated unit must be one of the symbol's."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return no_info_after_validator_function(_values_by_symbol, handler.generate_schema(dict[str, SiAmount]))


def _values_by_symbol(amounts: dict[str, Amount]) -> dict[str, float]:
    for symbol, amount in amounts.items():
        if amount.unit is not None and si_unit(amount.unit)[1] != _input_unit(symbol):
            raise InputError(f"'{amount.unit}' is no unit of '{symbol}', which is in {_input_unit(symbol)}")
    return {symbol: amount.in_si for symbol, amount in amounts.items()}


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class DesignRequest:
    """`[design]`: how long the manoeuvre lasts, what may be moved, and what it must keep to.

    Attributes:
        duration: s.
        rate: Hz at which the sensors are recorded.
        inputs: name -> range of the input that may be moved.
        held: other inputs, constant, SI in the record's signs; absent wind, waves and fins are at rest.
        speed: approach speed u [m/s]; None: where surge balances.
        criterion: what is made small.
        draws: number of ships drawn from the prior, besides the model.
        prior_percent: by how much free coefficients without a prior may differ.
        drift: largest drift angle [rad]; sea_room: largest distance from the start [m]; None: free.
        every_ship: whether the limits bind every ship drawn, and not only the one assumed.
    """

    duration: PositiveDuration
    rate: Positive
    inputs: Annotated[Mapping[str, InputRange], Field(min_length=1)]
    held: Annotated[Mapping[str, float], _BySymbol()] = Field(default_factory=dict)
    speed: PositiveSpeed | None = None
    criterion: DesignCriterion = DesignCriterion.WORST
    draws: Annotated[int, Field(ge=0, le=1000)] = 24
    prior_percent: Annotated[float, Field(gt=0, lt=100)] = 30.0
    drift: PositiveAngle | None = None
    sea_room: PositiveLength | None = None
    every_ship: bool = True

    @cached_property
    def actuators(self) -> "tuple[Actuator, ...]":
        """The inputs that may be moved, SI."""
        return tuple(input_range.actuator(name) for name, input_range in self.inputs.items())

    def with_hold(self, hold: float) -> "DesignRequest":
        """Return the request with another shortest time between two orders of every input [s]."""
        return replace(
            self, inputs={name: replace(input_range, hold=hold) for name, input_range in self.inputs.items()}
        )

    @property
    def limits(self) -> "TrialLimits":
        """What the trial may not leave, SI."""
        from seatrial.core.results import TrialLimits

        drift, room = (math.inf if limit is None else limit for limit in (self.drift, self.sea_room))
        return TrialLimits(drift, room, self.every_ship)

    @property
    def relative_spread(self) -> float:
        """Share by which free coefficients without a prior may differ."""
        return self.prior_percent / 100.0


def refuse_unsuitable(request: DesignRequest, model: Model, length: float) -> None:
    """Refuse a request that does not go with the model or with a ship of that length [m].

    Raises:
        InputError: an input that the model does not have or that is both moved and held, a range in another unit, a
            limit that cannot be kept, too short a trial.
    """
    if request.duration * request.rate < _MIN_SAMPLES:
        raise InputError(
            f"design.duration: {request.duration:g} s at {request.rate:g} Hz are fewer than {_MIN_SAMPLES} samples; "
            "make it longer, or raise design.rate"
        )
    for name, moved in request.inputs.items():
        _refuse_unsuitable_input(name, moved, model, request.duration)
    for name in request.held:
        _require_input(name, f"design.held.{name}", model)
        if name in request.inputs:
            raise InputError(f"design: input '{name}' is named under both 'inputs' and 'held'; keep one")
    if request.drift is not None and request.drift >= _HALF_TURN:
        raise InputError(
            f"design.drift: {math.degrees(request.drift):g} degrees are no limit of a drift angle; write it with its "
            'unit, such as { value = 20, unit = "deg" }, or leave it out'
        )
    if request.sea_room is not None and request.sea_room < length:
        raise InputError(
            f"design.sea_room: {request.sea_room:g} m are less than the ship's length of {length:g} m; no manoeuvre "
            "keeps within"
        )
    if request.speed is not None and not model.has_speed:
        raise InputError(f"design.speed: model '{model.name}' has no surge velocity u to approach with; leave it out")


def _refuse_unsuitable_input(name: str, moved: InputRange, model: Model, duration: float) -> None:
    where = f"design.inputs.{name}"
    _require_input(name, where, model)
    if si_unit(moved.unit)[1] != _input_unit(name):
        raise InputError(
            f"{where}.unit: '{moved.unit}' is no unit of what is measured in {_input_unit(name)}; write one that is"
        )
    if moved.hold > duration:
        raise InputError(f"{where}.hold = {moved.hold:g} s is longer than the trial of {duration:g} s; shorten it")
    actuator = moved.actuator(name)
    largest = max(abs(actuator.lower), abs(actuator.upper))
    if _input_unit(name) == "rad" and largest >= _HALF_TURN:
        raise InputError(
            f"{where}: {math.degrees(largest):g} degrees are no angle to order; write the range with its unit, such "
            'as unit = "deg"'
        )


def _require_input(name: str, where: str, model: Model) -> None:
    if name not in model.input_names:
        raise InputError(
            f"{where}: '{name}' is no input of model '{model.name}'{spelling_hint(name, [*model.input_names])}"
        )


def _input_unit(name: str) -> str:
    return NOTATION[name].unit if name in NOTATION else "1"
