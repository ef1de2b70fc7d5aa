"""Parquet tables, by pandas with pyarrow from the extra `formats`."""

from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.raw_table import RawTable


def read_parquet(path: Path, layout: Layout) -> RawTable:  # noqa: ARG001
    """Every column of the table under its name; an index becomes the first columns.

    Raises:
        InputError: pyarrow is not installed, or not a Parquet file.
    """
    try:
        import pyarrow.parquet as parquet  # type: ignore[import-untyped]
    except ImportError:
        raise InputError(
            f"{path.name} is a Parquet file, which needs pyarrow; install it with: pip install 'seatrial[formats]'"
        ) from None
    try:
        table = parquet.read_table(path)
    except (OSError, ValueError) as error:
        raise InputError(f"{path.name} is not a readable Parquet file ({error})") from None
    return RawTable(
        path.name, tuple(table.column_names), tuple(column.to_numpy(zero_copy_only=False) for column in table.columns)
    )
