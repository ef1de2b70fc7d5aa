"""Types of the fields of a result: what each becomes in JSON, and how it is read back.

`seatrial.data.folder` writes, documents and reads every result by these annotations; nothing else describes one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo, WithJsonSchema
from pydantic_core import CoreSchema, core_schema

from seatrial.core.equations import Model
from seatrial.core.values import Array, Finding, Record, Severity, frozen
from seatrial.numerics.optimise import Solution, Status

JsonSchema = dict[str, Any]
_NUMBER: JsonSchema = {"type": ["number", "null"]}
_TEXT: JsonSchema = {"type": "string"}
_NUMBERS: JsonSchema = {"type": "array", "items": {"type": ["number", "null", "array"]}}
ABSENT = object()
"""What a serialiser returns for a key that is left out."""
STORED_KEY = "x-stored"
"""Key of a JSON Schema that marks a value kept in arrays.npz; `--json` leaves it out."""

Number = Annotated[float, WithJsonSchema(_NUMBER)]
"""A number that may be infinite or unknown (NaN): null in JSON."""
Cell = str | int | float | None
"""An entry of a printed table."""


class StoredValues(Protocol):
    """What a reader offers to the fields that are kept in arrays.npz."""

    def array(self, name: str) -> Array:
        """Return the array of that name."""
        ...

    def record(self, name: str) -> Record:
        """Return the record whose channels lie under that name."""
        ...


class NamedValues:
    """Numbers to be written under the names that the document lists under `key`: shape (n,), or rows of such."""

    def __init__(self, key: str, values: Array) -> None:
        self.key, self.values = key, values


class StoredValue:
    """A record on its way to arrays.npz: no dataclass, which the serialiser would take apart."""

    def __init__(self, record: Record) -> None:
        self.record = record


@dataclass(frozen=True)
class FieldFormat:
    """How the values of one Python type are written to JSON and read from it.

    Attributes:
        type: values of it are passed on as they are.
        write: value -> what JSON holds; arrays and records that it leaves are stored in arrays.npz by the writer.
        read: what JSON holds, and the reader -> value.
        schema: JSON Schema of what is written.
    """

    type: type
    write: Callable[[Any], Any]
    read: Callable[[Any, StoredValues], Any]
    schema: JsonSchema

    def __get_pydantic_core_schema__(self, _source: Any, _handler: GetCoreSchemaHandler) -> CoreSchema:
        def validate(value: Any, info: ValidationInfo) -> Any:
            if isinstance(value, self.type):
                return value
            stored: Any = info.context
            try:
                return self.read(value, stored)
            except (TypeError, LookupError, AttributeError) as error:  # else the name of the field would be lost
                raise ValueError(f"no {self.type.__name__} ({type(error).__name__}: {error})") from None

        write = core_schema.plain_serializer_function_ser_schema(self.write)
        return core_schema.with_info_plain_validator_function(validate, serialization=write)

    def __get_pydantic_json_schema__(self, _core: CoreSchema, _handler: GetJsonSchemaHandler) -> JsonSchema:
        return dict(self.schema)


def _unchanged(value: Any, *_: object) -> Any:
    return value


def _array(rows: Any, _: StoredValues) -> Array:
    return frozen(np.array(rows, dtype=np.float64))


def _complex_rows(values: NDArray[np.complex128]) -> list[list[float]]:
    return np.stack([values.real, values.imag], axis=-1).tolist()


def _complex_array(rows: Any, _: StoredValues) -> NDArray[np.complex128]:
    parts = np.array(rows, dtype=np.float64).reshape(-1, 2)
    return parts[:, 0] + 1j * parts[:, 1]


def _named_array(table: Any, _: StoredValues) -> Array:
    rows = [list(row.values()) for row in table] if isinstance(table, list) else list(table.values())
    return frozen(np.array(rows, dtype=np.float64))


def _finding_table(finding: Finding) -> dict[str, str]:
    return {
        "severity": finding.severity.value, "code": finding.code, "text": finding.text,
        "evidence": finding.evidence, "advice": finding.advice,
    }  # fmt: skip


def _finding(table: Any, _: StoredValues) -> Finding:
    """The message is the text without the evidence that stands behind it in brackets."""
    message = table["text"].removesuffix(f" ({table['evidence']})") if table["evidence"] else table["text"]
    return Finding(Severity(table["severity"]), table["code"], message, table["evidence"], table["advice"])


def _solution_table(solution: Solution) -> dict[str, Any]:
    return vars(solution) | {"status": solution.status.name}


def _solution(table: Any, stored: StoredValues) -> Solution:
    return Solution(
        stored.array(table["point"]), table["value"], Status[table["status"]], table["evaluations"],
        tuple(table["history"]), table["seed"],
    )  # fmt: skip


ListedArray = Annotated[Array, FieldFormat(np.ndarray, lambda values: values.tolist(), _array, _NUMBERS)]
"""A short array, written out in the document."""
ComplexArray = Annotated[NDArray[np.complex128], FieldFormat(np.ndarray, _complex_rows, _complex_array, _NUMBERS)]
"""Complex numbers, written as pairs of real and imaginary part."""
StoredArray = Annotated[
    Array,
    FieldFormat(np.ndarray, _unchanged, lambda name, stored: stored.array(name), _TEXT | {STORED_KEY: True}),
]
"""A long array, kept in arrays.npz; the document names it."""
StoredRecord = Annotated[
    Record, FieldFormat(Record, StoredValue, lambda name, stored: stored.record(name), _TEXT | {STORED_KEY: True})
]
"""A record, kept in arrays.npz under the name that the document gives."""
NamedModel = Annotated[Model, FieldFormat(Model, lambda model: model.name, _unchanged, _TEXT)]
"""A model; the document gives its name, model.toml the rest."""
ReportedFinding = Annotated[Finding, FieldFormat(Finding, _finding_table, _finding, {
    "type": "object", "title": "Finding", "required": ["severity", "code", "text", "evidence", "advice"],
    "properties": {
        "severity": {"enum": [severity.value for severity in Severity]},
        "code": _TEXT | {"description": "short stable identifier"},
        "text": _TEXT | {"description": "one sentence naming the record and channel, its evidence in brackets"},
        "evidence": _TEXT | {"description": "the numbers it rests on"},
        "advice": _TEXT | {"description": "what the user can do"},
    },
})]  # fmt: skip
"""A finding of a check or an estimate."""
StoredSolution = Annotated[Solution, FieldFormat(Solution, _solution_table, _solution, {
    "type": "object", "title": "Solution",
    "properties": {
        "point": _TEXT | {STORED_KEY: True, "description": "the optimiser's point, in arrays.npz"},
        "value": _NUMBER | {"description": "objective at the point"},
        "status": {"enum": [status.name for status in Status]},
        "evaluations": {"type": "integer", "description": "number of objective evaluations"},
        "history": _NUMBERS | {"description": "best value after each iteration"},
        "seed": {"type": ["integer", "null"], "description": "of the search, where it draws at random"},
    },
})]  # fmt: skip
"""A point, its value and how it was reached."""


def named_by(key: str) -> FieldFormat:
    """Return the format of an array whose last axis runs over the names listed under `key` of the document."""
    schema = {
        "anyOf": [{"type": "object", "additionalProperties": _NUMBER}, {"type": "array", "items": {"type": "object"}}]
    }
    return FieldFormat(np.ndarray, lambda values: NamedValues(key, values), _named_array, schema)
