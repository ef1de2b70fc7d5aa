"""A trial file drafted from logs: every guess with its evidence, what is unsure as a commented line."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.draft.clocks import with_common_clock
from seatrial.data.draft.guess import ColumnGuess, checked_by_behaviour, guess_columns, without_conflicts
from seatrial.data.draft.manoeuvres import LogStretch, find_stretches
from seatrial.data.draft.survey import LogSurvey, survey_log
from seatrial.data.read import FORMATS, ColumnSpec
from seatrial.data.read.layout import TimeSpec

_UNUSED_SHOWN = 12  # names of columns without a channel in the comment; chosen


@dataclass(frozen=True, eq=False)
class DraftTrial:
    """A drafted trial file.

    Attributes:
        text: the TOML file.
        surveys: the logs, in order.
        guesses: of the columns of each kind of log.
        stretches: manoeuvres found, of the first log of each kind.
    """

    text: str
    surveys: tuple[LogSurvey, ...]
    guesses: tuple[tuple[ColumnGuess, ...], ...]
    stretches: tuple[LogStretch, ...] = ()

    @property
    def open_questions(self) -> tuple[ColumnGuess, ...]:
        """The columns for which a person must choose."""
        return tuple(g for part in self.guesses for g in part if g.is_used and g.is_open)


def draft_trial(*logs: str | Path, folder: str | Path = ".") -> DraftTrial:
    """Draft a trial file for logs: files, or folders whose logs are taken.

    Args:
        logs: files of one kind are runs; files of several kinds are sources of one run.
        folder: where the trial file will lie; the paths in it count from there.

    Raises:
        InputError: no logs, or one that cannot be read.
    """
    paths = _log_files([Path(log) for log in logs])
    surveys = tuple(survey_log(path) for path in paths)
    kinds: dict[tuple, list[LogSurvey]] = {}
    for survey in surveys:
        kinds.setdefault(_signature(survey), []).append(survey)
    groups = list(kinds.values())
    if len(groups) == 1:
        group = max(groups[0], key=lambda one: one.duration if math.isfinite(one.duration) else 0.0)
        (guesses,) = checked_by_behaviour([group], [guess_columns(group)])
        all_guesses, examined = (tuple(guesses),), [group]
    else:
        examined = with_common_clock(surveys)
        groups = [[survey] for survey in examined]
        parts = without_conflicts([guess_columns(one) for one in examined])
        all_guesses = tuple(map(tuple, checked_by_behaviour(examined, parts)))
    stretches = find_stretches(examined, all_guesses)
    text = _trial_text(groups, all_guesses, stretches, Path(folder).resolve())
    return DraftTrial(text, surveys, all_guesses, stretches)


def _log_files(logs: Sequence[Path]) -> list[Path]:
    """The files, and those of known endings in the folders."""
    known = {suffix for one in FORMATS.values() for suffix in one.suffixes}
    files = []
    for log in logs:
        if log.is_dir():
            inside = sorted(path for path in log.rglob("*") if path.is_file())
            files += [path for path in inside if Path(path.name.removesuffix(".gz")).suffix.lower() in known]
        else:
            files.append(log)
    if not files:
        raise InputError("there is no log to draft a trial of; name files, or a folder with logs")
    return files


def _signature(survey: LogSurvey) -> tuple:
    """What files of one kind share: topics and columns."""
    return (survey.layout.format, *(table.names for table in survey.log.tables))


def _trial_text(
    groups: Sequence[Sequence[LogSurvey]],
    guesses: Sequence[Sequence[ColumnGuess]],
    stretches: Sequence[LogStretch],
    folder: Path,
) -> str:
    lines = [
        "# Drafted by seatrial init. Every line says why; lines with OPEN are for you to choose.",
        "",
        *_particulars(),
    ]
    lines += ["[[records]]"]
    if len(groups) == 1:
        files = ", ".join(_quoted(_relative(survey.path, folder)) for survey in groups[0])
        lines += [f"files = [{files}]", *_layout_lines(groups[0][0]), *_channel_lines(groups[0][0], guesses[0])]
    else:
        lines.append('name = "run"')
        for group, part in zip(groups, guesses, strict=True):
            if any(g.is_used for g in part):
                lines += ["", "[[records.sources]]", f"file = {_quoted(_relative(group[0].path, folder))}"]
                lines += [*_layout_lines(group[0]), *_channel_lines(group[0], part)]
    return "\n".join([*lines, *_part_lines(stretches)]) + "\n"


def _particulars() -> list[str]:
    """What a person must give before a model can be estimated; `check` does not need it."""
    return [
        "# 'seatrial check' needs neither ship nor model; for 'seatrial identify' give both ('seatrial models').",
        "# [ship]",
        '# name = "..."',
        "# L = 0.0    # m, between perpendiculars",
        "# [model]",
        '# name = "nomoto"',
        "",
    ]


def _layout_lines(survey: LogSurvey) -> list[str]:
    lines = []
    layout = survey.layout
    if layout.header_lines > 1:
        lines.append(f"header_lines = {layout.header_lines}")
    if layout.encoding != "utf-8":
        lines.append(f"encoding = {_quoted(layout.encoding)}")
    if layout.decimal != ".":
        lines.append(f"decimal = {_quoted(layout.decimal)}")
    topic = next((one for one in survey.topics if one.time is not None), None)
    if topic is None or topic.time is None:
        return [*lines, "# OPEN: no column is recognised as the time; add time = { column = ..., unit = ... }"]
    offset = topic.time.clock_offset if isinstance(topic.time, TimeSpec) else 0.0
    if offset:
        lines.append(
            f"clock_offset = {offset:g}    # its clock runs {-offset:g} s ahead of the other sources: local time"
        )
    if topic.time.source:
        lines.append(f"time = {_time_table(topic.time)}    # {_comment(topic.time_note)}")
    return lines


def _time_table(time: ColumnSpec) -> str:
    parts = [f"column = {_quoted(time.source)}"]
    if time.unit != "s":
        parts.append(f"unit = {_quoted(time.unit)}")
    if isinstance(time, TimeSpec) and time.nanoseconds:
        parts.append(f"nanoseconds = {_quoted(time.nanoseconds)}")
    return f"{{ {', '.join(parts)} }}"


def _channel_lines(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    lines = []
    for guess in guesses:
        why = _comment("; ".join(guess.evidence))
        line = f"channels.{guess.symbol} = {_channel_table(guess)}"
        if not guess.is_used:
            continue
        if guess.is_open:
            lines += [f"# OPEN {guess.symbol}: {why}; or {guess.other_reading}", f"# {line}"]
        else:
            lines.append(f"{line}    # {why}")
    named = {str(guess.source) for guess in guesses if guess.is_used}
    unused = [
        f"{topic.topic}/{column.name}" if topic.topic else column.name
        for topic in survey.topics
        for column in topic.columns
    ]
    rest = [name for name in unused if name not in named]
    shown = rest[:_UNUSED_SHOWN]
    more = (
        f", and {len(rest) - len(shown)} more ('seatrial check {survey.path.name}' lists them)"
        if len(rest) > len(shown)
        else ""
    )
    return [*lines, f"# not used: {_comment(', '.join(shown))}{more}"] if rest else lines


def _channel_table(guess: ColumnGuess) -> str:
    parts = [f"column = {_quoted(guess.source)}", f"unit = {_quoted(guess.unit or '1')}"]
    parts += [
        f"{key} = {_quoted(value)}" for key, value in (("frame", guess.frame), ("positive", guess.positive)) if value
    ]
    numbers = (("zero", guess.zero, 0.0), ("span", guess.span, 1.0), ("scale", guess.scale, 1.0))
    parts += [f"{key} = {value:g}" for key, value, default in numbers if value != default]
    return f"{{ {', '.join(parts)} }}"


def _part_lines(stretches: Sequence[LogStretch]) -> list[str]:
    if not stretches:
        return []
    lines = ["# Manoeuvres found; remove the # of those you want as runs of their own.", "# parts = ["]
    lines += [
        f'#     {{ name = "{one.name}", from = "{one.start:.6g} s", to = "{one.stop:.6g} s" }},    # {one.evidence}'
        for one in stretches
    ]
    return [*lines, "# ]"]


def _quoted(value: str | int) -> str:
    """A value as TOML writes it; the escapes of JSON are those of TOML."""
    return str(value) if isinstance(value, int) else json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _comment(text: str) -> str:
    """Text from a log that stays within its line."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def _relative(path: Path, folder: Path) -> str:
    """The path as it counts from the trial file; absolute where it lies elsewhere."""
    full = path.resolve()
    return full.relative_to(folder).as_posix() if full.is_relative_to(folder) else full.as_posix()
