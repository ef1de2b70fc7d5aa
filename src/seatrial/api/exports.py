"""Models written as files of other tools."""

import os
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from seatrial.core.values import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from seatrial.core.equations import Model
    from seatrial.core.results import Fit
    from seatrial.core.values import Record
    from seatrial.data.folder.model_file import ModelFile
    from seatrial.exporting import Export, ExportSource, Target


def export(
    model: "Fit | ModelFile | Model | str | Path", to: str, path: str | Path, gains: "Mapping[str, float] | None" = None
) -> "Export":
    """Write a model as files of another tool, all of them or none, and return them with notes on what they cost.

    Args:
        model: a model, a fit, a model file, or the path of one or of the result folder that holds it.
        to: name of the target, as `export_targets` lists them.
        path: new file, or new folder where the target writes several; its name, without suffix, becomes that of
            functions and identifiers.
        gains: of a tuned autopilot, name -> value as `tune` gives them, for targets that have a place for them; None:
            such a target chooses its own.

    Raises:
        InputError: unknown target, a model or gains that it has no place for, a name that is no identifier, or a path
            that exists or cannot be written.
    """
    from seatrial.core.values.files import write_atomically, write_files_atomically
    from seatrial.exporting import target_named

    target, path, source = target_named(to), Path(path), replace(_source(model), gains=gains)
    if gains is not None and not target.takes_gains:
        raise InputError(f"target '{to}' holds a model and no controller; leave the gains out")
    _require_new(path, target)
    if reason := target.unsuitable(source):
        raise InputError(f"model '{source.model.name}' has no place in target '{to}': {reason}")
    source = replace(source, runs=_training_runs(model)) if target.takes_runs else source
    result = target.export(source, path.stem)
    if target.suffix:
        (content,) = result.files.values()
        write_atomically(path, content)
    else:
        write_files_atomically(path, result.files)
    return result


def export_targets(model: "Fit | ModelFile | Model | str | Path") -> dict[str, str]:
    """Return each target's name with why it has no place for the model, empty where it has one."""
    from seatrial.exporting import TARGETS

    source = _source(model)
    return {name: target.unsuitable(source) for name, target in TARGETS.items()}


def replay_fmu(path: str | Path, record: "Record") -> "Record":
    """Simulate an FMU with the inputs of a record, by FMPy: the check that it moves as its model does.

    Raises:
        InputError: FMPy is not installed, no FMU for co-simulation on this platform, or an input that the record lacks.
    """
    from seatrial.exporting.fmu import replay_fmu

    return replay_fmu(Path(path), record)


def _source(model: "Fit | ModelFile | Model | str | Path") -> "ExportSource":
    from seatrial.api.files import load_model
    from seatrial.api.simulation import as_model_file
    from seatrial.exporting import ExportSource

    if isinstance(model, str | Path):
        path = _model_path(Path(model))
        return ExportSource(load_model(path), str(path), _date())
    file = as_model_file(model)
    return ExportSource(file, f"model '{file.model.name}'", _date())


def _training_runs(model: "Fit | ModelFile | Model | str | Path") -> "tuple[Record, ...]":
    """Return the runs that a fit, or the fit beside the model file, was trained on; none of other models."""
    from seatrial.core.results import Fit
    from seatrial.data.folder.result_folder import load_result

    fit = model
    if isinstance(model, str | Path):
        with suppress(InputError):  # a model file may stand alone, or beside something else
            fit = load_result(_model_path(Path(model)).parent)
    if not isinstance(fit, Fit):
        return ()
    held_out = {prediction.record for prediction in fit.validation}
    return tuple(record for record in fit.records if record.name not in held_out)


def _model_path(path: Path) -> Path:
    """Return the model file that a path names: itself, or that of a result folder."""
    if not path.is_dir():
        return path
    from seatrial.data.folder.result_folder import MODEL

    if (path / MODEL).is_file():
        return path / MODEL
    gains = path / "gains.toml"
    if gains.is_file():
        raise InputError(
            f"'{path}' holds gains and no model; give the model file they were tuned on, and --gains {gains}"
        )
    raise InputError(
        f"folder '{path}' holds no {MODEL}; give the folder that 'seatrial identify' wrote, or a model file"
    )


def _date() -> str:
    """Today, or the day of SOURCE_DATE_EPOCH (reproducible-builds.org) where that is set."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    moment = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdigit() else datetime.now(UTC)
    return moment.strftime("%Y-%m-%d")


def _require_new(path: Path, target: "Target") -> None:
    if path.suffix != target.suffix:
        wanted = f"a name that ends in '{target.suffix}'" if target.suffix else "a folder, without a suffix"
        raise InputError(f"target '{target.name}' writes {target.meaning}: give {wanted}, not '{path}'")
    if path.exists() or path.is_symlink():
        raise InputError(f"'{path}' exists; choose another place or remove it")
