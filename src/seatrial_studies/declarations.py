"""What a page must declare of a paper and of its repetition: symbols, assumptions, deviations, figures."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.results import Table

TIME_IS_NO_VERDICT = (
    "A limit on computing time does not separate a right result from a wrong one: for one and the same result the time "
    "is work over speed, and the speed depends on the machine and on what else it does. The work is counted instead."
)
"""Derivation by which a check on computing time is withdrawn."""


@dataclass(frozen=True)
class Symbol:
    """A symbol of the paper: its meaning, unit, and value or where it is printed."""

    symbol: str
    meaning: str
    unit: str
    value: str


@dataclass(frozen=True)
class Assumption:
    """Something the paper does not print, or the text at hand has lost, and what stands in its place here."""

    quantity: str
    printed: str
    assumed: str


@dataclass(frozen=True)
class Deviation:
    """Something that is done otherwise than printed, and why."""

    place: str
    printed: str
    done: str
    reason: str


@dataclass(frozen=True)
class FigureCounterpart:
    """A figure of the paper: titles of what shows the same thing here, or the reason why nothing does."""

    figure: str
    content: str
    counterparts: tuple[str, ...] = ()
    reason: str = ""


@dataclass(frozen=True)
class Declarations:
    """Everything that a page declares.

    Raises:
        ValueError: a figure has neither a counterpart nor a reason.
    """

    symbols: tuple[Symbol, ...]
    assumptions: tuple[Assumption, ...]
    deviations: tuple[Deviation, ...]
    figures: tuple[FigureCounterpart, ...]

    def __post_init__(self) -> None:
        for figure in self.figures:
            if not (figure.counterparts or figure.reason):
                raise ValueError(f"{figure.figure} has neither a counterpart nor a reason why there is none")

    def tables(self, note: str = "") -> tuple[Table, ...]:
        """Return the four tables of the page; `note` stands below the assumptions."""
        return (
            Table(
                "Figures of the paper",
                ("Figure", "it shows", "here"),
                tuple((f.figure, f.content, ", ".join(f.counterparts) or f.reason) for f in self.figures),
                "Each figure of the paper with what shows the same thing on this page, or why nothing does.",
            ),
            Table(
                "Symbols",
                ("Symbol", "meaning", "unit", "value"),
                tuple((s.symbol, s.meaning, s.unit, s.value) for s in self.symbols),
            ),
            Table(
                "Assumed",
                ("quantity", "print", "here"),
                tuple((a.quantity, a.printed, a.assumed) for a in self.assumptions),
                note,
            ),
            Table(
                "Deviations from the print",
                ("Place", "print", "here", "because"),
                tuple((d.place, d.printed, d.done, d.reason) for d in self.deviations),
            ),
        )

    def missing_counterparts(self, titles: Sequence[str]) -> tuple[str, ...]:
        """Return the counterparts that are not among the titles of a page's tables and figures."""
        return tuple(title for f in self.figures for title in f.counterparts if title not in titles)
