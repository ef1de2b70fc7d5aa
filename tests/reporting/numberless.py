"""Results whose numbers are unknown, a field at a time: what templates print of a number that there is not."""

import dataclasses
from collections.abc import Iterator
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from seatrial.core.results.fields import Number

_MARK = get_args(Number)[1]


def numberless(value: Any, number: float) -> Iterator[tuple[str, Any]]:
    """Yield each field that may be unknown, and the result with that field (in every entry) as that number."""
    for name, hint in get_type_hints(type(value), include_extras=True).items():
        if name not in {field.name for field in dataclasses.fields(value)}:
            continue
        content = getattr(value, name)
        if _may_be_unknown(hint) and content is not None:
            yield name, dataclasses.replace(value, **{name: number})
        elif dataclasses.is_dataclass(content) and not isinstance(content, type):
            yield from ((f"{name}.{inner}", dataclasses.replace(value, **{name: made})) for inner, made in
                        numberless(content, number))  # fmt: skip
        elif isinstance(content, tuple) and content and dataclasses.is_dataclass(content[0]):
            for inner, _ in list(numberless(content[0], number)):
                rows = tuple(dict(numberless(row, number)).get(inner, row) for row in content)
                yield f"{name}.{inner}", dataclasses.replace(value, **{name: rows})


def _may_be_unknown(hint: Any) -> bool:
    return get_origin(hint) is Annotated and _MARK in get_args(hint)
