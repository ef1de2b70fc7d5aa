"""HDF5 files, by h5py from the extra `logs`."""

from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, require_library

_WIDEST = 64  # columns of a two-dimensional dataset that become columns of a table; ours


def read_hdf5(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Datasets of one group and length are a topic named after the group; ``name[k]`` for columns of a matrix.

    A compound dataset is a topic of its own; an attribute ``units`` or ``unit`` is the unit of its column.

    Raises:
        InputError: h5py is not installed, or not a readable HDF5 file.
    """
    h5py = require_library("h5py", path.name, "an HDF5 file", "logs")
    groups: dict[tuple[str, int], dict[str, np.ndarray]] = defaultdict(dict)
    units: dict[tuple[str, str], str] = {}

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or item.ndim not in (1, 2):
            return
        group, _, field = name.rpartition("/")
        unit = item.attrs.get("units", item.attrs.get("unit", ""))
        if item.dtype.names:
            values = item[()]
            numeric = [column for column in item.dtype.names if item.dtype[column].kind in "fiu"]
            groups[name, len(values)] |= {column: np.asarray(values[column], float) for column in numeric}
        elif item.dtype.kind in "fiu" and item.ndim == 1:
            groups[group, len(item)][field] = np.asarray(item[()], dtype=float)
            units[group, field] = unit.decode() if isinstance(unit, bytes) else str(unit)
        elif item.dtype.kind in "fiu" and item.shape[1] <= _WIDEST:
            matrix = np.asarray(item[()], dtype=float)
            groups[group, len(item)] |= {f"{field}[{k}]": matrix[:, k] for k in range(matrix.shape[1])}

    try:
        with h5py.File(path, "r") as file:
            file.visititems(visit)
    except Exception as error:  # h5py raises OS, runtime, key and value errors on damaged files
        raise InputError(
            f"{path.name} is not a readable HDF5 file ({' '.join(str(error).split())}); save it again"
        ) from None
    lengths = [group for group, _ in groups]
    tables = [
        RawTable(
            path.name,
            tuple(columns),
            tuple(columns.values()),
            topic=group if lengths.count(group) == 1 else f"{group}#{length}",
            units=tuple(units.get((group, name), "") for name in columns),
        )
        for (group, length), columns in groups.items()
        if columns and length
    ]
    return Log(path.name, tuple(tables))
