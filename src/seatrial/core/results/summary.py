"""A result as a short table, in text and in HTML, as an interactive session shows it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape

GAP = 2
"""Spaces between two columns of a text table."""


@dataclass(frozen=True, repr=False)
class Summary:
    """A table to print: `print(fit.summary())`, or the last line of a notebook cell.

    Attributes:
        title: what it is about.
        header: heading of each column; the first column holds names and is aligned left, the others right.
        rows: text of each cell, one entry for each column.
        facts: name -> value, printed above the table.
        notes: sentences printed below it.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    facts: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        lines = (self.header, *self.rows)
        widths = [max(len(line[i]) for line in lines) for i in range(len(self.header))]
        names = max(map(len, self.facts), default=0)
        facts = [f"{name + ':':<{names + GAP}}{value}" for name, value in self.facts.items()]
        table = [_text_line(line, widths) for line in lines]
        rule = "=" * max(sum(widths) + GAP * (len(widths) - 1), len(self.title))
        return "\n".join([self.title, rule, *facts, *(["-" * len(rule)] if facts else []), *table, rule, *self.notes])

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        facts = "".join(f"<tr><th>{escape(n)}</th><td>{escape(v)}</td></tr>" for n, v in self.facts.items())
        head = "".join(f"<th>{escape(cell)}</th>" for cell in self.header)
        body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in self.rows)
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        return (
            f"<table><caption>{escape(self.title)}</caption>{facts}</table>"
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{notes}"
        )


class Summarised:
    """A result that an interactive session shows by its summary, and in one line where it stands within others."""

    def summary(self) -> Summary:
        """Return the result as a short table."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        return self.summary()._repr_html_()

    def __repr__(self) -> str:
        summary = self.summary()
        facts = ", ".join(f"{name} {value}" for name, value in summary.facts.items())
        return f"<{summary.title}: {facts}>"


def _text_line(cells: tuple[str, ...], widths: list[int]) -> str:
    first, *rest = zip(cells, widths, strict=True)
    return (" " * GAP).join([first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in rest)]).rstrip()
