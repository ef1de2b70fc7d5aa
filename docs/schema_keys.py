"""The page that lists every key of a file: type, unit and default, from the schema of the file."""

import json
import re
from collections.abc import Iterator, Mapping
from inspect import getdoc
from typing import Any

from write_schemas import kind_of

JsonSchema = Mapping[str, Any]
REQUIRED = "required"


def schema_keys(schema: JsonSchema, classes: Mapping[str, object]) -> str:
    """Return a table for each table of the file, in the order in which they are met from the root.

    `classes`: those of the tables by name; a key that a table inherits has its meaning from the class that has it.
    """
    return "\n".join(_table(path, entry, schema, classes) for path, entry in _tables(schema))


def _tables(schema: JsonSchema) -> Iterator[tuple[str, JsonSchema]]:
    """Yield the heading and the schema of each table, every one once."""
    waiting, met = [("", schema)], set()
    while waiting:
        path, entry = waiting.pop(0)
        yield path, entry
        for key, value in entry.get("properties", {}).items():
            for name, form in _references(value):
                if name in met or not schema["$defs"][name].get("properties"):
                    continue
                met.add(name)
                waiting.append((form.format(f"{path.strip('[]')}.{key}".lstrip(".")), schema["$defs"][name]))


def _references(value: JsonSchema) -> Iterator[tuple[str, str]]:
    """Yield the tables that a value may be, each with how its heading is written."""
    if "$ref" in value and not _is_amount(value):
        yield value["$ref"].rpartition("/")[2], "[{}]"
    for part in value.get("anyOf", ()):
        yield from _references(part)
    for inner, form in ((value.get("items"), "[[{}]]"), (value.get("additionalProperties"), "[{}.NAME]")):
        if isinstance(inner, dict):
            yield from ((name, form) for name, _ in _references(inner))


def _table(path: str, entry: JsonSchema, schema: JsonSchema, classes: Mapping[str, object]) -> str:
    required = set(entry.get("required", ()))
    own = classes.get(entry["title"])
    bases = own.__mro__[1:] if isinstance(own, type) else ()
    meanings: dict[str, str] = {}
    for text in (*(getdoc(base) or "" for base in reversed(bases)), entry.get("description", "")):
        meanings |= _meanings(text, entry)
    columns = ["key", *(["meaning"] if meanings else []), "type", "default"]
    rows = [
        [
            f"`{key}`",
            *([meanings.get(key, "")] if meanings else []),
            _type(value, schema),
            REQUIRED if key in required else _default(value),
        ]
        for key, value in entry.get("properties", {}).items()
    ]
    heading = f"## Keys of `{path}`" if path else "## Keys outside any table"
    table = [f"| {' | '.join(cells)} |" for cells in (columns, *rows)]
    return "\n".join([heading, "", table[0], "|" + "---|" * len(columns), *table[1:], ""])


def _meanings(docstring: str, entry: JsonSchema) -> dict[str, str]:
    """Return what each key of a table means, from the section Attributes of a docstring."""
    listed = docstring.partition("Attributes:\n")[2]
    keys = "|".join(f"{key}_?" for key in entry.get("properties", {}))
    lines = re.sub(r"\n {5,}", " ", listed).replace("None:", "without it:").splitlines()
    meanings: dict[str, str] = {}
    for part in (part for line in lines for part in re.split(rf"; (?=(?:{keys}): )", line.strip())):
        names, _, text = part.partition(": ")
        meanings |= {name.rstrip("_"): text.rstrip(".").replace("|", "\\|") for name in names.split(", ")}
    return {name: text for name, text in meanings.items() if name in entry.get("properties", {})}


def _type(value: JsonSchema, schema: JsonSchema) -> str:
    """Return the type in words; an amount with the SI unit that counts where none is written."""
    if "$ref" in value:
        target = schema["$defs"][value["$ref"].rpartition("/")[2]]
        return _words(target["enum"]) if "enum" in target else "table"
    if "enum" in value:
        return _words(value["enum"])
    if "anyOf" in value:
        parts = list(_alternatives(value))
        unit = next((f" [{part['x-unit']}]" for part in (value, *value["anyOf"]) if "x-unit" in part), "")
        if any(map(_is_amount, parts)):
            rest = (_type(part, schema) for part in parts if not _is_amount(part) and part.get("type") != "number")
            return " or ".join(["amount" + unit, *rest])
        return " or ".join(dict.fromkeys(_type(part, schema) for part in parts)) + unit
    if value.get("type") == "array":
        return f"list of {_type(value['items'], schema)}" if isinstance(value.get("items"), dict) else "list"
    if value.get("type") == "object":
        values = value.get("additionalProperties")
        names = _type(value["propertyNames"], schema) if "propertyNames" in value else "name"
        return f"{names} → {_type(values, schema)}" if isinstance(values, dict) else "table"
    return kind_of(value)


def _words(values: list[str]) -> str:
    return ", ".join(f"`{json.dumps(value)}`" for value in values)


def _alternatives(value: JsonSchema) -> Iterator[JsonSchema]:
    """Yield what a value may be besides null, through nested alternatives."""
    for part in value["anyOf"]:
        if "anyOf" in part:
            yield from _alternatives(part)
        elif part.get("type") != "null":
            yield part


def _is_amount(part: JsonSchema) -> bool:
    return part.get("$ref", "").rpartition("/")[2] in ("Amount", "StandardDeviation")


def _default(value: JsonSchema) -> str:
    """Return the default as it is written; empty for none, and for tables, whose keys have their own."""
    default = value.get("default")
    if isinstance(default, dict):
        default = default.get("value")  # of an amount
    if isinstance(default, list):
        default = [item["name"] if isinstance(item, dict) and "name" in item else item for item in default]
    return "" if default is None or default in ("", []) else f"`{json.dumps(default, ensure_ascii=False)}`"
