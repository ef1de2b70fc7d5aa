"""From a pydantic error to one sentence: the key's path, what is wrong with it, the nearest known key."""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import is_dataclass
from functools import wraps
from itertools import chain
from types import NoneType
from typing import Any, ParamSpec, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from seatrial.core.values import InputError, spelling_hint
from seatrial.data.trial.amounts import InSi

_Settings = TypeVar("_Settings")
_Arguments = ParamSpec("_Arguments")

_UNKNOWN_KEY = ("extra_forbidden", "unexpected_keyword_argument")
RENAMED_KEYS = {"criterion": "method"}
"""Key of earlier versions -> its name today, in the tables that have that name."""


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
    """Return the end of the sentence on an unknown key: the edit where it was renamed, else the nearest key."""
    key, keys = str(error["loc"][-1]), known_keys(table, error["loc"])
    renamed = RENAMED_KEYS.get(key)
    if renamed not in keys:
        return spelling_hint(key, keys)
    value = str(error["input"]) if isinstance(error["input"], str) else error["input"]
    return f", which is '{renamed}' now; write {renamed} = {json.dumps(value, default=str)}"


def schema_error(error: ValidationError, table: type, source: str) -> InputError:
    """Return the first fault as one sentence; an unknown key before a missing one, which may be its right spelling.

    source: the file, or the class of settings written in Python, with which the sentence begins.
    """
    first = min(error.errors(), key=lambda one: one["type"] not in _UNKNOWN_KEY)
    location = first["loc"]
    where = f"{source}: "
    match first["type"]:
        case kind if kind in _UNKNOWN_KEY:
            return InputError(f"{where}unknown key '{key_path(location)}'{_key_hint(first, table)}")
        case "missing":
            return InputError(f"{where}key '{key_path(location)}' is missing; add it")
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
