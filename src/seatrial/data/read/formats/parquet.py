"""Parquet tables, by pandas with pyarrow from the extra `formats`."""

from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, fault_text, require_library


def read_parquet(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Every column of the table under its name; an index becomes the first columns.

    Raises:
        InputError: pyarrow is not installed, or not a Parquet file.
    """
    parquet = require_library("pyarrow.parquet", path.name, "a Parquet file", "formats")
    try:
        table = parquet.read_table(path)
    except Exception as error:  # pyarrow raises OS, value and its own errors on damaged files
        raise InputError(f"{path.name} is not a readable Parquet file ({fault_text(error)})") from None
    cells = tuple(column.to_numpy(zero_copy_only=False) for column in table.columns)
    return Log.of_table(RawTable(path.name, tuple(table.column_names), cells))
