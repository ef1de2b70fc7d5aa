"""Amounts of trial and loop files: a number with its unit, a plain SI value once validated."""

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core.core_schema import CoreSchema, no_info_after_validator_function

from seatrial.core.values import InputError, si_unit

STRICT_FIELDS = ConfigDict(extra="forbid", allow_inf_nan=False)


class StrictTable(BaseModel):
    """A table of a file: no unknown keys, immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def _valid_unit(unit: object) -> object:
    if isinstance(unit, str):
        si_unit(unit)
    return unit


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _as_amount(value: object) -> object:
    """A bare number is an amount in SI units."""
    return {"value": value} if _is_number(value) else value


def _as_standard_deviation(value: object) -> object:
    """A bare number is a standard deviation in SI units; None is one that nobody states."""
    return {} if value is None else {"sd": value} if _is_number(value) else value


Unit = Annotated[str, BeforeValidator(_valid_unit)]


class Amount(StrictTable):
    """A number with its unit; without one it is SI."""

    value: float
    unit: Unit | None = None

    @property
    def in_si(self) -> float:
        """The value in SI units."""
        return self.value * (si_unit(self.unit)[0] if self.unit else 1.0)


class StandardDeviation(StrictTable):
    """A standard deviation with its unit; without one it is SI."""

    sd: Annotated[float, Field(ge=0)] | None = None
    unit: Unit | None = None

    @property
    def in_si(self) -> float | None:
        """The standard deviation in SI units, None where it is not stated."""
        return None if self.sd is None else self.sd * (si_unit(self.unit)[0] if self.unit else 1.0)


SiAmount = Annotated[Amount, BeforeValidator(_as_amount, json_schema_input_type=float | Amount)]
SiStandardDeviation = Annotated[
    StandardDeviation, BeforeValidator(_as_standard_deviation, json_schema_input_type=float | StandardDeviation)
]


@dataclass(frozen=True)
class InSi:
    """Validates a number or a table {value, unit} and keeps the value in SI units.

    Attributes:
        unit: SI unit of the quantity, which a stated unit must measure; empty: any.
        is_positive: whether zero and below are refused.
        table: the table in which the amount may be written.
    """

    unit: str = ""
    is_positive: bool = False
    table: type[Amount] | type[StandardDeviation] = Amount

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        written = SiAmount if self.table is Amount else SiStandardDeviation
        return no_info_after_validator_function(self._in_si, handler.generate_schema(written))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(schema), **({"x-unit": self.unit} if self.unit else {})}

    def _in_si(self, amount: Amount | StandardDeviation) -> float | None:
        if self.unit and amount.unit and si_unit(amount.unit)[1] != self.unit:
            raise InputError(f"'{amount.unit}' is no unit of what is measured in {self.unit}; write one that is")
        number = amount.value if isinstance(amount, Amount) else amount.sd
        if self.is_positive and number is not None and not number > 0.0:
            raise InputError(f"{number:g} is not positive; give a positive one")
        return amount.in_si


# amounts that stay as they are written, with the SI unit of a bare number for schema and reference
Metres = Annotated[SiAmount, Field(json_schema_extra={"x-unit": "m"})]
Seconds = Annotated[SiAmount, Field(json_schema_extra={"x-unit": "s"})]
Radians = Annotated[SiAmount, Field(json_schema_extra={"x-unit": "rad"})]
MetresPerSecond = Annotated[SiAmount, Field(json_schema_extra={"x-unit": "m/s"})]
RadiansPerSecond = Annotated[SiAmount, Field(json_schema_extra={"x-unit": "rad/s"})]
Speed = Annotated[float, InSi("m/s")]
Angle = Annotated[float, InSi("rad")]
PositiveLength = Annotated[float, InSi("m", is_positive=True)]
PositiveDuration = Annotated[float, InSi("s", is_positive=True)]
PositiveSpeed = Annotated[float, InSi("m/s", is_positive=True)]
PositiveAngle = Annotated[float, InSi("rad", is_positive=True)]
Deviation = Annotated[float | None, InSi(is_positive=True, table=StandardDeviation)]
DelayDeviation = Annotated[float | None, InSi("s", table=StandardDeviation)]  # 0: the delay is known to be none
