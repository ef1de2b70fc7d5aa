"""A reader to copy: one JSON object a line, as many loggers write; its keys are the names of the columns."""

import json
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.read import Layout, Log, RawTable


def read_json_lines(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Return the columns of the file as it holds them; units, frames and signs are the layout's concern.

    Raises:
        InputError: the file is empty, a line is no JSON object, or it lacks a key of the first line.
    """
    lines = path.read_text("utf-8", errors="replace").splitlines()
    rows = [_row(path, number, line) for number, line in enumerate(lines, 1)]
    if not rows:
        raise InputError(f"{path.name} is empty; leave it out or replace it")
    names = tuple(rows[0])
    for number, row in enumerate(rows, 1):
        if missing := [name for name in names if name not in row]:
            raise InputError(f"{path.name}: line {number} has no '{missing[0]}'; write null where a value is missing")
    return Log.of_table(RawTable(path.name, names, tuple([row[name] for row in rows] for name in names)))


def _row(path: Path, number: int, line: str) -> dict[str, object]:
    try:
        row = json.loads(line)
    except json.JSONDecodeError as error:
        raise InputError(f"{path.name}: line {number} is no JSON ({error.msg}); remove or correct it") from None
    if not isinstance(row, dict):
        raise InputError(f'{path.name}: line {number} is no JSON object; each line needs one, such as {{"t": 0.1}}')
    return row
