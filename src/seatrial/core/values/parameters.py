"""Parameters: ordered named values with unit, bounds, prior, free or fixed, and source."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from seatrial.core.text.words import NAMES_SHOWN, enumeration
from seatrial.core.values.arrays import Array
from seatrial.core.values.errors import InputError, spelling_hint


@dataclass(frozen=True)
class Prior:
    """Gaussian knowledge of one parameter before the fit, in its unit, with its source.

    is_spread_assumed: whether nobody knows how far the mean may be wrong, and a share of it stands for that.
    """

    mean: float
    standard_deviation: float
    source: str = ""
    is_spread_assumed: bool = False


NOT_MEASURED = "estimated, not measured"
"""How the source of a value begins that a rule gives, and no measurement of the craft."""


@dataclass(frozen=True)
class Parameter:
    """One named value of a model.

    Attributes:
        name: the field's symbol in ASCII, e.g. ``Y_vvr``.
        value: NaN where the user must give it (ship particulars).
        unit: SI unit, ``1`` for nondimensional.
        lower, upper: bounds; infinite where there are none.
        scale: smallest size that counts: priors in per cent refer to it where the value is smaller.
        prior: Gaussian knowledge, used only while the parameter is free.
        free: whether an estimator may move it.
        source: citation or file it comes from.
        meaning: what the symbol stands for.
        latex: how it is printed.
    """

    name: str
    value: float = math.nan
    unit: str = "1"
    lower: float = -math.inf
    upper: float = math.inf
    scale: float = 0.0
    prior: Prior | None = None
    free: bool = False
    source: str = ""
    meaning: str = ""
    latex: str = ""

    def __post_init__(self) -> None:
        if not self.lower <= self.upper:
            raise InputError(f"parameter '{self.name}': lower bound {self.lower:g} exceeds upper bound {self.upper:g}")

    @property
    def characteristic_scale(self) -> float:
        """The magnitude of the value or `scale`, whichever is larger; 1 where both are 0."""
        return max(self.scale, abs(self.value)) or 1.0


@dataclass(frozen=True)
class Parameters:
    """An immutable ordered set of parameters; every change returns a new one.

    Raises:
        InputError: a name is not among the parameters (the nearest is named).
    """

    items: tuple[Parameter, ...]

    def __iter__(self) -> Iterator[Parameter]:
        return iter(self.items)

    def __len__(self) -> int:
        return len(self.items)

    def __repr__(self) -> str:
        free = [f"{p.name} = {p.value:.5g}" for p in self.items if p.free]
        fixed = [p.name for p in self.items if not p.free]
        return f"<Parameters: {_names_text('free', free)}; {_names_text('fixed', fixed)}>"

    def __contains__(self, name: str) -> bool:
        return name in self._index_by_name

    def __getitem__(self, name: str) -> Parameter:
        return self.items[self.index(name)]

    @cached_property
    def _index_by_name(self) -> dict[str, int]:
        return {p.name: i for i, p in enumerate(self.items)}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """All names in order."""
        return tuple(p.name for p in self.items)

    @property
    def values(self) -> Array:
        """All values in order, shape (n,)."""
        return np.array([p.value for p in self.items])

    @property
    def free(self) -> tuple[Parameter, ...]:
        """The parameters an estimator may move."""
        return tuple(p for p in self.items if p.free)

    @property
    def free_names(self) -> tuple[str, ...]:
        """Names of the free ones."""
        return tuple(p.name for p in self.free)

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of parameters without a value."""
        return tuple(p.name for p in self.items if math.isnan(p.value))

    def value_of(self, name: str, default: float) -> float:
        """Return the value of a parameter, the default where there is none of that name."""
        return self[name].value if name in self else default

    def index(self, name: str) -> int:
        """Return the position of a name."""
        if name not in self._index_by_name:
            raise InputError(f"unknown parameter '{name}'{spelling_hint(name, list(self.names))}")
        return self._index_by_name[name]

    def _with_changes(self, changes: Mapping[str, Mapping[str, object]]) -> Self:
        for name in changes:
            self.index(name)
        return replace(self, items=tuple(replace(p, **changes[p.name]) if p.name in changes else p for p in self.items))  # type: ignore[arg-type]

    def with_values(self, values: Mapping[str, float], source: str | None = None) -> Self:
        """Return the parameters with new values, and their source if given."""
        extra = {} if source is None else {"source": source}
        return self._with_changes({name: {"value": float(value), **extra} for name, value in values.items()})

    def with_free_values(self, point: Array) -> Self:
        """Return the parameters with new values of the free ones, in order, shape (k,)."""
        return self.with_values(dict(zip(self.free_names, point, strict=True)))

    def fixed(self, *names: str) -> Self:
        """Return the parameters with the named ones fixed at their values."""
        return self._with_changes({name: {"free": False} for name in names})

    def freed(self, *names: str) -> Self:
        """Return the parameters with the named ones free."""
        return self._with_changes({name: {"free": True} for name in names})

    def only_free(self, names: Iterable[str]) -> Self:
        """Return the parameters with exactly the named ones free."""
        wanted = set(names)
        return self._with_changes({n: {"free": n in wanted} for n in (*self.names, *wanted)})

    def bounded(self, name: str, lower: float, upper: float) -> Self:
        """Return the parameters with new bounds of one of them, in its unit."""
        return self._with_changes({name: {"lower": lower, "upper": upper}})

    def with_priors(self, priors: Mapping[str, Prior]) -> Self:
        """Return the parameters with Gaussian priors, by name."""
        return self._with_changes({name: {"prior": prior} for name, prior in priors.items()})

    def without_priors(self) -> Self:
        """Return the parameters without any prior."""
        return self._with_changes({name: {"prior": None} for name in self.names})


def _names_text(kind: str, names: list[str]) -> str:
    return f"{len(names)} {kind}" + (f" ({enumeration(names, NAMES_SHOWN)})" if names else "")
