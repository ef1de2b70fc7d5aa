"""Keys of a trial file given other values: `estimate.rate`, `records.1.rate`."""

import copy
from collections.abc import Mapping
from typing import Any

from seatrial.core.values import InputError


def overridden(table: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of the tables of a trial file with other values of some keys, which need not exist yet.

    Args:
        overrides: path with dots -> value; blocks such as `[[records]]` count from 1.

    Raises:
        InputError: a path leads through a value that is no table, or to a block that does not exist.
    """
    result = copy.deepcopy(dict(table))
    for path, value in overrides.items():
        *steps, last = path.split(".")
        place: Any = result
        for step in steps:
            place = _inner(place, step, path)
        if isinstance(place, list):
            place[_block(place, last, path)] = value
        else:
            place[last] = value
    return result


def _inner(place: Any, step: str, path: str) -> Any:
    inner = place[_block(place, step, path)] if isinstance(place, list) else place.setdefault(step, {})
    if not isinstance(inner, dict | list):
        raise InputError(f"grid.'{path}': '{step}' is a value, no table; correct the path")
    return inner


def _block(blocks: list[Any], step: str, path: str) -> int:
    if not step.isdigit() or not 1 <= int(step) <= len(blocks):
        raise InputError(f"grid.'{path}': there is no block '{step}'; they are numbered from 1 to {len(blocks)}")
    return int(step) - 1
