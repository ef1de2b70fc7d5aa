"""Pickling of values that hold read-only mappings, which Python's pickle does not know: by their constructor."""

from dataclasses import fields
from types import MappingProxyType
from typing import Any


class PickledByConstructor:
    """A dataclass that is pickled as the call that makes it, so that it reaches other processes."""

    def __reduce__(self) -> tuple[Any, ...]:
        values = [getattr(self, field.name) for field in fields(self) if field.init]  # type: ignore[arg-type]
        return type(self), tuple(dict(value) if isinstance(value, MappingProxyType) else value for value in values)
