"""Tables and figures of a study, as values: nothing here draws."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Cell, ListedArray, Number, StoredArray
from seatrial.core.values import InputError


@dataclass(frozen=True)
class Table:
    """A table to print."""

    title: str
    header: Annotated[tuple[str, ...], Field(description="one entry for each column, with its unit")]
    rows: Annotated[
        tuple[tuple[Cell, ...], ...], Field(description="text or numbers in the header's units; null prints as a dash")
    ]
    note: Annotated[str, Field(description="one sentence below it")] = ""


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a figure."""

    name: str
    x: Annotated[StoredArray, Field(description="shape (n,)")]
    y: Annotated[StoredArray, Field(description="shape (n,)")]


@dataclass(frozen=True, eq=False)
class Figure:
    """Curves over one pair of axes."""

    title: str
    x_label: Annotated[str, Field(description="with its unit")]
    y_label: Annotated[str, Field(description="with its unit")]
    curves: tuple[Curve, ...]
    note: str = ""
    is_map: Annotated[bool, Field(description="equal scales on both axes (tracks)")] = False


@dataclass(frozen=True, eq=False)
class Bars:
    """Grouped bars: a group for each label, in it one bar for each series.

    Raises:
        InputError: a series has not one value for each label, or a value on a logarithmic axis is negative.
    """

    title: str
    labels: tuple[str, ...]
    series: Annotated[
        Mapping[str, tuple[Number | None, ...]], Field(description="name -> one value for each label; null: none")
    ]
    unit: Annotated[str, Field(description="label of the axis, the quantity with its unit")]
    note: str = ""
    is_logarithmic: bool = False

    def __post_init__(self) -> None:
        for name, values in self.series.items():
            if len(values) != len(self.labels):
                raise InputError(
                    f"bars '{self.title}': series '{name}' has {len(values)} values for {len(self.labels)} labels"
                )
            if self.is_logarithmic and any(v is not None and v < 0.0 for v in values):
                raise InputError(
                    f"bars '{self.title}': series '{name}' has a negative value, which a logarithmic axis cannot show"
                )


@dataclass(frozen=True, eq=False)
class Matrix:
    """A matrix as coloured cells with numbers, one colour above zero, another below.

    Raises:
        InputError: `values` has another shape than its names.
    """

    title: str
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    values: Annotated[ListedArray, Field(description="shape (rows, columns); null leaves a cell empty")]
    note: str = ""
    limit: Annotated[
        float | None,
        Field(description="magnitude at which the colour is full, 1 for correlations; null: the largest of `values`"),
    ] = 1.0

    def __post_init__(self) -> None:
        expected = (len(self.rows), len(self.columns))
        if self.values.shape != expected:
            raise InputError(f"matrix '{self.title}': values of shape {self.values.shape} have names for {expected}")
