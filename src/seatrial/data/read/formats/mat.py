"""MATLAB files: version 5 by scipy, version 7.3 (HDF5) by h5py from the extra `formats`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, fault_text, require_library

_HDF5 = b"\x89HDF"


def read_mat(path: Path, layout: Layout) -> Log:
    """Vectors become columns under their names (``run.u`` for a field of a struct); a matrix under its numbers.

    Column numbers count through the columns of the largest matrix of the file.

    Raises:
        InputError: not a MATLAB file, or h5py is needed and not installed.
    """
    with path.open("rb") as file:
        head = file.read(520)  # the signature of HDF5, at 0 or after a block of 512 bytes
    variables = _read_version_7(path) if _HDF5 in head[:8] or head[512:516] == _HDF5 else _read_version_5(path)
    return Log.of_table(_raw_table(path.name, variables, layout))


def _read_version_5(path: Path) -> dict[str, np.ndarray]:
    from scipy.io import loadmat

    try:
        return _flatten(loadmat(path, squeeze_me=True, struct_as_record=True))
    except Exception as error:  # scipy raises half a dozen unrelated types on damaged files
        raise InputError(
            f"{path.name} is not a readable MATLAB file ({fault_text(error)}); save it again with -v7"
        ) from None


def _flatten(variables: Mapping, prefix: str = "") -> dict[str, np.ndarray]:
    found: dict[str, np.ndarray] = {}
    for name, value in variables.items():
        if name.startswith("__"):
            continue
        array = np.asarray(value)
        if array.dtype.names and array.size == 1:
            fields = {field: array[field].item() for field in array.dtype.names}
            found |= _flatten(fields, f"{prefix}{name}.")
        elif array.dtype.kind in "fiub":
            found[prefix + name] = array.astype(float, copy=False)
    return found


def _read_version_7(path: Path) -> dict[str, np.ndarray]:
    h5py = require_library("h5py", path.name, "a MATLAB 7.3 file", "formats")
    variables: dict[str, np.ndarray] = {}

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu" and not name.startswith("#"):
            variables[name.replace("/", ".")] = np.squeeze(np.asarray(item[()], dtype=float).T)

    try:
        with h5py.File(path, "r") as file:
            file.visititems(visit)
    except Exception as error:  # h5py raises OS, runtime, key and value errors on damaged files
        raise InputError(f"{path.name} is not a readable MATLAB 7.3 file ({fault_text(error)})") from None
    return variables


def _raw_table(file: str, variables: dict[str, np.ndarray], layout: Layout) -> RawTable:
    matrices = [value for value in variables.values() if value.ndim == 2]
    matrix = max(matrices, key=np.size, default=np.empty((0, 0)))
    if not layout.has_named_columns:
        return RawTable(file, ("",) * matrix.shape[1], tuple(matrix.T))
    vectors = {name: np.atleast_1d(value) for name, value in variables.items() if value.ndim <= 1}
    time = vectors.get(str(layout.time.source), np.empty(0))
    same = {name: value for name, value in vectors.items() if value.size == time.size or time.size == 0}
    for column in layout.columns:
        if column.source in vectors and column.source not in same:
            raise InputError(
                f"{file}: '{column.source}' has {vectors[str(column.source)].size} samples, time has {time.size}; "
                "give a variable of the same length"
            )
    return RawTable(file, tuple(same), tuple(same.values()))
