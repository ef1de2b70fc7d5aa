"""Amounts of trial and loop files: a number with its unit; and what is wrong with a key, in one sentence."""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, is_dataclass
from functools import wraps
from itertools import chain
from types import NoneType
from typing import Annotated, Any, ParamSpec, TypeVar, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import ErrorDetails
from pydantic_core.core_schema import CoreSchema, no_info_after_validator_function, simple_ser_schema

from seatrial.core.text.words import enumeration
from seatrial.core.values import InputError, si_unit, spelling_hint

# Amounts of trial and loop files: a number with its unit, a plain SI value once validated.

STRICT_FIELDS = ConfigDict(extra="forbid", allow_inf_nan=False)


class StrictTable(BaseModel):
    """A table of a file: no unknown keys, immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


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


class Quantities(StrictTable):
    """Numbers of one unit; without one they are SI.

    Attributes:
        values: the numbers; unit: of all of them.
    """

    values: Annotated[tuple[float, ...], Field(min_length=1)]
    unit: Unit | None = None


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
        return no_info_after_validator_function(
            self._in_si, handler.generate_schema(written), serialization=simple_ser_schema("float")
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(schema), **({"x-unit": self.unit} if self.unit else {})}

    def _in_si(self, amount: Amount | StandardDeviation) -> float | None:
        if self.unit and amount.unit and si_unit(amount.unit)[1] != self.unit:
            raise InputError(f"'{amount.unit}' is no unit of what is measured in {self.unit}; write one that is")
        number = amount.value if isinstance(amount, Amount) else amount.sd
        if self.is_positive and number is not None and not number > 0.0:
            raise InputError(f"{number:g} is not positive; give a positive one")
        return amount.in_si


Length = Annotated[float, InSi("m")]
Speed = Annotated[float, InSi("m/s")]
Angle = Annotated[float, InSi("rad")]
PositiveLength = Annotated[float, InSi("m", is_positive=True)]
PositiveDuration = Annotated[float, InSi("s", is_positive=True)]
PositiveSpeed = Annotated[float, InSi("m/s", is_positive=True)]
PositiveFrequency = Annotated[float, InSi("rad/s", is_positive=True)]
PositiveAngle = Annotated[float, InSi("rad", is_positive=True)]
Deviation = Annotated[float | None, InSi(is_positive=True, table=StandardDeviation)]
DelayDeviation = Annotated[float | None, InSi("s", table=StandardDeviation)]  # 0: the delay is known to be none


# From a pydantic error to one sentence: the key's path, what is wrong with it, the nearest known key.

_Settings = TypeVar("_Settings")
_Arguments = ParamSpec("_Arguments")

_UNKNOWN_KEY = ("extra_forbidden", "unexpected_keyword_argument")
RENAMED_KEYS = {"criterion": "method"}
"""Key of earlier versions -> its name today, in the tables that have that name."""
_DECIMAL = "leave it out: the decimal sign is read from the file"
_FORCE_TABLE = "leave it out: header and format are read from the file; name the columns as its header does"
_CUT = 'cut the run: parts = [{ name = "turn", from = "10 s", to = "130 s" }], s after its first sample'
WITHDRAWN_KEYS = {
    "records.decimal": _DECIMAL,
    "records.sources.decimal": _DECIMAL,
    "follow.decimal": _DECIMAL,
    **dict.fromkeys(
        (f"forces.{key}" for key in ("decimal", "separator", "encoding", "header_lines", "format")), _FORCE_TABLE
    ),
    "forces.weight": "write sd of the measured columns: a table weighs one over its square",
    "records.longest_gap": "leave it out: nothing is interpolated over five steps of a topic",
    "records.from_s": _CUT,
    "records.to_s": _CUT,
    "follow.longest_gap_s": "leave it out: a new run begins after 30 s without a sample",
    "compare.svr.candidates": "leave it out: all candidate terms of the model are offered",
    "compare.svr.scaled": "leave it out: columns and target are brought to unit root mean square",
    "compare.svr.max_iterations": "leave it out: the solver takes 100000 steps at most",
    "compare.svr.drop_duplicates": "leave it out: repeated samples go",
    "compare.svr.lambda_count": "leave it out: 49 penalties are tried, write lambda = [smallest, largest]",
    "family.prior_factors": "write priors under [model.priors] and compare the fits",
    "family.segment_factors": "write segment_s under [estimate] and compare the fits",
    "station.joint_Ms": "leave it out: 3 is allowed, write limits.Ms for each loop by itself",
    "controller.K_q": "leave it out: the value that was fitted to the published results is used",
    "uncertainty.draws": "leave it out: 1000 ships are drawn",
    "demand.duration": "leave it out: thirty time constants are simulated, write time_constant = seconds",
    "extended_structures.lower": "leave it out: the gains of the loop bound those that are added",
    "extended_structures.upper": "leave it out: the gains of the loop bound those that are added",
}
"""Key of earlier versions, with its tables -> what to do in its place: its value is decided where it is used."""


def _table_classes(annotation: object) -> Iterator[type]:
    """Yield every table class inside an annotation."""
    if isinstance(annotation, InSi):
        yield annotation.table
    if isinstance(annotation, type) and (issubclass(annotation, BaseModel) or is_dataclass(annotation)):
        yield annotation
    for inner in get_args(annotation):
        if inner is not NoneType:
            yield from _table_classes(inner)


def _fields_by_key(table: type) -> dict[str, Any]:
    fields = getattr(table, "__pydantic_fields__", {})
    return {field.alias or name: field for name, field in fields.items()}


def known_keys(table: type, location: Sequence[str | int]) -> list[str]:
    """Return the keys of the table that contains the last key of `location`."""
    for step in location[:-1]:
        field = _fields_by_key(table).get(str(step))
        if field is not None:
            amounts = (part.table for part in field.metadata if isinstance(part, InSi))
            table = next(chain(_table_classes(field.annotation), amounts), table)
    return sorted(_fields_by_key(table))


def key_path(location: Sequence[str | int]) -> str:
    """``records[1].channels.u.unit``; blocks are counted from 1."""
    path = ""
    for step in location:
        path += f"[{step + 1}]" if isinstance(step, int) else f".{step}" if path else step
    return path


def raises_input_error(table: type[_Settings]) -> type[_Settings]:
    """Make a validated dataclass raise `InputError` for wrong settings written in Python, as for those of a file."""
    setattr(table, "__init__", _checked_init(table.__init__, table))  # noqa: B010
    return table


def _checked_init(init: Callable[_Arguments, None], table: type) -> Callable[_Arguments, None]:
    @wraps(init)
    def checked(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> None:
        try:
            init(*args, **kwargs)
        except ValidationError as error:
            raise schema_error(error, table, table.__name__) from None

    return checked


def _key_hint(error: ErrorDetails, table: type) -> str:
    """Return the end of the sentence on an unknown key: the edit where it was renamed or left, else the nearest key."""
    key, keys = str(error["loc"][-1]), known_keys(table, error["loc"])
    renamed = RENAMED_KEYS.get(key)
    if withdrawn := WITHDRAWN_KEYS.get(".".join(step for step in error["loc"] if isinstance(step, str))):
        return f", which is no key any more; {withdrawn}"
    if renamed not in keys:
        return spelling_hint(key, keys)
    value = str(error["input"]) if isinstance(error["input"], str) else error["input"]
    return f", which is '{renamed}' now; write {renamed} = {json.dumps(value, default=str)}"


def schema_error(error: ValidationError, table: type, source: str) -> InputError:
    """Return the first fault as one sentence; an unknown key before a missing one, which may be its right spelling.

    With a missing key come all that its table lacks, of the tables in it too.

    source: the file, or the class of settings written in Python, with which the sentence begins.
    """
    faults = error.errors()
    first = min(faults, key=lambda fault: fault["type"] not in _UNKNOWN_KEY)
    location = first["loc"]
    where = f"{source}: "
    match first["type"]:
        case kind if kind in _UNKNOWN_KEY:
            return InputError(f"{where}unknown key '{key_path(location)}'{_key_hint(first, table)}")
        case "missing":
            places = (fault["loc"] for fault in faults if fault["type"] == "missing")
            missing = [f"'{key_path(place)}'" for place in places if place[: len(location) - 1] == location[:-1]]
            if len(missing) == 1:
                return InputError(f"{where}key {missing[0]} is missing; add it")
            return InputError(f"{where}keys {enumeration(missing)} are missing; add them")
        case "value_error":
            key = f"{key_path(location)}: " if location else ""
            return InputError(f"{where}{key}{first.get('ctx', {}).get('error', first['msg'])}")
        case "tuple_type" if isinstance(first["input"], dict):
            return InputError(
                f"{where}{key_path(location)} is one table where a list of them belongs; write it as "
                f"[[{key_path(location)}]]"
            )
        case "tuple_type":
            return InputError(f"{where}{key_path(location)} = {first['input']!r} is no list; put it into brackets")
        case "too_short":
            kind = "table" if isinstance(first["input"], dict) else "list"
            return InputError(f"{where}{key_path(location)} is an empty {kind}; give at least one entry")
        case "model_type" | "dataclass_type":
            return InputError(
                f"{where}{key_path(location)} = {first['input']!r} is neither a table nor a number; write one"
            )
        case "path_type":
            return InputError(f"{where}{key_path(location)} = {first['input']!r}: input should be a valid string")
        case _:
            message = first["msg"][0].lower() + first["msg"][1:]
            return InputError(f"{where}{key_path(location)} = {first['input']!r}: {message}")
