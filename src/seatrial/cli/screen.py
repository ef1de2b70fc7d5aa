"""The terminal: its width, columns, and sections on it."""

import os
import shlex
import shutil
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from seatrial.reporting.section import Section, TextTable


# The screen: every line of a command goes through here, as --quiet, --verbose and the terminal's width have it.

# letters of a line at most and at least, however wide the terminal is; chosen: longer lines are hard to follow
MAX_WIDTH, MIN_WIDTH = 120, 40


class Detail(IntEnum):
    """How much a command prints: names of files and errors only, what matters, everything."""

    QUIET = 0
    NORMAL = 1
    VERBOSE = 2


_DETAIL: ContextVar[Detail] = ContextVar("detail", default=Detail.NORMAL)


def is_quiet() -> bool:
    """Return whether only names of files and errors are printed."""
    return _DETAIL.get() is Detail.QUIET


def is_verbose() -> bool:
    """Return whether everything is printed."""
    return _DETAIL.get() is Detail.VERBOSE


@contextmanager
def printing(detail: Detail) -> Iterator[None]:
    """Print so much within the block."""
    token = _DETAIL.set(detail)
    try:
        yield
    finally:
        _DETAIL.reset(token)


def line_width() -> int | None:
    """Return the letters of a line: those of the terminal, or of COLUMNS; None in a pipe, whose lines are not cut."""
    if not os.environ.get("COLUMNS", "").isdecimal() and not sys.stdout.isatty():
        return None
    return min(MAX_WIDTH, max(MIN_WIDTH, shutil.get_terminal_size().columns))


def in_shell(path: Path | str) -> str:
    """Return a path as it is typed in a command: quoted where it has spaces or brackets."""
    return shlex.quote(str(path))


def print_lines(lines: Iterable[str], indent: str = "") -> None:
    """Print lines without typographic signs, so that any terminal shows them and numbers can be copied."""
    from seatrial.core.text.plain import ascii_text, wrapped

    width = line_width()
    print_verbatim(part for line in lines for part in wrapped(ascii_text(line), width, indent))


def print_verbatim(lines: Iterable[str]) -> None:
    """Print lines as they are, such as those of a file or a command to be copied."""
    from seatrial.core.text.plain import safe_text

    if not is_quiet():
        for line in lines:
            print(safe_text(line))


def print_heading(text: str) -> None:
    """Print an empty line and a heading, bold on a terminal."""
    from seatrial.core.text.plain import ascii_text, wrapped

    if not is_quiet():
        lines = wrapped(ascii_text(text), line_width())
        typer.echo("\n" + "\n".join(typer.style(line, bold=True) for line in lines))


def print_table(
    rows: Sequence[Sequence[str]], flush_left: Sequence[int] = (0,), indent: str = "", verbatim: Sequence[int] = ()
) -> None:
    """Print rows whose columns line up; those of `flush_left` are flush left, those of `verbatim` to be copied."""
    from seatrial.core.text.plain import aligned, ascii_text

    width = line_width()
    room = None if width is None else width - len(indent)
    texts = [[cell if k in verbatim else ascii_text(cell) for k, cell in enumerate(row)] for row in rows]
    lines = aligned(texts, flush_left, room)
    print_verbatim(indent + line for line in lines)


def print_file(meaning: str, path: Path | str) -> None:
    """Print the name of a file that was written, however little is printed otherwise."""
    from seatrial.core.text.plain import safe_text

    print(safe_text(f"{meaning}: {path}"))


def print_next(command: str) -> None:
    """Print the command to type next, in one line and with the letters of headings, so that it can be copied."""
    print_verbatim([f"Next: {command}"])


# Chapters of a result on the terminal: those that a level wants, with tables whose columns line up.


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
