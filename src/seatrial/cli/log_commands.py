"""Commands on logs: what is in one, and a trial file drafted from several."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seatrial.cli.application import app
from seatrial.cli.screen import in_shell, print_file, print_lines, print_next, print_table, print_verbatim

if TYPE_CHECKING:
    from seatrial.data.draft import ColumnGuess, ColumnSummary, DraftTrial, LogSurvey, SurveyedLogs, TopicSummary
    from seatrial.data.draft.runs_of_logs import OtherSpeed

COLUMNS_SHOWN = 12  # columns of a topic that `check` lists without --all; ours, one screen for a log of a few topics
REASONS_SHOWN = 3  # why known columns are not needed, of which the file has all; ours
DIGITS = 5  # significant ones of a range; chosen
DRAFT = Path("trial.toml")  # what a drafted trial file is named; ours
_NAMES = (0, 2)  # the column that holds names of the log, in the table of a topic and in that of guesses
_TEXT_COLUMNS = (0, 1, 5)  # of the table of a topic: name, unit and channel
TOPICS_SHOWN = 15  # topics, the same way


@app.command()
def init(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="Logs of any format, or folders with logs.")],
    out: Annotated[Path, typer.Option("--out", metavar="TRIAL.toml", help="The trial file to write.")] = DRAFT,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the trial file where it exists.")] = False,
    length: Annotated[
        float, typer.Option("--length", metavar="METRES", help="Length of the craft; without it the file asks for it.")
    ] = 0.0,
    beam: Annotated[float, typer.Option("--beam", metavar="METRES", help="Breadth, else estimated.")] = 0.0,
    draught: Annotated[float, typer.Option("--draught", metavar="METRES", help="Draught, else estimated.")] = 0.0,
    mass: Annotated[float, typer.Option("--mass", metavar="KG", help="Mass, displacement, else estimated.")] = 0.0,
    gear: Annotated[
        float, typer.Option("--gear", metavar="RATIO", help="Turns of the engine for each of the propeller.")
    ] = 0.0,
    rho: Annotated[
        float, typer.Option("--rho", metavar="KG/M^3", help="Density of the water, else sea water's; fresh has 1000.")
    ] = 0.0,
    scale: Annotated[float, typer.Option("--scale", metavar="RATIO", help="Scale of a model: 40 for 1:40.")] = 0.0,
    propeller: Annotated[float, typer.Option("--propeller", metavar="METRES", help="Diameter, else estimated.")] = 0.0,
    rudder: Annotated[float, typer.Option("--rudder", metavar="M^2", help="Area, else estimated.")] = 0.0,
    gm: Annotated[float, typer.Option("--gm", metavar="METRES", help="Metacentric height, of roll decays.")] = 0.0,
    antenna: Annotated[
        float | None,
        typer.Option("--antenna", metavar="METRES", help="GNSS antenna forward of midship; negative: abaft."),
    ] = None,
    name: Annotated[str, typer.Option("--name", metavar="NAME", help="Of the craft, for the report.")] = "",
    column: Annotated[
        list[str] | None,
        typer.Option("--column", metavar="HEADING=CHANNEL", help="What a column is whose heading says nothing."),
    ] = None,
) -> None:
    """Draft a trial file from logs: what each column is, with the evidence, and the manoeuvres found.

    Example: seatrial init 00000042.BIN --length 2.6 --out trial.toml

    A heading of one's own: --column "Klokke=time" --column "Ror=delta"
    """
    from seatrial import api
    from seatrial.core.text.words import counted
    from seatrial.core.values import InputError
    from seatrial.core.values.files import write_atomically
    from seatrial.data.draft import not_needed_text

    if out.exists() and not overwrite:
        raise InputError(f"'{out}' exists; add --overwrite to replace it, or name another file with --out")
    draft = api.draft_trial(
        *logs,
        folder=out.resolve().parent,
        length=length,
        beam=beam,
        draught=draught,
        mass=mass,
        gear=gear,
        rho=rho,
        scale=scale,
        propeller=propeller,
        rudder=rudder,
        gm=gm,
        antenna=antenna,
        name=name,
        columns=column or (),
    )
    write_atomically(out, draft.text.encode())
    _print_guesses([g for part in draft.guesses for g in part if g.is_used])
    print_lines(f"NOTE {survey.path.name}: {note}" for survey in draft.surveys for note in survey.notes)
    ignored = draft.unrecognised
    if ignored:
        more = f" and {len(ignored) - COLUMNS_SHOWN} more" if len(ignored) > COLUMNS_SHOWN else ""
        print_lines([f"NOTE not recognised, not used: {', '.join(ignored[:COLUMNS_SHOWN])}{more}"])
    known = not_needed_text(draft.not_needed, REASONS_SHOWN)
    print_lines([f"NOTE known, not needed: {known}"] if known else [])
    if draft.header_sizes:
        says = ", ".join(header_size.text for header_size in draft.header_sizes)
        options = " ".join(header_size.option for header_size in draft.header_sizes)
        print_lines([f"NOTE the header says {says}, not used: {options}"])
    print_verbatim(_other_speed_note(other_speed, out) for other_speed in draft.other_speeds)
    for reason in dict.fromkeys(draft.left_out.values()):
        names = [path.name for path, why in draft.left_out.items() if why == reason]
        print_lines([f"NOTE left out: {', '.join(names)}: {reason}"])
    _print_runs(draft)
    print_lines([f"NOTE {draft.unlike_decays}"] if draft.unlike_decays else [])
    if draft.held_out.names:
        why = f" ({draft.held_out.why})" if draft.held_out.why else ""
        kept = f"kept out of the estimation, to judge the model by: {', '.join(draft.held_out.names)}"
        print_lines([f"{kept}: {draft.held_out.share}{why}"])
    print_lines([draft.session.replace("    # ", ": ")] if draft.session else [])
    questions = draft.open_questions
    if questions:
        print_lines([f"{counted(len(questions), 'column')} to decide, marked OPEN in the file"])
    if draft.lacks_speed:
        print_lines(["U_n to decide, marked OPEN in the file: the courses do not separate it from a current"])
    if draft.assumed:
        print_lines([f"ASSUMED, so correct what was not so: {', '.join(draft.assumed)} under [records.waves]"])
    if draft.estimated:
        print_lines([f"ESTIMATED, so correct what you know: {', '.join(draft.estimated)}"])
    if draft.lacks_density:
        print_lines(["NOTE the water is taken for that of the sea, 1025 kg/m^3: if it was fresh, add --rho 1000"])
    if draft.lacks_antenna:
        print_lines(
            ["the GNSS antenna has no place yet: a fit moves it from midship where the records ask for it; state it "
             "with --antenna, metres forward of midship"]
        )  # fmt: skip
    print_file("trial file", out)
    print_lines([f"columns and runs in the browser: seatrial open {in_shell(out)}"])
    print_next(_after_draft(draft, out))


def _print_runs(draft: "DraftTrial") -> None:
    """The parts of each run, or what it is as a whole, and where its name says something else."""
    from seatrial.data.draft import name_contradiction, run_text

    for run, stretches, parts in zip(draft.runs, draft.stretches, draft.parts, strict=True):
        name = run.name or run.sources[0].path.name
        print_lines(f"{name}: {part.name}, {part.start:.4g} to {part.stop:.4g} s: {part.evidence}" for part in parts)
        print_lines([f"{name}: {run_text(stretches)}"] if stretches and not parts else [])
        contradiction = name_contradiction(name, stretches)
        print_lines([f"NOTE {name}: {contradiction}"] if contradiction else [])


def _other_speed_note(other: "OtherSpeed", out: Path) -> str:
    """Which runs at another speed are left out, why, and the command that makes a trial of them."""
    trial = out.with_name(f"{out.stem}_{other.speed:g}ms{out.suffix}")
    parts = [*other.logs, *other.options, "--out", trial]
    names = ", ".join(log.name for log in other.logs)
    return f"NOTE left out: {names}: {other.reason}: seatrial init {' '.join(in_shell(part) for part in parts)}"


def _after_draft(draft: "DraftTrial", out: Path) -> str:
    """What to do next: name columns where none is recognised, decide what is open, else check."""

    log = next((one.path for one in draft.surveys if all(topic.time is None for topic in one.topics)), None)
    if log is not None:
        notes = [one.time_note for survey in draft.surveys for one in survey.topics if one.time is None]
        why = "".join(f" ({note})" for note in notes[:1] if note)
        first = f"{log.name} has no time column that is recognised{why}; name it in {out}"
        return f"{first}, seatrial check {in_shell(log)} lists all"
    steps = [f"decide what is OPEN in {out}"] if draft.open_questions or draft.lacks_speed else []
    steps += [f"put the length of the craft after 'L =' in {out} (init --length does)"] if draft.lacks_length else []
    if draft.lacks_heading and (heading := draft.column_like_heading):
        rudder = draft.column_like_rudder if draft.lacks_input else ""
        kinds = "the heading or the rudder: if these are" if rudder else "the heading: if one is"
        stated = [f"{heading}=psi", *([f"{rudder}=delta"] if rudder else [])]
        options = " ".join(f"--column {in_shell(one)}" for one in stated)
        return f"no column is recognised as {kinds}, the same command with --overwrite {options}"
    if draft.lacks_input:
        return _input_to_be_named(draft, out)
    if draft.lacks_manoeuvre:
        return (
            "every run is one straight course, which shows nothing of the rudder: record a zigzag 10/10 to either side"
        )
    if steps:
        return f"{', '.join(steps)}, then seatrial check {in_shell(out)}"
    return f"seatrial identify {in_shell(out)} --out results"


def _input_to_be_named(draft: "DraftTrial", out: Path) -> str:
    """The option that names a column that was not recognised; where none is left, what can be done with the others."""
    kinds = "a rudder (delta), the command of a thruster (command_1) or a roll angle (phi)"
    if not draft.unrecognised:
        return (
            f"no column is {kinds}, and a model needs one: record it, too; of the others seatrial check {in_shell(out)}"
        )
    rudder = draft.column_like_rudder
    stated = in_shell(f"{rudder}=delta" if rudder else f"{draft.unrecognised[0]}=command_1")
    return f"no column is recognised as {kinds}: if one is, the same command with --overwrite --column {stated}"


def _print_guesses(guesses: "Sequence[ColumnGuess]") -> None:
    rows = [
        [
            "OPEN" if g.is_open and not g.is_of_wind else "",
            g.symbol,
            str(g.source),
            g.unit,
            g.frame,
            g.positive,
            "; ".join(g.evidence),
        ]
        for g in guesses
    ]
    if rows:
        header = ["", "channel", "column", "unit", "frame", "positive", "because"]
        print_table([header, *rows], flush_left=range(len(header)), verbatim=_NAMES[1:])


def print_surveys(path: Path, surveyed: "SurveyedLogs", *, show_all: bool) -> None:
    """Print what is in a log, or in each of a folder, and which of its files are none."""
    for survey in surveyed.logs:
        _print_survey(survey, show_all=show_all)
    print_lines(f"no log: {one.name}: {why}" for one, why in surveyed.left_out.items())
    has_time = any(topic.time is not None for survey in surveyed.logs for topic in survey.topics)
    heading = next((heading for survey in surveyed.logs for heading in survey.headings), "")
    time = "" if has_time or not heading else f" --column {in_shell(f'{heading}=time')}"
    print_next(f"seatrial init {in_shell(path)}{time} --out trial.toml")


def _print_survey(survey: "LogSurvey", *, show_all: bool) -> None:
    """The topics and columns of a log with rates, ranges and the share missing."""
    from seatrial.core.text.words import counted
    from seatrial.data.draft import guess_columns

    guesses = {str(guess.source): guess for guess in guess_columns(survey)}
    print_lines([f"{survey.path.name}: {survey.layout.format}, {counted(len(survey.topics), 'topic')}"])
    topics = survey.topics if show_all else survey.topics[:TOPICS_SHOWN]
    for topic in topics:
        _print_topic(topic, show_all=show_all, symbols={key: guess.symbol for key, guess in guesses.items()})
    if len(topics) < len(survey.topics):
        names = ", ".join(topic.topic for topic in survey.topics[len(topics) :])
        print_lines([f"... and {len(survey.topics) - len(topics)} more topics; --all shows them: {names[:300]}"])
    print_lines(f"NOTE {note}" for note in survey.notes)
    print_lines(f"event at {event.time:.6g} s: {event.name}" for event in survey.log.events[:TOPICS_SHOWN])
    if survey.log.parameters:
        print_lines([f"{counted(len(survey.log.parameters), 'parameter')} stored"])


def _print_topic(topic: "TopicSummary", *, show_all: bool, symbols: dict[str, str]) -> None:
    from seatrial.core.text.numbers import exact

    clock = f"no time column{f' ({topic.time_note})' if topic.time_note else ''}"
    if topic.time is not None:
        clock = f"{exact(topic.rate, 4)} Hz, {exact(topic.duration, 5)} s"
    by = f" (time: {topic.time.source}, {topic.time_note})" if topic.time is not None and topic.time.source else ""
    print_lines([f"{topic.topic or 'columns'}: {topic.rows} rows, {clock}{by}"])
    columns = topic.columns if show_all else topic.columns[:COLUMNS_SHOWN]
    print_table(
        [_column_cells(topic, column, symbols) for column in columns],
        flush_left=_TEXT_COLUMNS,
        indent="  ",
        verbatim=_NAMES[:1],
    )
    if topic.text_columns:
        print_lines([f"  text: {', '.join(topic.text_columns)}"])
    print_lines(f"  column {fault}" for fault in topic.faults)
    if len(columns) < len(topic.columns):
        print_lines([f"... and {len(topic.columns) - len(columns)} more columns; --all shows them"], "  ")


def _column_cells(topic: "TopicSummary", column: "ColumnSummary", symbols: dict[str, str]) -> Sequence[str]:
    from seatrial.core.text.numbers import exact

    source = f"{topic.topic}/{column.name}" if topic.topic else column.name
    missing = f"{column.missing:.1%} missing" if column.missing > 0.0 and math.isfinite(column.missing) else ""
    ends = (exact(column.low, DIGITS), exact(column.high, DIGITS))
    return [column.name, column.unit, *ends, missing, f"-> {symbols[source]}" if source in symbols else ""]
