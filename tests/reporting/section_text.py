"""What a section says, for tests that read it."""

from collections.abc import Iterator

from seatrial.reporting.section import Section, TextTable


def header(table: TextTable | None) -> tuple[str, ...]:
    """Return the heads of a table, with units."""
    assert table is not None
    return tuple(heading.text for heading in table.headings)


def cells(table: TextTable | None) -> list[tuple[str, ...]]:
    """Return the rows of a table as text."""
    assert table is not None
    return [tuple(str(cell.text) for cell in row.cells) for row in table.rows]


def parts_of(section: Section) -> Iterator[Section]:
    """Yield a section and all its parts that have content, in order."""
    if section:
        yield section
        for part in section.parts:
            yield from parts_of(part)


def part(section: Section, title: str) -> Section:
    """Return the part of this title."""
    return next(one for one in parts_of(section) if one.title == title)


def text_of(section: Section) -> str:
    """Return all that a section says but for its pictures."""
    pieces: list[str] = []
    for one in parts_of(section):
        pieces += [str(one.title), *map(str, one.sentences), *map(str, one.points), one.note]
        pieces += [p.caption for p in one.pictures]
        if one.table:
            pieces += [*header(one.table), *(text for row in cells(one.table) for text in row)]
    return " ".join(pieces)
