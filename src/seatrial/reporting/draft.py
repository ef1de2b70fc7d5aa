"""The page of a drafted trial: what each column is taken for, and every run with its manoeuvres."""

from seatrial.core.text.words import counted
from seatrial.core.values import Record
from seatrial.data.draft import ColumnGuess, DraftTrial, LogRun, LogStretch
from seatrial.reporting.document import chapters_page
from seatrial.reporting.figures.record_charts import log_view
from seatrial.reporting.section import Cell, FirstScreen, Picture, Section, name, number, table_of, words
from seatrial.reporting.time_figures import run_figure

_OPEN_RUNS = 3  # runs whose drawing is unfolded; chosen: what one scrolls through
_LEFT_OUT = (
    "Parts that stand behind a # in the trial file are left out: remove the # to use them, or put one before a part "
    "that is not to be used."
)


def html(draft: DraftTrial, title: str) -> str:
    """Return the self-contained page; title: the name of the trial file beside it."""
    return chapters_page("drafted trial", title, FirstScreen(verdict(draft), ()), sections(draft))


def sections(draft: DraftTrial) -> list[Section]:
    """Return the chapters: columns with what they are read as, runs with their parts."""
    return [_columns([g for part in draft.guesses for g in part if g.is_used]), _runs(draft)]


def verdict(draft: DraftTrial) -> str:
    """Return how much was found: runs, manoeuvres, and columns that are to be decided."""
    parts = sum(map(len, draft.stretches))
    runs = f"{counted(len(draft.runs), 'run')} with {counted(parts, 'manoeuvre')} found"
    undecided = len(draft.open_questions)
    return (
        f"{runs}; {counted(undecided, 'column')} to decide." if undecided else f"{runs}; no column is left to decide."
    )


def _columns(guesses: list[ColumnGuess]) -> Section:
    table = table_of(
        guesses,
        words("Channel", lambda g: g.symbol),
        name("Column", lambda g: str(g.source)),
        words("Read as", _meaning),
        words("Because", lambda g: "; ".join(g.evidence)),
        words("Or", lambda g: Cell(g.other_reading, tone="bad")),
    )
    is_open = any(g.other_reading for g in guesses)
    return Section(
        "Columns", "columns", ("To decide: the readings of the last column.",) if is_open else (), table=table
    )


def _meaning(guess: ColumnGuess) -> str:
    parts = (guess.unit, guess.frame, f"positive {guess.positive}" if guess.positive else "")
    return ", ".join(part for part in parts if part)


def _runs(draft: DraftTrial) -> Section:
    readable = [
        (run, record, offered or stretches)
        for run, record, stretches, offered in zip(draft.runs, draft.records, draft.stretches, draft.parts, strict=True)
        if record is not None
    ]
    is_left_out = any(part.is_left_out for offered in draft.parts for part in offered)
    parts = tuple(_run(number, *run) for number, run in enumerate(readable))
    return Section("Runs and their manoeuvres", "runs", (_LEFT_OUT,) if is_left_out else (), parts=parts)


def _run(place: int, run: LogRun, record: Record, parts: tuple[LogStretch, ...]) -> Section:
    table = table_of(
        enumerate(parts, start=1),
        words("Part", lambda item: f"{item[0]} {item[1].name}"),
        number("from", lambda item: f"{item[1].start:.4g}", "s"),
        number("to", lambda item: f"{item[1].stop:.4g}", "s"),
        words("Because", lambda item: item[1].evidence),
    )
    return Section(
        f"{run.name or run.sources[0].path.name}, {counted(len(parts), 'part')}",
        f"run-{place}",
        table=table,
        pictures=(Picture(lambda: run_figure(*log_view(record, parts))),),
        is_folded=place >= _OPEN_RUNS,
    )
