"""Results as strict JSON with an archive of arrays, and back, by the types of their fields: one way for every result.

A number that JSON does not know (infinity, NaN) is null; in a folder, `non_finite` lists which null is which, by JSON
Pointer (RFC 6901), so that a result reloads exactly. Long arrays and records are left out of a document, or stored.
"""

import io
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, NotRequired, TypeVar

import numpy as np
from pydantic import TypeAdapter, ValidationError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaWarningKind
from typing_extensions import TypedDict  # that of Python 3.11 is refused by pydantic

from seatrial.core.results.fields import ABSENT, STORED_KEY, NamedValues, ReportedFinding, StoredValue
from seatrial.core.values import Array, Channel, Finding, Provenance, Record, RecordKind, frozen


def npz_bytes(arrays: Mapping[str, Array]) -> bytes:
    """Return a compressed .npz file."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **dict(arrays))  # type: ignore[arg-type]
    return buffer.getvalue()


def npz_arrays(content: bytes) -> dict[str, Array]:
    """Return the inverse of `npz_bytes`; pickles are refused.

    Raises:
        ValueError: it is no such file.
    """
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            return {name: frozen(file[name]) for name in file.files}
    except Exception as error:  # zipfile, zlib and NumPy raise a dozen unrelated types on damaged archives
        raise ValueError(f"arrays.npz: {error}") from None


_MEASURED = " is measured"  # behind a symbol, of the array that says so


def record_arrays(record: Record, prefix: str) -> dict[str, Array]:
    """Return the record's numbers under `prefix/symbol`, and which of them were measured where not all were."""
    masks = {f"{prefix}/{s}{_MEASURED}": c.is_measured for s, c in record.channels.items() if c.is_measured is not None}
    values = {f"{prefix}/{s}": c.values for s, c in record.channels.items()}
    return {f"{prefix}/t": record.time, **values, **{name: frozen(mask) for name, mask in masks.items()}}


def record_from_arrays(table: Mapping[str, Any], arrays: Mapping[str, Array], prefix: str) -> Record:
    """Return the record of its metadata and arrays, the inverse of `Record.metadata` and `record_arrays`."""
    channels = {s: Channel(arrays[f"{prefix}/{s}"], **metadata) for s, metadata in table["channels"].items()}
    for symbol, channel in channels.items():
        if (mask := arrays.get(f"{prefix}/{symbol}{_MEASURED}")) is not None:
            channels[symbol] = channel.with_measured(mask > 0.0)
    provenance = Provenance.from_metadata(table["provenance"])
    return Record(table["name"], arrays[f"{prefix}/t"], channels, RecordKind(table["kind"]), provenance)


FORMAT = 3
"""Of every document; 1 described a fit twice and kept nothing of a design, a tuning or a study to render."""
T = TypeVar("T")
Table = dict[str, Any]
NON_FINITE, STORED_RECORDS = "non_finite", "stored_records"


def document(result: object) -> Table:
    """Return what `--json` writes: every described field and derived value, without long arrays and records."""
    table = _adapter(type(result)).dump_python(result)
    return {"format": FORMAT, **_Writer(table, None).table()}


def stored_document(result: object, repeated: frozenset[str] = frozenset()) -> tuple[Table, dict[str, Array]]:
    """Return what a folder keeps of a result, and the arrays it names.

    Args:
        result: any value of described fields.
        repeated: derived values that stand elsewhere in the folder and are left out.
    """
    arrays: dict[str, Array] = {}
    writer = _Writer(_adapter(type(result)).dump_python(result, exclude=set(repeated)), arrays)
    table = writer.table()
    kept = {
        STORED_RECORDS: {name: record.metadata for record, name in writer.records.values()},
        NON_FINITE: writer.non_finite,
    }
    return {"format": FORMAT, **table, **{key: value for key, value in kept.items() if value}}, arrays


def read_document(kind: type[T], table: Table, arrays: Mapping[str, Array]) -> T:
    """Return the result of a stored document, the inverse of `stored_document`.

    Raises:
        ValueError: the table is damaged; the text names the entry.
        KeyError: an entry or array is missing.
    """
    for pointer, text in table.get(NON_FINITE, {}).items():
        _set_number(table, pointer, float(text))
    try:
        return _adapter(kind).validate_python(table, context=_Stored(arrays, table.get(STORED_RECORDS, {})))
    except ValidationError as error:
        raise ValueError(_first_error(error)) from None


def _first_error(error: ValidationError) -> str:
    """Return the first entry that is wrong, and how."""
    first = error.errors()[0]
    return f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}"


def document_schema(kind: type) -> Table:
    """Return the JSON Schema of a result's document.

    Required are the keys that stand both in the document of `--json` and in that of a folder.
    """
    schema = _adapter(kind).json_schema(mode="serialization", schema_generator=_SchemaWriter)
    for table in (schema, *schema.get("$defs", {}).values()):
        properties = table.get("properties", {})
        optional = {name for name, entry in properties.items() if entry.get("readOnly") or _is_stored(entry)}
        if "required" in table:
            table["required"] = [name for name in table["required"] if name not in optional]
    schema["properties"] = _FRAME | schema["properties"]
    return schema


def findings_document(findings: tuple[Finding, ...]) -> Table:
    """Return what `check --json` writes."""
    tables = TypeAdapter(tuple[ReportedFinding, ...]).dump_python(findings)
    more = (
        {"consequence": finding.consequence, "edits": [str(edit) for edit in finding.edits]} for finding in findings
    )
    return {"findings": [table | rest for table, rest in zip(tables, more, strict=True)]}


def strict_json(table: Mapping[str, Any]) -> str:
    """Return JSON text.

    Raises:
        ValueError: an infinite number or NaN is left in the table, which is an error of the program.
    """
    return json.dumps(table, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


_FRAME: Table = {
    "format": {"const": FORMAT, "description": "of the document"},
    "files": {
        "type": "object", "additionalProperties": {"type": "string"},
        "description": "SHA-256 of model.toml and arrays.npz, in a folder",
    },
    STORED_RECORDS: {
        "type": "object", "additionalProperties": {"type": "object"},
        "description": "meaning of the records in arrays.npz: name, kind, provenance, channels",
    },
    NON_FINITE: {
        "type": "object", "additionalProperties": {"enum": ["nan", "inf", "-inf"]},
        "description": "JSON Pointer of a null -> the number it stands for, in a folder",
    },
}  # fmt: skip
"""Schema of the keys that stand around the fields of a result."""


class _SchemaWriter(GenerateJsonSchema):
    """Without titles that repeat a key, and without a remark on defaults that are left out."""

    ignored_warning_kinds: set[JsonSchemaWarningKind] = {"skipped-choice", "non-serializable-default"}  # noqa: RUF012

    def field_title_should_be_set(self, schema: object) -> bool:  # noqa: ARG002
        return False


@cache
def _adapter(kind: type[T]) -> TypeAdapter[T]:
    return TypeAdapter(kind)


def _is_stored(entry: object) -> bool:
    """Whether a schema says that a value, or all that a container holds, stands in arrays.npz."""
    if not isinstance(entry, dict):
        return False
    return STORED_KEY in entry or _is_stored(entry.get("items")) or _is_stored(entry.get("additionalProperties"))


class _ChannelTable(TypedDict):
    """As `Channel.metadata`."""

    unit: str
    frame: str
    positive: str
    reference_point: float
    label: str
    kind: NotRequired[str]
    between: NotRequired[str]
    sample_s: NotRequired[float]


class _ProvenanceTable(TypedDict):
    """As `Provenance.from_metadata` reads it."""

    source: str
    sha256: str
    steps: list[str]


class _RecordTable(TypedDict):
    """As `Record.metadata`."""

    name: str
    kind: str
    provenance: _ProvenanceTable
    channels: dict[str, _ChannelTable]


@dataclass(frozen=True)
class _Stored:
    """The arrays of a folder and what their records mean."""

    arrays: Mapping[str, Array]
    records: Mapping[str, Table]
    _read: dict[str, Record] = field(default_factory=dict)

    def array(self, name: str) -> Array:
        return self.arrays[name]

    def record(self, name: str) -> Record:
        """Return the record; the same object wherever the document names it."""
        if name not in self._read:
            try:
                _adapter(_RecordTable).validate_python(self.records[name])
                self._read[name] = record_from_arrays(self.records[name], self.arrays, name)
            except ValidationError as error:
                raise ValueError(f"{STORED_RECORDS}.{name}.{_first_error(error)}") from None
            except (KeyError, ValueError) as error:
                raise ValueError(f"{STORED_RECORDS}.{name}: {error}") from None
        return self._read[name]


@dataclass
class _Writer:
    """Turns the values of a dumped result into JSON; `arrays` takes what is stored, None leaves it out."""

    root: Table
    arrays: dict[str, Array] | None
    records: dict[int, tuple[Record, str]] = field(default_factory=dict)
    non_finite: dict[str, str] = field(default_factory=dict)

    def table(self) -> Table:
        return self._value(self.root, "")

    def _value(self, value: Any, pointer: str) -> Any:
        if isinstance(value, Mapping):
            table = {str(key): self._value(inner, f"{pointer}/{_escaped(str(key))}") for key, inner in value.items()}
            kept = {key: inner for key, inner in table.items() if inner is not ABSENT}
            return kept if kept or not table else ABSENT
        if isinstance(value, list | tuple):
            items = [self._value(inner, f"{pointer}/{index}") for index, inner in enumerate(value)]
            present = [item for item in items if item is not ABSENT]
            return present if present or not items else ABSENT
        if isinstance(value, NamedValues):
            return self._value(self._named(value), pointer)
        if isinstance(value, StoredValue):
            return self._record_name(value.record)
        if isinstance(value, np.ndarray):
            return self._array_name(value, pointer.removeprefix("/"))
        if isinstance(value, float) and not math.isfinite(value):
            self.non_finite[pointer] = str(float(value))
            return None
        return value.item() if isinstance(value, np.generic) else value

    def _named(self, named: NamedValues) -> object:
        names = tuple(self.root[named.key])
        rows = [dict(zip(names, row, strict=True)) for row in np.atleast_2d(named.values).tolist()]
        return rows[0] if named.values.ndim == 1 else rows

    def _array_name(self, values: Array, name: str) -> object:
        if self.arrays is None:
            return ABSENT
        self.arrays[name] = values
        return name

    def _record_name(self, record: Record) -> object:
        if self.arrays is None:
            return ABSENT
        if id(record) not in self.records:
            name = f"record{len(self.records)}"
            self.records[id(record)] = (record, name)
            self.arrays |= record_arrays(record, name)
        return self.records[id(record)][1]


def _escaped(key: str) -> str:
    return key.replace("~", "~0").replace("/", "~1")


def _set_number(table: Any, pointer: str, number: float) -> None:
    """Put a number where a JSON Pointer leads."""
    *path, last = [key.replace("~1", "/").replace("~0", "~") for key in pointer.split("/")[1:]]
    for key in path:
        table = table[int(key) if isinstance(table, list) else key]
    table[int(last) if isinstance(table, list) else last] = number
