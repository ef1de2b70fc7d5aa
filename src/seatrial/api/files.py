"""Files in and out: records, model files, result folders, reports."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seatrial.core.equations import Model
    from seatrial.core.results import Fit
    from seatrial.core.results.online import Snapshot
    from seatrial.core.values import Record
    from seatrial.data.folder.model_file import ModelFile
    from seatrial.data.folder.result_folder import Result
    from seatrial.data.read import Layout
    from seatrial.onboard.follow import FollowResult


def read_record(path: str | Path, layout: "Layout | None" = None) -> "Record":
    """Read a record file: the package's own CSV, or any other file as the layout describes it.

    Args:
        path: the file.
        layout: which column is which quantity, in which unit, frame and sign; None for a file of `write_record`.

    Raises:
        InputError: the file is missing, empty or damaged, or does not fit the layout.
    """
    from seatrial.data.read import read_record, read_record_csv

    return read_record_csv(Path(path)) if layout is None else read_record(Path(path), layout)


def write_record(record: "Record", path: str | Path) -> Path:
    """Write a record as CSV that `read_record` restores to the last bit; returns the path.

    Raises:
        InputError: the file cannot be written.
    """
    from seatrial.data.read import write_record_csv

    write_record_csv(record, Path(path))
    return Path(path)


def load_model(path: str | Path, own_model: "Model | None" = None) -> "ModelFile":
    """Load a model file: the model, its covariance, and the approach condition of the trials it comes from.

    Args:
        path: a ``model.toml`` as `identify` writes it.
        own_model: equations that are not built in.

    Raises:
        InputError: no model file, or its equations have changed since.
    """
    from seatrial.data.folder.model_file import read_model_file

    return read_model_file(path, own_model)


def load(folder: str | Path, own_model: "Model | None" = None) -> "Result":
    """Load the fit, design, tuning, verification, study or comparison that a folder holds; nothing is computed.

    Args:
        folder: as `save` or a command writes it.
        own_model: equations that are not built in.

    Raises:
        InputError: no result folder, one of an earlier version, or files that do not belong together.
    """
    from seatrial.data.folder.result_folder import load_result

    return load_result(folder, own_model)


def load_fit(folder: str | Path, own_model: "Model | None" = None) -> "Fit":
    """Load the fit of a result folder; arguments and errors as in `load`.

    Raises:
        InputError: the folder holds another result.
    """
    from seatrial.data.folder.result_folder import load_fit

    return load_fit(folder, own_model)


def report(result: "Result | str | Path", path: str | Path) -> Path:
    """Render a result, or that of a folder, as one self-contained HTML file; nothing is computed. Returns its path.

    Raises:
        InputError: no result folder, or the file cannot be written.
    """
    from seatrial.core.values.files import write_atomically
    from seatrial.reporting.pages import report_page

    value = load(result) if isinstance(result, str | Path) else result
    write_atomically(Path(path), report_page(value).encode())
    return Path(path)


def save(result: "Result | Snapshot | FollowResult", folder: str | Path) -> Path:
    """Write the folder of a result (see docs/result-folder.md) with its report, all files or none.

    Args:
        result: a fit, design, tuning, verification, study or comparison, or what `follow` returns: the fit after
            `once`, else the last estimate.
        folder: a result that it holds is replaced; other files in it are left alone.

    Returns:
        Path of ``report.html``, or of ``online.json`` where following ended without a fit.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core import results
    from seatrial.core.values.files import write_files_atomically
    from seatrial.data.folder.result_folder import REPORT, folder_files, replaced_files
    from seatrial.reporting.pages import report_page

    # asked this way round, no result but that of `follow` needs its module
    is_shown = isinstance(result, results.Summarised)
    value = result if is_shown or isinstance(result, results.Snapshot) else result.result
    page = {REPORT: report_page(value).encode()} if isinstance(value, results.Summarised) else {}
    files = folder_files(value) | page
    return write_files_atomically(Path(folder), files, replaced_files(value)) / list(files)[-1]
