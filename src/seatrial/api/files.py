"""Files in and out: records, model files, result folders, reports."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seatrial.core.equations import Model
    from seatrial.core.results import Design, Fit, Study
    from seatrial.core.results.tuning import Tuning
    from seatrial.core.values import Record
    from seatrial.data.folder.model_file import ModelFile
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


def load_fit(folder: str | Path, own_model: "Model | None" = None) -> "Fit":
    """Load the fit of a result folder.

    Args:
        folder: as `identify` writes it.
        own_model: equations that are not built in.

    Raises:
        InputError: it is none, or its files do not belong together.
    """
    from seatrial.data.folder.result_folder import load_fit

    return load_fit(folder, own_model)


def report(fit: "Fit", path: str | Path) -> Path:
    """Render the fit as one self-contained HTML file; nothing is computed.

    Raises:
        InputError: the file cannot be written.
    """
    from seatrial.reporting import write_report

    write_report(fit, Path(path))
    return Path(path)


def save_fit(fit: "Fit", folder: str | Path) -> Path:
    """Write the result folder (see docs/result-folder.md) with its report; returns the report's path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.data.folder.result_folder import save_fit

    return report(fit, save_fit(fit, folder) / "report.html")


def save_outcome(outcome: "FollowResult", folder: str | Path) -> Path:
    """Write what following came to: a result folder with its report after `once`, else ``online.json``; its path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import write_files_atomically
    from seatrial.data.folder.fit_json import strict_json
    from seatrial.data.folder.online_json import online_json

    if outcome.fit is not None:
        return save_fit(outcome.fit, folder)
    text = strict_json(online_json(outcome.snapshot, outcome.counts))
    return write_files_atomically(Path(folder), {"online.json": text.encode()}) / "online.json"


def save_design(design: "Design", folder: str | Path) -> Path:
    """Write report, orders, plan, model and ``design.json`` of a design to `folder`; returns the report's path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import write_files_atomically
    from seatrial.data.folder.design_json import design_json
    from seatrial.data.folder.fit_json import strict_json
    from seatrial.data.folder.model_file import ModelFile, model_text
    from seatrial.data.folder.orders import orders_csv
    from seatrial.data.read.record_csv import record_csv
    from seatrial.reporting.design import html

    texts = {
        "orders.csv": orders_csv(design),
        "plan.csv": record_csv(design.plan),
        "design.json": strict_json(design_json(design)),
        "model.toml": model_text(ModelFile(design.model)),
        "report.html": html(design),
    }
    return write_files_atomically(Path(folder), {name: text.encode() for name, text in texts.items()}) / "report.html"


def save_tuning(tuning: "Tuning", folder: str | Path) -> Path:
    """Write report, gains, loop, schedule and ``tuning.json`` of a tuning to `folder`; returns the report's path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import write_files_atomically
    from seatrial.data.folder.fit_json import strict_json
    from seatrial.data.folder.tuning_files import gains_toml, loop_mat, schedule_csv
    from seatrial.data.folder.tuning_json import tuning_json
    from seatrial.reporting.tuning import html

    contents = {
        "gains.toml": gains_toml(tuning).encode(),
        "loop.mat": loop_mat(tuning),
        "tuning.json": strict_json(tuning_json(tuning)).encode(),
        "report.html": html(tuning).encode(),
    }
    if tuning.schedule:
        contents["schedule.csv"] = schedule_csv(tuning).encode()
    return write_files_atomically(Path(folder), contents) / "report.html"


def save_study(study: "Study", folder: str | Path) -> Path:
    """Write ``study.json`` and ``report.html`` of a study to `folder`; returns the report's path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import writable_folder, write_atomically
    from seatrial.data.folder.fit_json import strict_json
    from seatrial.reporting.study import write_study

    place = writable_folder(Path(folder))
    write_atomically(place / "study.json", strict_json(study.as_table()).encode())
    return write_study(study, place / "report.html")
