"""The page of a drafted trial: what each column is taken for, and every run with its manoeuvres."""

from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.text.words import counted
from seatrial.core.values import Record
from seatrial.data.draft import ColumnGuess, DraftTrial, LogRun, LogStretch
from seatrial.reporting.document import page_text
from seatrial.reporting.figures.log_parts import log_view
from seatrial.reporting.time_figures import run_figure

TITLES = {"columns": "Columns", "runs": "Runs and their manoeuvres"}
_OPEN_RUNS = 3  # runs whose drawing is unfolded; chosen: what one scrolls through


@dataclass(frozen=True)
class ColumnRow:
    """A column as text."""

    symbol: str
    source: str
    meaning: str
    evidence: str
    other_reading: str


@dataclass(frozen=True)
class DrawnRun:
    """A run: its name, what was found, its parts, the drawing."""

    key: str
    name: str
    note: str
    parts: tuple[LogStretch, ...]
    figure: Markup


def html(draft: DraftTrial, title: str) -> str:
    """Return the self-contained page; title: the name of the trial file beside it."""
    rows = [_column_row(g) for part in draft.guesses for g in part if g.is_used]
    sections = [
        _run_section(number, run, record, offered or stretches)
        for number, (run, record, stretches, offered) in enumerate(
            zip(draft.runs, draft.records, draft.stretches, draft.parts, strict=True)
        )
        if record is not None
    ]
    context = {
        "title": title,
        "verdict": verdict(draft),
        "titles": TITLES,
        "rows": rows,
        "open_count": counted(len(draft.open_questions), "column") if draft.open_questions else "",
        "runs": sections,
        "has_left_out": any(part.is_left_out for offered in draft.parts for part in offered),
        "unfolded": _OPEN_RUNS,
    }
    return page_text("draft.html", context)


def verdict(draft: DraftTrial) -> str:
    """Return how much was found: runs, manoeuvres, and columns that are to be decided."""
    parts = sum(map(len, draft.stretches))
    runs = f"{counted(len(draft.runs), 'run')} with {counted(parts, 'manoeuvre')} found"
    undecided = len(draft.open_questions)
    return (
        f"{runs}; {counted(undecided, 'column')} to decide." if undecided else f"{runs}; no column is left to decide."
    )


def _column_row(guess: ColumnGuess) -> ColumnRow:
    words = (guess.unit, guess.frame, f"positive {guess.positive}" if guess.positive else "")
    meaning = ", ".join(word for word in words if word)
    return ColumnRow(guess.symbol, str(guess.source), meaning, "; ".join(guess.evidence), guess.other_reading)


def _run_section(number: int, run: LogRun, record: Record, parts: tuple[LogStretch, ...]) -> DrawnRun:
    name = run.name or run.sources[0].path.name
    figure = run_figure(*log_view(record, parts))
    return DrawnRun(f"run-{number}", name, counted(len(parts), "part"), parts, figure)
