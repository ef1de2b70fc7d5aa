"""The text of a drafted trial file: every line with its evidence, what is unsure as a comment."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from seatrial.core.text.words import counted
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.header_sizes import speed_in_header
from seatrial.data.draft.held_out import NOTHING_HELD_OUT, HeldOutRuns
from seatrial.data.draft.named_manoeuvre import name_contradiction
from seatrial.data.draft.not_needed import columns_not_needed, not_needed_text
from seatrial.data.draft.stored_parameters import antenna_place
from seatrial.data.draft.stretch import LogStretch, used_parts
from seatrial.data.draft.survey import LogSurvey, TopicSummary
from seatrial.data.draft.toml_values import quoted
from seatrial.data.draft.waves_text import wave_lines
from seatrial.data.read import ColumnSpec
from seatrial.data.read.layout import TimeSpec

NO_ANTENNA = (
    "# antenna = { x = 0.0, y = 0.0 }    # m forward of midship, to starboard: state it; each metre that it is forward "
    "of this counts as 0.017 m/s of sway for each deg/s of yaw (init --antenna)"
)
"""The line that asks for the place of an antenna of which nothing is known."""
_OF_RECEIVER = frozenset({"lat", "sog"})  # channels that a GNSS antenna shows
_UNUSED_SHOWN = 12  # names of columns without a channel in the comment; chosen


@dataclass(frozen=True, eq=False)
class RecordsBlock:
    """One block of records of the file.

    Attributes:
        name: of the run; empty: the runs are called after their files.
        sources: each log with its guesses; of files of one kind the longest.
        files: those of one kind; empty for a run with a name.
        stretches: manoeuvres in the run, or in each of the files.
        parts: those of them that are offered as runs of their own.
        validate: the runs to keep out of the estimation; empty: none of this block.
        has_waves: whether the waves are an input.
        is_released: whether each run is a roll decay, to be used from its release on.
        antenna: m forward of midship, as stated; None: not stated.
    """

    name: str
    sources: tuple[tuple[LogSurvey, tuple[ColumnGuess, ...]], ...]
    files: tuple[LogSurvey, ...]
    stretches: tuple[tuple[LogStretch, ...], ...]
    parts: tuple[tuple[LogStretch, ...], ...]
    validate: HeldOutRuns = NOTHING_HELD_OUT
    session: str = ""
    has_waves: bool = False
    is_released: bool = False
    antenna: float | None = None


def trial_text(
    blocks: Sequence[RecordsBlock], tables: Sequence[str], left_out: Mapping[Path, str], folder: Path
) -> str:
    """Return the TOML file; only its first block gives the evidence.

    tables: the lines before the records. left_out: files that are no source of a run, with the reason. folder: where
    the file will lie; the paths in it count from there.
    """
    lines = [
        "# Drafted by seatrial init. Lines say why. OPEN: choose one. ESTIMATED: write a better number if you have it.",
        "",
        *tables,
        *(f"# left out: {_comment(_relative(path, folder))}: {_comment(why)}" for path, why in left_out.items()),
    ]
    for number, block in enumerate(blocks):
        written = _block_lines(block, folder)
        lines += written if number == 0 else ["", *map(_without_evidence, written)]
    return "\n".join(lines) + "\n"


def _block_lines(block: RecordsBlock, folder: Path) -> list[str]:
    lines = ["[[records]]"]
    if block.files:
        files = ", ".join(quoted(_relative(survey.path, folder)) for survey in block.files)
        lines += [f"files = [{files}]", *_role_lines(block), *_antenna_lines(block)]
        for survey, guesses in block.sources:
            lines += [*_layout_lines(survey), *_channel_lines(survey, guesses)]
        names = ["" if len(block.files) == 1 else survey.path.stem for survey in block.files]
        lines += _part_lines(dict(zip(names, block.stretches, strict=True)), block.parts)
        return [*lines, *(wave_lines(_common_speed(block.files)) if block.has_waves else [])]
    lines += [
        f"name = {quoted(block.name)}",
        *_role_lines(block),
        *_antenna_lines(block),
        *_part_lines({"": block.stretches[0]}, block.parts),
    ]
    nothing_used = not any(g.is_used for _, guesses in block.sources for g in guesses)
    for survey, guesses in block.sources:
        if not nothing_used and not any(g.is_used for g in guesses):
            name = _comment(survey.path.name)
            lines += [f"# {name}: {line.removeprefix('# ')}" for line in _unused_lines(survey, guesses)]
        else:
            lines += ["", "[[records.sources]]", f"file = {quoted(_relative(survey.path, folder))}"]
            lines += [*_layout_lines(survey), *_channel_lines(survey, guesses)]
    return lines


def _common_speed(files: Sequence[LogSurvey]) -> float | None:
    """The speed [m/s] that all headers state; None where one states none or another."""
    speeds = {speed_in_header(file) for file in files}
    return speeds.pop() if len(speeds) == 1 else None


def _without_evidence(line: str) -> str:
    """A line of a further block: its evidence stands in the first one."""
    return line if line.startswith("#") else line.partition("    # ")[0]


def _role_lines(block: RecordsBlock) -> list[str]:
    """Which runs judge the model, and from where on a decay counts."""
    names, why = block.validate.names, block.validate.why
    kept = f"{block.validate.share}, kept out of the estimation, to judge the model by"
    reason = f"{kept}{f': {why}' if why else ''}; choose others if you like"
    listed = ", ".join(map(quoted, names))
    lines = [f"validate = {listed if len(names) == 1 else f'[{listed}]'}    # {reason}"] if names else []
    lines += [block.session] if block.session else []
    return [*lines, "from_release = true    # drops what lies before the release"] if block.is_released else lines


def _antenna_lines(block: RecordsBlock) -> list[str]:
    """Where the antenna is, as stated or as a log has it, where fixes or velocities over ground are used."""
    used = {g.symbol for _, guesses in block.sources for g in guesses if g.is_used}
    is_of_receiver = bool(used & _OF_RECEIVER) or ("x0" in used and not used & {"u", "v"})
    if block.antenna is not None and is_of_receiver:
        return [f"antenna = {{ x = {block.antenna:g}, y = 0.0 }}    # m forward of midship, as stated; to starboard"]
    if block.antenna is not None and "x0" in used:
        return ["# the stated antenna is not used: a pose with velocities is of the point that its estimator says"]
    if not used & _OF_RECEIVER:
        return []
    places = [place for survey, _ in block.sources if (place := antenna_place(survey.log.parameters)) is not None]
    if not places:
        return [NO_ANTENNA]
    why = f"{places[0].evidence}; add the place of the autopilot where that is not midship"
    return [f"antenna = {{ x = {places[0].x:g}, y = {places[0].y:g} }}    # {why}"]


def _layout_lines(survey: LogSurvey) -> list[str]:
    lines = []
    layout = survey.layout
    if layout.header_lines > 1:
        lines.append(f"header_lines = {layout.header_lines}")
    if layout.encoding != "utf-8":
        lines.append(f"encoding = {quoted(layout.encoding)}")
    if layout.decimal != ".":
        lines.append(f"decimal = {quoted(layout.decimal)}")
    topic = next((one for one in survey.topics if one.time is not None), None)
    if topic is None or topic.time is None:
        why = "".join(f" ({_comment(one.time_note)})" for one in survey.topics[:1] if one.time_note)
        return [*lines, f"# OPEN: no column is recognised as the time{why}; add time = {{ column = ..., unit = ... }}"]
    offset = topic.time.clock_offset if isinstance(topic.time, TimeSpec) else 0.0
    if offset:
        lines.append(
            f"clock_offset = {offset:g}    # its clock runs {-offset:g} s ahead of the other sources: local time"
        )
    if topic.time.source:
        lines.append(f"time = {_time_table(topic.time)}    # {_comment(topic.time_note)}")
    return lines


def _time_table(time: ColumnSpec) -> str:
    parts = [f"column = {quoted(time.source)}"]
    if time.unit != "s":
        parts.append(f"unit = {quoted(time.unit)}")
    if isinstance(time, TimeSpec):
        others = {"nanoseconds": time.nanoseconds, "date": time.date, "week": time.week}
        parts += [f"{key} = {quoted(source)}" for key, source in others.items() if source]
    return f"{{ {', '.join(parts)} }}"


def _channel_lines(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    lines = []
    for guess in guesses:
        why = _comment("; ".join(guess.evidence))
        line = f"channels.{guess.symbol} = {_channel_table(guess)}"
        if not guess.is_used:
            continue
        if guess.is_open and guess.is_commented:
            lines.append(f"# {line}    # {why}; or {guess.other_reading}")
        elif guess.is_open:
            lines += [f"# OPEN {guess.symbol}: {why}; or {guess.other_reading}", f"# {line}"]
        else:
            lines.append(f"{'# ' if guess.is_commented else ''}{line}    # {why}")
    lines += [f"# left out: column {_comment(fault)}" for topic in survey.topics for fault in topic.faults]
    return [*lines, *_unused_lines(survey, guesses)]


def known_unneeded(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> dict[str, str]:
    """Return the columns that are known and stand for no channel, as none is needed, with the reason."""
    return columns_not_needed(_without_channel(survey, guesses), {g.symbol for g in guesses if g.is_used})


def unrecognised_columns(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    """Return the names of columns that stand for nothing that is known: by name nothing, or text."""
    known = known_unneeded(survey, guesses)
    return [name for name in _without_channel(survey, guesses) if name not in known]


def _without_channel(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    known = {str(guess.source) for guess in guesses if guess.is_used or guess.unused_because}
    return [
        name for topic in survey.topics for name in (*_column_names(topic), *topic.text_columns) if name not in known
    ]


def _column_names(topic: TopicSummary) -> list[str]:
    return [f"{topic.topic}/{column.name}" if topic.topic else column.name for column in topic.columns]


def _unused_lines(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    """Columns that are not used: those that are recognised with the reason, the others by name."""
    named = {str(guess.source) for guess in guesses if guess.is_used}
    columns = [name for topic in survey.topics for name in _column_names(topic)]
    reasons = {str(g.source): f"{g.symbol}, {g.unused_because}" for g in guesses if g.unused_because}
    recognised = [f"{name} ({reasons[name]})" for name in columns if name in reasons and name not in named]
    rest = unrecognised_columns(survey, guesses)
    more = f", and {len(rest) - _UNUSED_SHOWN} more ('seatrial check {survey.path.name}' lists them)"
    shown = ", ".join(rest[:_UNUSED_SHOWN]) + (more if len(rest) > _UNUSED_SHOWN else "")
    lines = [f"# not used: {_comment(', '.join(recognised))}"] if recognised else []
    known = known_unneeded(survey, guesses)
    lines += [f"# known, not needed: {_comment(not_needed_text(known))}"] if known else []
    return [*lines, f"# not used, names not recognised: {_comment(shown)}"] if rest else lines


def _channel_table(guess: ColumnGuess) -> str:
    parts = [f"column = {quoted(guess.source)}", f"unit = {quoted(guess.unit or '1')}"]
    words = (("frame", guess.frame), ("positive", guess.positive), ("kind", guess.kind))
    parts += [f"{key} = {quoted(value)}" for key, value in words if value]
    numbers = (
        ("reference_point", guess.reference_point, 0.0),
        ("zero", guess.zero, 0.0),
        ("span", guess.span, 1.0),
        ("scale", guess.scale, 1.0),
    )
    parts += [f"{key} = {value:g}" for key, value, default in numbers if value != default]
    return f"{{ {', '.join(parts)} }}"


def _part_lines(stretches: Mapping[str, Sequence[LogStretch]], parts: Sequence[Sequence[LogStretch]]) -> list[str]:
    """What each run is, and the manoeuvres that are runs of their own.

    stretches: of each run, by the name of its file, which is empty where there is no other.
    """
    offered = {name: part for name, part in zip(stretches, parts, strict=True) if part}
    lines = [_run_line(name, found) for name, found in stretches.items() if found and name not in offered]
    if not offered:
        return lines
    lines += [
        f"# Each of these parts is a run of its own{_left_out_text(offered.values())}.",
        "parts = [",
    ]
    for name, part in offered.items():
        used, file = used_parts(part), f"file = {quoted(name)}, " if name else ""
        lines += [
            f'{"   " if one in used else "#  "} {{ {file}name = {quoted(one.name)}, from = "{one.start:.6g} s", '
            f'to = "{one.stop:.6g} s" }},    # {one.evidence}'
            for one in part
        ]
    return [*lines, "]"]


def _left_out_text(parts: Iterable[Sequence[LogStretch]]) -> str:
    """What of the logs no part holds, as it follows upon what the parts are."""
    has_gaps = any(after.start > before.stop for part in parts for before, after in pairwise(used_parts(part)))
    return "; what lies between them is not used" if has_gaps else ", each from where the one before ends"


def _run_line(name: str, stretches: Sequence[LogStretch]) -> str:
    contradiction = name_contradiction(name, stretches)
    note = f"; NOTE: {contradiction}" if contradiction else ""
    return f"# {_comment(name)}{': ' if name else ''}{run_text(stretches)}{note}"


def run_text(stretches: Sequence[LogStretch]) -> str:
    """Return what a run that stays whole is: its manoeuvre, or the kinds of several."""
    if len(stretches) == 1:
        return f"{stretches[0].name}: {stretches[0].evidence}"
    kinds = list(
        dict.fromkeys(stretch.name.rstrip("0123456789").rstrip("_").replace("_", " to ") for stretch in stretches)
    )
    return f"{counted(len(stretches), 'manoeuvre')}: {', '.join(kinds)}"


def _comment(text: str) -> str:
    """Text from a log that stays within its line."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def _relative(path: Path, folder: Path) -> str:
    """The path as it counts from the trial file; absolute where it lies elsewhere."""
    full = path.resolve()
    return full.relative_to(folder).as_posix() if full.is_relative_to(folder) else full.as_posix()
