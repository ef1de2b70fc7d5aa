"""Types of the fields of a result, its short table, and sentences in place of parts that cannot be computed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from html import escape
from typing import Annotated, Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo, WithJsonSchema
from pydantic_core import CoreSchema, core_schema

from seatrial.core.equations import Model
from seatrial.core.values import Array, Finding, InputError, Record, Severity, frozen
from seatrial.numerics.optimise import Solution, Status

# Types of the fields of a result: what each becomes in JSON, and how it is read back.

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


# A result as a short table, in text and in HTML, as an interactive session shows it.

GAP = 2
"""Spaces between two columns of a text table."""


@dataclass(frozen=True, repr=False)
class Summary:
    """A table to print: `print(fit.summary())`, or the last line of a notebook cell.

    Attributes:
        title: what it is about.
        header: heading of each column; the first column holds names and is aligned left, the others right.
        rows: text of each cell, one entry for each column.
        facts: name -> value, printed above the table.
        notes: sentences printed below it.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    facts: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        lines = (self.header, *self.rows)
        widths = [max(len(line[i]) for line in lines) for i in range(len(self.header))]
        names = max(map(len, self.facts), default=0)
        facts = [f"{name + ':':<{names + GAP}}{value}" for name, value in self.facts.items()]
        table = [_text_line(line, widths) for line in lines]
        rule = "=" * max(sum(widths) + GAP * (len(widths) - 1), len(self.title))
        return "\n".join([self.title, rule, *facts, *(["-" * len(rule)] if facts else []), *table, rule, *self.notes])

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        facts = "".join(f"<tr><th>{escape(n)}</th><td>{escape(v)}</td></tr>" for n, v in self.facts.items())
        head = "".join(f"<th>{escape(cell)}</th>" for cell in self.header)
        body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in self.rows)
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        return (
            f"<table><caption>{escape(self.title)}</caption>{facts}</table>"
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{notes}"
        )


class Summarised:
    """A result that an interactive session shows by its summary, and in one line where it stands within others."""

    def summary(self) -> Summary:
        """Return the result as a short table."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        return self.summary()._repr_html_()

    def __repr__(self) -> str:
        summary = self.summary()
        facts = ", ".join(f"{name} {value}" for name, value in summary.facts.items())
        return f"<{summary.title}: {facts}>"


def _text_line(cells: tuple[str, ...], widths: list[int]) -> str:
    first, *rest = zip(cells, widths, strict=True)
    return (" " * GAP).join([first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in rest)]).rstrip()


# Parts of a finished result that cannot be computed: each is a sentence in its place, and the rest stays.

Part = TypeVar("Part")

_ERRORS = (InputError, ArithmeticError, ValueError, LookupError, TypeError, AttributeError)
"""Of numbers that lead nowhere (ValueError: of linear algebra, too), and of results that were edited by hand."""


@dataclass
class MissingParts:
    """Notes which parts of a result were left out, and why.

    Attributes:
        findings: one for each part that could not be computed.
    """

    findings: list[Finding] = field(default_factory=list)

    def computed(self, name: str, compute: Callable[[], Part], otherwise: Part) -> Part:
        """Return a part of a result, or what stands for it where it cannot be computed; name: as users know it."""
        try:
            return compute()
        except _ERRORS as error:
            self.findings.append(
                Finding(
                    Severity.WARNING, "part-missing", f"the result is without {name}, which could not be computed",
                    _reason(error),
                )
            )  # fmt: skip
            return otherwise


def _reason(error: Exception) -> str:
    """Return why, in the error's words; with its kind where these were written for no user."""
    return str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
