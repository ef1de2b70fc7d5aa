"""Chapters of a result on the terminal: those that a level wants, with tables whose columns line up."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from seatrial.cli.screen import is_verbose, print_heading, print_lines, print_table

if TYPE_CHECKING:
    from seatrial.reporting.section import Section, TextTable


def print_sections(chapters: "Iterable[Section]") -> None:
    """Print chapters with their parts: with --verbose also details, notes, and all that is folded on the page."""
    for chapter in chapters:
        _print_section(chapter)


def _print_section(section: "Section") -> None:
    from seatrial.reporting.section import Level

    if not section or section.level > (Level.DETAIL if is_verbose() else Level.NORMAL):
        return
    if section.title and _has_text(section):
        print_heading(section.title)
    print_lines([*map(str, section.sentences), *(f"- {text}" for text in section.points)], "  ")
    if section.table:
        print_text_table(section.table)
    if is_verbose() and section.note:
        print_lines([section.note], "  ")
    parts = [part for part in section.parts if part]
    chosen = parts if is_verbose() or section.unfolded is None else parts[: section.unfolded]
    print_sections(chosen)
    if len(parts) > len(chosen):
        print_lines([f"... and {len(parts) - len(chosen)} more; --verbose and the report show them"])


def _has_text(section: "Section") -> bool:
    """Whether anything of the section itself is printed below its title."""
    return bool(section.sentences or section.points or (section.table and _columns(section.table)))


def _columns(table: "TextTable") -> list[int]:
    """The columns that are printed."""
    from seatrial.reporting.section import Level

    wanted = Level.DETAIL if is_verbose() else Level.NORMAL
    return [k for k, heading in enumerate(table.headings) if heading.level <= wanted]


def print_text_table(table: "TextTable") -> None:
    """Print the columns of a table that a terminal shows: without --verbose its first rows."""
    from seatrial.reporting.section import Kind

    used = _columns(table)
    if not used:
        return
    rows = table.rows if is_verbose() else table.first.rows
    header = [table.headings[k].text for k in used]
    cells = [[" ".join(part for part in (str(row.cells[k].text), _aside(row.cells[k].under)) if part) for k in used]
             for row in rows]  # fmt: skip
    words = [place for place, k in enumerate(used) if table.headings[k].kind is not Kind.NUMBER]
    print_table([header, *cells], flush_left=words, indent="  ")
    if len(rows) < len(table.rows):
        print_lines([f"... and {len(table.rows) - len(rows)} more; --verbose and the report show them"], "  ")


def _aside(text: str) -> str:
    return f"({text})" if text else ""
