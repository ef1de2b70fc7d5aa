"""Tasks that cost nothing, for tests of stores and engines; other processes import them."""

import os
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from seatrial.campaigns import Row, Work
from seatrial.core.values import InputError


def squares(keys: Mapping[str, Any]) -> Sequence[Row]:
    """Two rows; every seventh seed fails, and every eleventh does so with an error of the program."""
    seed = keys["seed"]
    if seed % 7 == 6:
        raise InputError(f"seed {seed} has no square today; take another")
    if seed % 11 == 10:
        return [{"row": 1 / (seed % 11 - 10)}]
    known = {"lower": 0.0, "upper": 40.0, "truth": 1.0, "bound": 2.0, "standard_error": 1.0}
    values = {"a": (seed + 0.1) ** 2, "b": (seed + 0.1) ** 0.5}
    return [{"row": "coefficient", "name": n, "unit": "1", "estimate": v, **known} for n, v in values.items()]


def slow_squares(keys: Mapping[str, Any]) -> Sequence[Row]:
    """The same, after a while."""
    time.sleep(0.05)
    return squares(keys)


def dies_once(keys: Mapping[str, Any]) -> Sequence[Row]:
    """Ends its process at the first attempt of seed 3, and at every attempt of seed 5."""
    mark = Path(keys["folder"]) / str(keys["seed"])
    if keys["seed"] == 5 or (keys["seed"] == 3 and not mark.exists()):
        mark.touch()
        os._exit(9)
    return [{"value": keys["seed"]}]


def work(count: int = 30, function: Any = squares, **description: Any) -> Work:
    """A campaign of so many seeds."""
    return Work({"kind": "squares", **description}, [{"seed": seed} for seed in range(count)], function)
