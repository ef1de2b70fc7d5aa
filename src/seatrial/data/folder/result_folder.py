"""Folders of results: what each kind holds, written as one and read back without computing.

The schema is documented in docs/result-folder.md.
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from seatrial.core import results
from seatrial.core.equations import Model
from seatrial.core.results import Fit, Summarised, session_offsets_of
from seatrial.core.values import Array, InputError
from seatrial.core.values.files import is_file, parse_json, read_bounded, read_table_text, write_files_atomically
from seatrial.data.folder.document import (
    FORMAT,
    document,
    npz_arrays,
    npz_bytes,
    read_document,
    stored_document,
    strict_json,
)
from seatrial.data.folder.model_file import ModelFile, ModelProvenance, RecordSource, model_text, parse_model
from seatrial.data.read.record_file import record_csv
from seatrial.data.trial.records import approach_condition

if TYPE_CHECKING:
    from seatrial.core.results import Comparison, Design, Snapshot, Study, Tuning, Verification

    Result = Fit | Design | Tuning | Study | Comparison | Verification

# bytes of a data file of a folder, at most: half an hour at 10 kHz of eight channels, thrice; chosen
_LARGEST_COMPANION = 2**32
MODEL, ARRAYS, REPORT = "model.toml", "arrays.npz", "report.html"
T = TypeVar("T")


@dataclass(frozen=True)
class FolderKind(Generic[T]):
    """What a folder holds for one type of result.

    Attributes:
        result: gives the type, whose module is imported then.
        document: name of the JSON file.
        command: writes such a folder.
        model: result -> the model file of the folder.
        from_model: model file -> those fields of the result that it holds.
        products: result -> name and content of the files that other programs read.
        product_names: names of these files.
        repeated: values of `--json` that stand elsewhere in the folder.
    """

    result: Callable[[], type[T]]
    document: str
    command: str
    model: Callable[[T], ModelFile] | None = None
    from_model: Callable[[ModelFile], dict[str, Any]] = lambda _: {}
    products: Callable[[T], Mapping[str, bytes]] = lambda _: {}
    product_names: tuple[str, ...] = ()
    repeated: frozenset[str] = frozenset()


LASTING_WARNINGS = (
    "not-converged", "search-abandoned", "unphysical-values", "held-coupling", "term-worsens-prediction",
)  # fmt: skip
"""Codes of findings of a fit that hold for every use of its values: they are written into the model file."""


def model_of_fit(fit: Fit) -> ModelFile:
    """Return the model file of a fit: equations, values and their covariance, ship, records, approach condition."""
    held_out = {p.record for p in fit.validation}
    roles = [(r, "validation" if r.name in held_out else "training") for r in fit.records]
    sources = tuple(RecordSource(record.name, role, record.provenance.sha256) for record, role in roles)
    warnings = tuple(f"[{f.code}] {f.message}" for f in fit.findings if f.code in LASTING_WARNINGS)
    provenance = ModelProvenance(sources, fit.method.criterion, fit.seed, dict(fit.versions), warnings)
    approach = approach_condition([r for r, role in roles if role == "training"], fit.model)
    offsets = session_offsets_of(fit.offsets, fit.offset_populations)
    waves = fit.noise_model.waves if fit.noise_model else ()
    return ModelFile(fit.model, fit.covariance, provenance, fit.ship, approach, fit.interval_basis, offsets, waves)


def _fields_of_fit(file: ModelFile) -> dict[str, Any]:
    return {
        "model": file.model, "ship": file.ship, "covariance": file.covariance, "interval_basis": file.interval_basis,
    }  # fmt: skip


def _fit_products(fit: Fit) -> dict[str, bytes]:
    if fit.posterior is None:
        return {}
    names = np.array([c.name for c in fit.posterior.coefficients])
    arrays = {"names": names, "points": fit.posterior.points, "log_density": fit.posterior.log_density}
    return {"posterior.npz": npz_bytes(arrays)}


def _design_products(design: "Design") -> dict[str, bytes]:
    from seatrial.data.folder.gains_file import orders_csv

    return {"orders.csv": orders_csv(design).encode(), "plan.csv": record_csv(design.plan).encode()}


def _tuning_products(tuning: "Tuning") -> dict[str, bytes]:
    from seatrial.data.folder.gains_file import gains_toml, loop_mat, schedule_csv

    schedule = {"schedule.csv": schedule_csv(tuning).encode()} if tuning.schedule else {}
    return {"gains.toml": gains_toml(tuning).encode(), "loop.mat": loop_mat(tuning), **schedule}


KINDS: tuple[FolderKind[Any], ...] = (
    FolderKind(
        lambda: Fit, "result.json", "seatrial identify TRIAL --out DIR", model_of_fit, _fields_of_fit,
        _fit_products, repeated=frozenset({"validation", "intervals"}),
    ),
    FolderKind(
        lambda: results.Design, "design.json", "seatrial design TRIAL --out DIR",
        lambda design: ModelFile(design.model), lambda file: {"model": file.model}, _design_products,
        ("orders.csv", "plan.csv"), frozenset({"equation_hash", "values", "evaluations", "status"}),
    ),
    FolderKind(
        lambda: results.Tuning, "tuning.json", "seatrial tune LOOP --out DIR", products=_tuning_products,
        product_names=("gains.toml", "loop.mat", "schedule.csv"), repeated=frozenset({"evaluations", "status"}),
    ),
    FolderKind(lambda: results.Study, "study.json", "seatrial reproduce STUDY --out DIR"),
    FolderKind(
        lambda: results.Comparison, "comparison.json", "seatrial compare FIRST SECOND --out DIR",
        repeated=frozenset({"significant"}),
    ),
    FolderKind(
        lambda: results.Verification, "verification.json", "seatrial tune LOOP --verify LOG --out DIR",
        repeated=frozenset({"outside", "moved"}),
    ),
)  # fmt: skip


def replaced_files(result: "Result | Snapshot") -> frozenset[str]:
    """Return the names of files of earlier results, of any kind, that a folder must not keep beside this one."""
    if not isinstance(result, Summarised):
        return frozenset()
    return frozenset({ARRAYS, MODEL, REPORT}).union(*({kind.document, *kind.product_names} for kind in KINDS))


def folder_files(result: "Result | Snapshot") -> dict[str, bytes]:
    """Return name and content of every data file of a result's folder, the document last; a report is none of them."""
    if not isinstance(result, Summarised):
        return {"online.json": strict_json(document(result)).encode()}
    kind = next(kind for kind in KINDS if isinstance(result, kind.result()))
    table, arrays = stored_document(result, kind.repeated)
    companions = {ARRAYS: npz_bytes(arrays)} if arrays else {}
    if kind.model is not None:
        companions[MODEL] = model_text(kind.model(result)).encode()
    files = {**kind.products(result), **companions}
    digests = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
    return {**files, kind.document: strict_json(table | {"files": digests}).encode()}


def save_result(result: "Result | Snapshot", folder: str | Path) -> Path:
    """Write the data files of a result, all or none, and return the folder; the files of a result in it are replaced.

    Other files in the folder are left alone.

    Raises:
        InputError: the folder cannot be written.
    """
    return write_files_atomically(Path(folder), folder_files(result), replaced_files(result))


def load_result(folder: str | Path, own_model: Model | None = None) -> "Result":
    """Return the result that a folder holds; nothing is computed.

    Args:
        own_model: equations that are not built in.

    Raises:
        InputError: no result folder, one of an earlier version, files that do not belong together, or other equations.
    """
    folder = Path(folder)
    kind = next((kind for kind in KINDS if is_file(folder / kind.document)), None)
    if kind is None:
        raise InputError(
            f"'{folder}' is no result folder (no {', '.join(kind.document for kind in KINDS)}); "
            "give the DIR of 'seatrial identify TRIAL --out DIR'"
        )
    command = f"'{kind.command.replace('DIR', str(folder))}'"
    try:
        table = parse_json(read_table_text(folder / kind.document))
        written_format = table.get("format", 1)  # studies of format 1 do not name it
        if written_format != FORMAT:
            raise InputError(
                f"'{folder}' is of format {written_format}, this version reads {FORMAT} and may estimate other values "
                f"(CHANGELOG.md says where); run {command}"
            )
        arrays, fields = _companions(kind, folder, table["files"], own_model, command)
        return read_document(kind.result(), table | fields, arrays)
    except OSError as error:
        raise InputError(f"'{error.filename}' cannot be read ({error.strerror}); run {command} again") from None
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"'{folder / kind.document}' is damaged ({error}); run {command} again") from None


def load_fit(folder: str | Path, own_model: Model | None = None) -> Fit:
    """Return the fit that a folder holds; arguments and errors as in `load_result`.

    Raises:
        InputError: it holds another result.
    """
    result = load_result(folder, own_model)
    if not isinstance(result, Fit):
        raise InputError(
            f"'{folder}' holds a {type(result).__name__.lower()}, no fit; give a folder of 'seatrial identify'"
        )
    return result


def _companions(
    kind: FolderKind[Any], folder: Path, digests: Mapping[str, str], own_model: Model | None, command: str
) -> tuple[dict[str, Array], dict[str, Any]]:
    """Return the arrays of a folder, and the fields of its result that stand in the model file."""
    needed = digests.keys() & {ARRAYS, MODEL}
    present = [name for name in digests if name in needed or is_file(folder / name)]
    contents = {name: read_bounded(folder / name, _LARGEST_COMPANION) for name in present}
    for name, content in contents.items():
        if hashlib.sha256(content).hexdigest() != digests[name]:
            raise InputError(f"'{folder / name}' has changed since the result was written; run {command} again")
    arrays = npz_arrays(contents[ARRAYS]) if ARRAYS in contents else {}
    if MODEL not in contents:
        return arrays, {}
    return arrays, kind.from_model(parse_model(contents[MODEL].decode(), str(folder / MODEL), own_model))
