"""Which files a trial names, what each is for and with which others it shares its offsets."""

import fnmatch
import os
import re
from collections.abc import Sequence
from pathlib import Path

from seatrial.core.values import InputError, quantity, si_unit, spelling_hint
from seatrial.data.read import ColumnSpec, Layout, format_of
from seatrial.data.trial.excitation import wave_encounter
from seatrial.data.trial.schema import ChannelColumn, ColumnsTable, RecordsTable
from seatrial.data.trial.trial import RecordFile, Role, TrialRun, Trimming, run_name
from seatrial.physics.hydro.excitation import Excitation

_DATE = re.compile(r"\d{4}-\d{2}-\d{2}|\d{1,2}-[A-Z][a-z]{2}-\d{4}|(?<!\d)(?:19|20)\d{6}(?!\d)")
_VARIABLE = re.compile(r"\$\{(\w+)\}")


def expand_variables(text: str) -> str:
    """`text` with every ${NAME} replaced by the environment variable; a folder in it counts from the working folder.

    Raises:
        InputError: the variable is not set.
    """

    def value(match: re.Match[str]) -> str:
        name = match.group(1)
        if not os.environ.get(name):
            raise InputError(f"the environment variable {name} in '{text}' is not set; set it to the data's folder")
        folder = Path(os.environ[name])
        return str(folder.resolve()) if folder.exists() else os.environ[name]

    return _VARIABLE.sub(value, text)


def runs_of(
    blocks: Sequence[RecordsTable],
    folder: str,
    trial_folder: Path,
    excitation: Excitation | None = None,
    length: float = 1.0,
) -> tuple[TrialRun, ...]:
    """Every run of every block, each with one role; files in sorted order.

    excitation, length [m]: of the ships that met waves.

    Raises:
        InputError: a glob or a role pattern that matches nothing, a run with two roles, a name used twice.
    """
    base = trial_folder / expand_variables(folder)
    runs = [
        run
        for i, block in enumerate(blocks, start=1)
        for run in _block_runs(block, base, f"records[{i}]", excitation, length)
    ]
    names = [run.name for run in runs]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two record files are called '{name}'; rename one, or narrow the globs")
    return tuple(runs)


def require_training_run(runs: Sequence[TrialRun]) -> None:
    """Raises:
    InputError: none of the runs is one to train on.
    """
    if not any(run.role is Role.TRAIN for run in runs):
        raise InputError("no run is left to train on; narrow 'validate' or 'leave_out'")


def _block_runs(
    block: RecordsTable, data_folder: Path, where: str, excitation: Excitation | None, length: float
) -> list[TrialRun]:
    paths = sorted({path for text in block.files for path in _matching_files(text, data_folder, where)})
    trimming = Trimming(block.from_s, block.to_s, block.skip_acceleration, block.rate, block.from_release)
    roles = _roles(block, [run_name(p) for p in paths], where)
    met = wave_encounter(block.waves, excitation, length, where)
    layouts = [layout_of(block, block.format or format_of(path), where, block.scale) for path in paths]
    return [
        TrialRun(RecordFile(path, layout), role, session_of(path, block.session), trimming, block.source, met)
        for path, layout, role in zip(paths, layouts, roles, strict=True)
    ]


def _matching_files(text: str, data_folder: Path, where: str) -> list[Path]:
    pattern = Path(expand_variables(text))
    full = data_folder / pattern
    if full.is_file():
        return [full]
    if not any(c in text for c in "*?["):
        raise InputError(f"{where}.files: there is no file '{full}'; check the name and [data] folder")
    root = Path(full.anchor)
    try:
        matching = [p for p in root.glob(str(full.relative_to(root))) if p.is_file()]
    except ValueError as error:  # '**' within a name
        raise InputError(f"{where}.files: '{text}' is no pattern ({error}); correct it") from None
    if not matching:
        raise InputError(f"{where}.files: '{full}' matches no file; check the pattern and [data] folder")
    return matching


def _roles(block: RecordsTable, names: Sequence[str], where: str) -> list[Role]:
    """The role of each run; without `train` patterns all that is not otherwise named trains."""
    patterns = {Role.TRAIN: block.train, Role.VALIDATE: block.validate_, Role.LEAVE_OUT: block.leave_out}
    for role, texts in patterns.items():
        for text in texts:
            if not any(fnmatch.fnmatchcase(name, text) for name in names):
                raise InputError(f"{where}.{role}: no run is called '{text}'{spelling_hint(text, list(names))}")
    default = Role.LEAVE_OUT if block.train else Role.TRAIN
    roles = []
    for name in names:
        matching = [r for r, texts in patterns.items() if any(fnmatch.fnmatchcase(name, t) for t in texts)]
        if len(matching) > 1:
            raise InputError(f"{where}: run '{name}' is named under both '{matching[0]}' and '{matching[1]}'; keep one")
        roles.append(matching[0] if matching else default)
    return roles


def session_of(path: Path, rule: str) -> str:
    """The group with which a run shares its offsets: its own name, the day in it, or what `rule` finds in it.

    A regular expression gives its first group, or the whole match.

    Raises:
        InputError: the rule finds nothing in the name.
    """
    name = run_name(path)
    if rule == "run":
        return name
    match = (_DATE if rule == "day" else re.compile(rule)).search(name)
    if match is None:
        what = "no date is found" if rule == "day" else f"'{rule}' matches nothing"
        raise InputError(f"session: {what} in the file name '{path.name}'; give another rule, or 'run'")
    return match.group(1) if match.re.groups else match.group(0)


def layout_of(block: ColumnsTable, file_format: str, where: str, scale: float = 1.0) -> Layout:
    """How to parse one file or stream of the block, in the terms of `seatrial.data.read`.

    Raises:
        InputError: a unit of another kind than the channel's.
    """
    return Layout(
        format=file_format,
        time=ColumnSpec("time", block.time.column, block.time.unit),
        columns=tuple(_column(s, c, f"{where}.channels.{s}") for s, c in block.channels.items()),
        header_lines=block.header_lines,
        encoding=block.encoding,
        separator=block.separator,
        decimal=block.decimal,
        scale=scale,
    )


def _column(symbol: str, column: ChannelColumn, where: str) -> ColumnSpec:
    known = quantity(symbol)
    if si_unit(column.unit)[1] != known.unit:
        raise InputError(f"{where}.unit: '{column.unit}' is no unit of {known.meaning}, which is in {known.unit}")
    return ColumnSpec(
        symbol, column.column, column.unit, column.frame or "", column.positive or "", column.reference_point
    )
