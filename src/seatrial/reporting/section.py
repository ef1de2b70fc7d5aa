"""Sections: what a screen, a page and a notebook say of a result, as values."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, IntEnum
from typing import Generic, TypeVar

from markupsafe import Markup

from seatrial.core.results import Table
from seatrial.core.text.numbers import DASH, significant
from seatrial.core.text.words import counted
from seatrial.core.values import Finding, Severity, worst_first

# A chapter of a result as data, which page and terminal render alike: sentences, a table, pictures, parts.

T = TypeVar("T")


class Level(IntEnum):
    """Where something is printed besides the page."""

    NORMAL = 0
    DETAIL = 1
    """On the terminal with --verbose only."""
    PAGE = 2
    """On no terminal."""


class Kind(Enum):
    """How a column is set."""

    WORDS = "words"
    NUMBER = "num"
    NAME = "name"
    FORMULA = "formula"


@dataclass(frozen=True)
class Cell:
    """A cell of a table; `under`: a smaller line below it on the page; `tone`: good, warn or bad, empty: neither."""

    text: str | Markup = ""
    under: str = ""
    tone: str = ""


@dataclass(frozen=True)
class Heading:
    """The head of a column; `is_wide`: whether narrow screens leave the column out."""

    title: str
    unit: str = ""
    kind: Kind = Kind.WORDS
    level: Level = Level.NORMAL
    is_wide: bool = False

    @property
    def text(self) -> str:
        """Title and unit in one line."""
        return ", ".join(part for part in (self.title, self.unit) if part)


@dataclass(frozen=True, eq=False)
class Column(Generic[T]):
    """A column of a table of things: its head, and what it shows of each of them."""

    heading: Heading
    content: Callable[[T], str | Cell | None]


def words(title: str, content: Callable[[T], str | Cell | None], *, level: Level = Level.NORMAL,
             is_wide: bool = False) -> Column[T]:  # fmt: skip
    """Return a column of words."""
    return Column(Heading(title, "", Kind.WORDS, level, is_wide), content)


def name(title: str, content: Callable[[T], str | Cell | None]) -> Column[T]:
    """Return a column of names as they are typed."""
    return Column(Heading(title, "", Kind.NAME), content)


def number(title: str, content: Callable[[T], str | Cell | None], unit: str = "", *, level: Level = Level.NORMAL,
              is_wide: bool = False) -> Column[T]:  # fmt: skip
    """Return a column of numbers, flush right."""
    return Column(Heading(title, unit, Kind.NUMBER, level, is_wide), content)


def formula(title: str, content: Callable[[T], Markup]) -> Column[T]:
    """Return a column of formulae, on the page only."""
    return Column(Heading(title, "", Kind.FORMULA, Level.PAGE, is_wide=True), content)


@dataclass(frozen=True)
class Row:
    """Cells in the order of the heads; `is_marked`: the row that matters; `group`: a line above, where it changes."""

    cells: tuple[Cell, ...]
    is_marked: bool = False
    group: str | Markup = ""


@dataclass(frozen=True)
class TextTable:
    """Heads and rows; `unfolded`: rows that are printed without --verbose and unfolded on the page, None: all."""

    headings: tuple[Heading, ...]
    rows: tuple[Row, ...]
    unfolded: int | None = None

    def __bool__(self) -> bool:
        """Whether it has any row."""
        return bool(self.rows)

    @property
    def first(self) -> "TextTable":
        """The rows that are shown."""
        return self if self.unfolded is None else replace(self, rows=self.rows[: self.unfolded], unfolded=None)

    @property
    def folded(self) -> "TextTable":
        """The rows that are not."""
        return replace(self, rows=() if self.unfolded is None else self.rows[self.unfolded :], unfolded=None)


def table_of(
    items: Iterable[T], *columns: Column[T], is_marked: Callable[[T], bool] = lambda _: False,
    group: Callable[[T], str | Markup] = lambda _: "", unfolded: int | None = None,
) -> TextTable:  # fmt: skip
    """Return a row for each thing; columns in which nothing stands are left out."""
    cells = [([_cell(column.content(item)) for column in columns], is_marked(item), group(item)) for item in items]
    used = [k for k in range(len(columns)) if any(row[k].text not in ("", DASH) for row, *_ in cells)]
    rows = tuple(Row(tuple(row[k] for k in used), marked, above) for row, marked, above in cells)
    return TextTable(tuple(columns[k].heading for k in used), rows, unfolded)


def _cell(value: str | Cell | None) -> Cell:
    return value if isinstance(value, Cell) else Cell(value or "")


def plain_table(header: Sequence[str], rows: Iterable[Sequence[str]], *, flush_left: Sequence[int] = (0,)) -> TextTable:
    """Return a table of texts whose columns are numbers but for those of `flush_left`; -1: the last."""
    places = {k % len(header) for k in flush_left} if header else set()
    kinds = [Kind.WORDS if k in places else Kind.NUMBER for k in range(len(header))]
    headings = tuple(Heading(title, "", kind) for title, kind in zip(header, kinds, strict=True))
    return TextTable(headings, tuple(Row(tuple(Cell(text) for text in row)) for row in rows))


def fact_table(facts: Mapping[str, str | Markup]) -> TextTable:
    """Return facts by their names, those without text left out."""
    stated = ((fact, text) for fact, text in facts.items() if text)
    return table_of(stated, words("", lambda row: row[0]), words("", lambda row: row[1]))


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture of the page with its caption, drawn when it is wanted; an empty drawing is left out.

    narrow: the same for narrow screens; None: the one for wide ones.
    """

    draw: Callable[[], str]
    caption: str = ""
    narrow: Callable[[], str] | None = None


@dataclass(frozen=True, eq=False)
class Section:
    """A chapter, or a part of one, in the order in which it is shown.

    Attributes:
        key: anchor on the page; empty: none.
        level: where it is printed besides the page; is_folded: whether the page folds it.
        points: sentences as a list; note: how table and pictures are to be read.
        widget: markup of the page alone.
        unfolded: parts that are printed without --verbose; None: all.
    """

    title: str
    key: str = ""
    sentences: tuple[str | Markup, ...] = ()
    points: tuple[str | Markup, ...] = ()
    table: TextTable | None = None
    note: str = ""
    pictures: tuple[Picture, ...] = ()
    parts: tuple["Section", ...] = ()
    widget: Markup = field(default_factory=Markup)
    level: Level = Level.NORMAL
    is_folded: bool = False
    unfolded: int | None = None

    def __bool__(self) -> bool:
        """Whether it has any content."""
        return bool(self.sentences or self.points or self.table or self.pictures or self.widget or any(self.parts))


def result_section(table: Table) -> Section:
    """Return the part with a table of a result, its numbers as text: columns in which all are numbers flush right."""
    flush_left = [
        k for k in range(len(table.header)) if any(isinstance(row[k], str) for row in table.rows if k < len(row))
    ]
    rows = [[_number_text(cell, table.digits) for cell in row] for row in table.rows]
    return Section(table.title, table=plain_table(table.header, rows, flush_left=flush_left), note=table.note)


def _number_text(cell: str | float | None, digits: int) -> str:
    if cell is None:
        return DASH
    return str(cell) if isinstance(cell, (str, int)) else significant(cell, digits)


# What every page answers first: a sentence with its number, a picture, a short table.


@dataclass(frozen=True)
class KeyFact:
    """A row of the table at the top.

    Attributes:
        section: key of the section that says more; empty: none.
        is_good: what the mark at the row says; None: neither good nor bad.
    """

    name: str
    text: str
    section: str = ""
    is_good: bool | None = None


@dataclass(frozen=True)
class FirstScreen:
    """A verdict, its table, and a picture with its caption; an empty picture or lead is not shown.

    lead: what the result means to those who operate the craft, in a sentence.
    gains: symbols and values of a controller, under `gains_title`.
    """

    verdict: str
    facts: tuple[KeyFact, ...]
    figure: Markup = field(default_factory=Markup)
    caption: str = ""
    lead: str = ""
    gains_title: str = ""
    gains: tuple[tuple[str | Markup, str], ...] = ()


# The chapter on findings: grouped by code and advice, the most severe first, causes before what they cause.

# findings of a group that are shown unfolded
MAX_UNFOLDED = 3
_TITLE = Markup('<span class="severity {}">{}</span><code>{}</code>')


def finding_section(findings: Sequence[Finding]) -> Section:
    """Return the chapter on the findings of a result, on the page, notes behind a fold; empty where there are none."""
    groups: dict[tuple[str, str, str], list[Finding]] = {}
    for f in worst_first(findings):
        groups.setdefault((f.severity, f.code, f.advice), []).append(f)
    warnings = tuple(_group(group) for group in groups.values() if group[0].severity is not Severity.INFO)
    notes = tuple(_group(group) for group in groups.values() if group[0].severity is Severity.INFO)
    count = sum(len(group) for group in groups.values() if group[0].severity is Severity.INFO)
    fold = (Section(counted(count, "note"), parts=notes, is_folded=True),) if notes else ()
    return Section("Findings", "findings", parts=(*warnings, *fold), level=Level.PAGE)


def _group(findings: Sequence[Finding]) -> Section:
    """Findings of one code with the same advice: the first few, the others behind a fold."""
    first, texts = findings[0], [f.text for f in findings]
    more = Section(f"{len(texts) - MAX_UNFOLDED} more", points=tuple(texts[MAX_UNFOLDED:]), is_folded=True)
    statements = [("What follows", first.consequence), ("Advice", first.advice)]
    advice = Section("", sentences=tuple(f"{name}: {text}." for name, text in statements if text))
    return Section(
        _TITLE.format(first.severity.value, first.severity.value, first.code),
        points=tuple(texts[:MAX_UNFOLDED]),
        parts=(more, advice),
    )
