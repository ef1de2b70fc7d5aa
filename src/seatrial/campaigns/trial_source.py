"""A trial file as part of a campaign: its tables, the files it reads, and what they contain."""

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.campaigns.work import canonical_json
from seatrial.core.values import InputError
from seatrial.data.folder.model_file import read_earlier_result
from seatrial.data.read.record_file import file_digest
from seatrial.data.trial import Role, Trial, parse_tables, trial_of_tables
from seatrial.data.trial.load import read_tables
from seatrial.data.trial.run_data import RecordFile, RecordSources
from seatrial.data.trial.runs import expand_variables


@dataclass(frozen=True, eq=False)
class TrialSource:
    """A trial file and what it reads.

    Attributes:
        path: the file; table: its tables, with paths relative to its folder.
        files: record files, tables of forces and excitation, results that priors come from.
        equation_hash: of its model; empty where the trial cannot be loaded, which is the outcome of its tasks.
        training: name and session of each training run.
    """

    path: Path
    table: Mapping[str, Any]
    files: tuple[Path, ...]
    equation_hash: str
    training: tuple[tuple[str, str], ...]

    def content(self) -> str:
        """Return the canonical text of what its tasks depend on: tables, files by SHA-256, equations."""
        home = self.path.parent
        digests = {os.path.relpath(path, home): file_digest(path) for path in self.files}
        table = {"trial": _plain(self.table), "files": digests, "equations": self.equation_hash}
        return canonical_json(table).decode()


def trial_source(path: Path) -> TrialSource:
    """Read a trial file and find the files that it reads; one that is no valid trial stands for itself.

    Raises:
        InputError: it cannot be read, or is no TOML.
    """
    path = path.resolve()
    table = read_tables(path)
    try:
        parse_tables(table, path)
        table = _relative_paths(table, path.parent)
        trial = loaded(table, path)
    except InputError:
        return TrialSource(path, table, (), "", ())
    training = tuple((run.name, run.session) for run in trial.runs_with_role(Role.TRAIN))
    files = dict.fromkeys([*_record_files(trial), *_other_files(table, path.parent)])
    return TrialSource(path, table, tuple(files), trial.model.equation_hash, training)


def loaded(table: Mapping[str, Any], path: Path) -> Trial:
    """Return the trial of the tables of a file, from whose folder paths count; errors as in `load_trial`."""
    return trial_of_tables(parse_tables(dict(table), path), path, read_result=read_earlier_result)


def _record_files(trial: Trial) -> Iterator[Path]:
    for run in trial.runs:
        if run.role is Role.LEAVE_OUT:
            continue
        if isinstance(run.data, RecordFile):
            yield run.data.path.resolve()
        elif isinstance(run.data, RecordSources):
            yield from (file.path.resolve() for file in run.data.files)


def _other_files(table: Mapping[str, Any], home: Path) -> Iterator[Path]:
    base = home / table.get("data", {}).get("folder", ".")
    for block in (*table.get("forces", []), table.get("excitation", {})):
        if (path := base / str(block.get("file", ""))).is_file():
            yield path.resolve()
    for name in _strings(table.get("model", {}).get("priors_from", ())):
        if (path := home / name / "model.toml").is_file():
            yield path.resolve()


def _relative_paths(table: Mapping[str, Any], home: Path) -> dict[str, Any]:
    """Return the tables with environment variables put in and absolute paths made relative, so that files can move."""
    result = dict(table)
    if "folder" in table.get("data", {}):
        result["data"] = {**table["data"], "folder": _relative(table["data"]["folder"], home)}
    base = home / result.get("data", {}).get("folder", ".")
    if isinstance(table.get("records"), list):
        result["records"] = [_relative_files(block, base) for block in table["records"]]
    if "priors_from" in table.get("model", {}):
        names = [_relative(name, home) for name in _strings(table["model"]["priors_from"])]
        result["model"] = {**table["model"], "priors_from": names}
    return result


def _relative_files(block: Mapping[str, Any], base: Path) -> dict[str, Any]:
    result = dict(block)
    if "files" in block:
        result["files"] = [_relative(text, base) for text in _strings(block["files"])]
    if isinstance(block.get("sources"), list):
        result["sources"] = [_relative_source(source, base) for source in block["sources"]]
    return result


def _relative_source(source: Mapping[str, Any], base: Path) -> dict[str, Any]:
    return {**source, "file": _relative(source["file"], base)} if "file" in source else dict(source)


def _relative(text: str, base: Path) -> str:
    full = expand_variables(str(text))
    return os.path.relpath(full, base) if Path(full).is_absolute() else full


def _strings(value: Any) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)


def _plain(value: Any) -> Any:
    """Return a value of TOML as one of JSON: dates and infinities as text."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    is_number = isinstance(value, int) or (isinstance(value, float) and math.isfinite(value))
    return value if is_number or isinstance(value, str) else repr(value)
