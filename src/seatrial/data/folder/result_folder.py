"""The result folder: `result.json`, `model.toml`, `arrays.npz`; the report is rendered from it without computing.

Its schema is documented in docs/result-folder.md.
"""

import hashlib
import json
from pathlib import Path

from seatrial.core.equations import Model
from seatrial.core.results import Fit
from seatrial.core.values import Array, InputError
from seatrial.core.values.files import write_files_atomically
from seatrial.data.folder.archive import distinct_records, npz_arrays, npz_bytes, record_arrays
from seatrial.data.folder.fit_json import fit_json, strict_json
from seatrial.data.folder.fit_table import band_arrays, detail_table, fit_from_tables
from seatrial.data.folder.model_file import ModelFile, model_provenance, model_text, parse_model
from seatrial.data.trial.approach import approach_condition

FORMAT = 1


def save_fit(fit: Fit, folder: str | Path) -> Path:
    """Write the folder's three files, whole or not at all; other files in it are left alone.

    Raises:
        InputError: the folder cannot be written.
    """
    return write_files_atomically(Path(folder), _file_contents(fit))


def load_fit(folder: str | Path, own_model: Model | None = None) -> Fit:
    """The fit a folder holds.

    Args:
        own_model: equations that are not built in.

    Raises:
        InputError: no result folder, files that do not belong together, or other equations.
    """
    folder = Path(folder)
    try:
        text = (folder / "result.json").read_text(encoding="utf-8")
        files = {name: (folder / name).read_bytes() for name in ("model.toml", "arrays.npz")}
    except OSError as error:
        raise InputError(
            f"'{folder}' is no result folder ({error.filename}: {error.strerror}); run 'seatrial identify'"
        ) from None
    try:
        table = json.loads(text)
        if table["format"] != FORMAT:
            raise InputError(f"'{folder}' has format {table['format']}, this version reads {FORMAT}; identify again")
        for name, content in files.items():
            if hashlib.sha256(content).hexdigest() != table["files"][name]:
                raise InputError(f"'{folder / name}' has changed since the result was written; identify again")
        model = parse_model(files["model.toml"].decode(), str(folder / "model.toml"), own_model)
        return fit_from_tables(table, model, npz_arrays(files["arrays.npz"]))
    except (KeyError, TypeError, json.JSONDecodeError) as error:
        raise InputError(f"'{folder / 'result.json'}' is damaged ({error}); run 'seatrial identify' again") from None


def _file_contents(fit: Fit) -> dict[str, bytes]:
    """File name -> content; result.json last, with the digests of the others."""
    records = distinct_records([*fit.records, *(r for p in fit.predictions for r in (p.measured, p.simulated))])
    place = {id(record): i for i, record in enumerate(records)}
    arrays: dict[str, Array] = {}
    for i, record in enumerate(records):
        arrays |= record_arrays(record, f"record{i}")
    for residuals in fit.residuals:
        arrays[f"residuals/{residuals.channel}"] = residuals.values
        arrays[f"autocorrelation/{residuals.channel}"] = residuals.autocorrelation
    arrays |= band_arrays(fit)
    arrays["solution"] = fit.solution.point
    roles = [(r, "validation" if r.name in {p.record for p in fit.validation()} else "training") for r in fit.records]
    provenance = model_provenance(roles, fit.method.criterion, fit.seed, fit.versions)
    approach = approach_condition([r for r, role in roles if role == "training"], fit.model)
    model = model_text(
        ModelFile(fit.model, fit.covariance, provenance, fit.ship, approach, fit.interval_basis)
    ).encode()
    contents = {"model.toml": model, "arrays.npz": npz_bytes(arrays)}
    digests = {name: hashlib.sha256(content).hexdigest() for name, content in contents.items()}
    detail = detail_table(fit, records, place)
    table = {"format": FORMAT, "files": digests, **fit_json(fit), "detail": detail}
    return contents | {"result.json": strict_json(table).encode()}
