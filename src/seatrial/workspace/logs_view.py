"""The view of logs: columns as the trial file reads them with why, what else they may be, runs, and their curves."""

import os
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.figures.run import ChannelPanel
from seatrial.core.figures.time_plot import packed, plot_document
from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, InputError, Record
from seatrial.core.values.files import parse_toml
from seatrial.core.values.notation import (
    OPPOSITE,
    channel_meaning,
    positive_direction,
    reading_order,
    si_unit,
    units_like,
)
from seatrial.core.values.record_chart import channel_panels, has_track, is_constant
from seatrial.data.check import canonical_record
from seatrial.data.draft import (
    ColumnGuess,
    TopicSummary,
    checked_by_behaviour,
    guess_columns,
    stated_columns,
    survey_log,
    unit_in_heading,
)
from seatrial.data.readings.search import ASSUMED_NATS, OPEN_NATS
from seatrial.data.trial import Run, RunFiles
from seatrial.data.trial.load import parse_tables
from seatrial.data.trial.run_data import run_name
from seatrial.data.trial.runs import declared_channels, runs_of
from seatrial.workspace.run_edits import part_of
from seatrial.workspace.trial_document import BY_HAND, parsed_document

_OPEN = re.compile(r"^# OPEN (\w+): (.*?)(?:; or (.*))?$")
_OPEN_TABLE = re.compile(r"^# (channels\.(\w+) = (\{.*?\}))(?:    # (.*?)(?:; or (.*))?)?$")
_CHANNELS = 12  # of a log that are drawn, the first in the order of reading; chosen
_TRACK_POINTS = 800  # of a track on the screen; chosen
_LONGEST_TEXT = 300  # letters of what a log or a comment says; chosen


def logs_view(text: str, path: Path) -> dict[str, Any]:
    """Return each block of records: channels with unit, frame, side and reason, what is open, runs and their roles.

    A text that is no trial file has its channels all the same; `problem` says what is wrong with it.
    """
    document: Mapping[str, Any] = parsed_document(text)
    problem, runs = "", dict[int, tuple[Run, ...]]()
    try:
        runs = runs_by_block(text, path)
    except InputError as error:
        problem = str(error)
    blocks = [
        _block_view(k, block, runs.get(k, ()), path)
        for k, block in enumerate(document.get("records", ()))
    ]  # fmt: skip
    for place, row in open_rows(text):
        if place < len(blocks):
            blocks[place]["open"].append(row)
    return {"blocks": blocks, "problem": problem}


def runs_by_block(text: str, path: Path) -> dict[int, tuple[Run, ...]]:
    """Return the runs of each block of a trial file's text, by the place of the block.

    Raises:
        InputError: as `load_runs`.
    """
    try:
        file = parse_tables(parse_toml(text), path)
    except ValueError as error:
        raise InputError(str(error)) from None
    declared = declared_channels(file.channels)
    return {
        k: runs_of([block], file.data.folder, path.parent, length=None, declared=declared)
        for k, block in enumerate(file.records)
    }


def _block_view(place: int, block: Mapping[str, Any], runs: Sequence[Run], path: Path) -> dict[str, Any]:
    sources = [block, *block.get("sources", ())]
    channels = [
        _channel_row(symbol, channel, k - 1)
        for k, source in enumerate(sources)
        for symbol, channel in source.get("channels", {}).items()
    ]
    return {
        "place": place,
        "time": str(block.get("time", {}).get("column", "")),
        "channels": channels,
        "open": [],
        "runs": [_run_row(run, block, path) for run in runs],
        "files": sorted({str(file.path) for run in runs for file in run.files}),
    }


def _channel_row(symbol: str, channel: Mapping[str, Any], source: int) -> dict[str, Any]:
    """A channel as the file states it, with the choices that a person has; source: of several, -1: the block's own."""
    trivia = getattr(channel, "trivia", None)
    reason = trivia.comment.lstrip("# ") if trivia is not None else ""
    frame = str(channel.get("frame", ""))
    return {
        "symbol": symbol,
        "meaning": _meaning(symbol),
        "source": source,
        "column": str(channel.get("column", "")),
        "stated": {key: _plain(value) for key, value in channel.items()},
        "reason": printable(reason.removeprefix(f"{BY_HAND}; ").removeprefix(BY_HAND), _LONGEST_TEXT),
        "by_hand": reason.startswith(BY_HAND),
        "side": _side(symbol, channel),
        **_choices(symbol, str(channel.get("unit", "")), frame),
    }


def _choices(symbol: str, unit: str, frame: str) -> dict[str, Any]:
    """The units, frames and sides that a channel of this name can have."""
    try:
        units = units_like(si_unit(unit)[1])
    except InputError:
        units = []
    if symbol not in NOTATION:
        return {"units": units, "frames": [], "sides": []}
    usual = positive_direction(symbol, frame)
    sides = [usual, OPPOSITE[usual]] if usual in OPPOSITE else []
    frames = {"u": ["body", "earth"], "v": ["body", "earth"], "x0": ["earth", "enu"], "y0": ["earth", "enu"],
              "psi": ["earth", "enu"], "cog": ["earth", "enu"]}.get(symbol, [])  # fmt: skip
    return {"units": units, "frames": frames, "sides": sides}


def _side(symbol: str, channel: Mapping[str, Any]) -> str:
    if symbol not in NOTATION:
        return ""
    usual = positive_direction(symbol, str(channel.get("frame", "")))
    return str(channel.get("positive", usual if usual in OPPOSITE else ""))


def _meaning(symbol: str) -> str:
    return channel_meaning(symbol) if symbol in NOTATION else symbol


def _plain(value: Any) -> Any:
    return value.unwrap() if hasattr(value, "unwrap") else value


def _run_row(run: Run, block: Mapping[str, Any], path: Path) -> dict[str, Any]:
    file = run.files[0].path
    part = run.data if isinstance(run.data, RunFiles) else None
    return {
        "name": run.name, "role": run.role.value, "file": os.path.relpath(file, path.parent),
        "log": str(block["name"]) if block.get("sources") else run_name(file),
        "start": part.start if part else "", "stop": part.stop if part else "",
    }  # fmt: skip


def open_rows(text: str) -> list[tuple[int, dict[str, Any]]]:
    """Return what `init` left to a person, with both readings: the block, and the table that a choice begins from."""
    rows, place, opened = [], -1, dict[str, tuple[str, str]]()
    for line in text.splitlines():
        if line.strip() == "[[records]]":
            place += 1
        elif match := _OPEN.match(line):
            opened[match[1]] = (match[2], match[3] or "")
        elif match := _OPEN_TABLE.match(line):
            symbol = match[2]
            reason, other = opened.get(symbol, (match[4] or "", match[5] or ""))
            try:
                table = parse_toml(f"table = {match[3]}")["table"]
            except ValueError:
                continue
            rows.append((max(place, 0), {
                "symbol": symbol, "meaning": _meaning(symbol), "stated": table, "must_choose": symbol in opened,
                "reason": printable(reason, _LONGEST_TEXT), "other": printable(other, _LONGEST_TEXT),
                **_choices(symbol, str(table.get("unit", "")), str(table.get("frame", ""))),
            }))  # fmt: skip
    return rows


def without_open_lines(text: str, block: int, symbol: str) -> str:
    """Return the text without the lines by which `init` left a channel of a block open."""
    kept, place = [], -1
    for line in text.splitlines(keepends=True):
        place += line.strip() == "[[records]]"
        bare = line.rstrip("\n")
        match = _OPEN.match(bare)
        commented = _OPEN_TABLE.match(bare)
        is_of_symbol = (match and match[1] == symbol) or (commented and commented[2] == symbol)
        if not (place == block and is_of_symbol):
            kept.append(line)
    return "".join(kept)


# What else the columns of a log may be: every candidate of the judge, with how the records speak of it.


def candidates_view(path: Path, stated: Sequence[str] = ()) -> dict[str, Any]:
    """Return the columns of a log with range and rate, and for each that is recognised what it is and may be.

    stated: what columns are whose headings say nothing, as `--column` of `init`.

    Raises:
        InputError: the log cannot be read.
    """
    survey = survey_log(path, stated_columns(stated))
    (guesses,) = checked_by_behaviour([survey], [guess_columns(survey)])
    by_source = {str(guess.source): guess for guess in guesses}
    columns = []
    for topic in survey.topics:
        columns += _columns_without_numbers(topic)
        for column in topic.columns:
            name = f"{topic.topic}/{column.name}" if topic.topic else column.name
            guess = by_source.get(name) or by_source.get(str(column.number)) or ColumnGuess(name, "", "", is_used=False)
            columns.append({
                "name": name, "unit": column.unit or unit_in_heading(column.name),
                "low": column.low, "high": column.high,
                "symbol": guess.symbol if guess.is_used else "",
                "evidence": [printable(reason, _LONGEST_TEXT) for reason in guess.evidence],
                "candidates": [_candidate(*candidate) for candidate in guess.candidates if guess.is_used],
            })  # fmt: skip
    notes = [printable(note, _LONGEST_TEXT) for note in survey.notes]
    return {"log": path.name, "columns": columns, "notes": notes}


def _columns_without_numbers(topic: TopicSummary) -> list[dict[str, Any]]:
    """The time, and columns of text, which may be one."""
    time = [] if topic.time is None or not topic.time.source else [(str(topic.time.source), "time", topic.time_note)]
    texts = [(name, "", "text") for name in topic.text_columns if not time or name != time[0][0]]
    return [
        {"name": name, "unit": "", "low": None, "high": None,
         "symbol": symbol, "evidence": [printable(why, _LONGEST_TEXT)], "candidates": []}
        for name, symbol, why in (*time, *texts)
    ]  # fmt: skip


def _candidate(reading: str, nats: float) -> dict[str, Any]:
    standing = "as likely" if nats < ASSUMED_NATS else "possible" if nats < OPEN_NATS else "contradicted"
    return {"reading": reading, "nats": round(nats, 1), "standing": standing}


# The curves of a log, whole, with its runs as stretches of time.


def series_view(text: str, path: Path, block: int, log: str) -> dict[str, Any]:
    """Return track and channels of a log over time, and the ends of its runs.

    Raises:
        InputError: there is no such log, or it cannot be read.
    """
    runs = [run for run in runs_by_block(text, path).get(block, ()) if isinstance(run.data, RunFiles)]
    table: Mapping[str, Any] = parse_toml(text)["records"][block]
    of_log = [run for run in runs if is_of_log(run, log) or table.get("name") == log]
    if not of_log:
        raise InputError(f"there is no log '{printable(log)}' in that block; reload the page")
    record = RunFiles(log, of_log[0].files).read()
    duration = float(record.time[-1] - record.time[0])
    rows = [
        {"name": run.name, "role": run.role.value, "ends": part_of(table, run.name, duration)} for run in of_log
    ]  # fmt: skip
    return {
        **plot_document(_panels(record)), "log": log, "duration": duration, "samples": len(record),
        "track": _track(record) if has_track(record) else None, "runs": rows,
    }  # fmt: skip


def _panels(record: Record) -> tuple[ChannelPanel, ...]:
    """The channels that change, from the first sample, velocities along the ship where its heading turns them."""
    record = replace(record, time=record.time - record.time[0])
    with suppress(InputError):
        record = canonical_record(record)
    names = [name for name in reading_order(list(record.channels)) if not is_constant(record, name)]
    return channel_panels(record, names[:_CHANNELS])


def is_of_log(run: Run, log: str) -> bool:
    """Return whether a run is a log, or a part of it, by the name of its file without the ending."""
    return bool(run.files) and log in (run_name(run.files[0].path), run.name if len(run.files) > 1 else "")


def _track(record: Record) -> dict[str, Any]:
    """North and east [m] on an even grid of the record's samples."""
    kept = np.unique(np.linspace(0, len(record) - 1, min(_TRACK_POINTS, len(record))).astype(int))
    return {"north": packed(record["x0"][kept]), "east": packed(record["y0"][kept])}
