"""Readers by format: the built-in ones, and those that other packages install under ``seatrial.readers``."""

from pathlib import Path

from seatrial._plugins import installed, load_plugin
from seatrial.core.values import InputError, spelling_hint
from seatrial.data.read.mat import read_mat
from seatrial.data.read.netcdf import read_netcdf
from seatrial.data.read.parquet import read_parquet
from seatrial.data.read.raw_table import Reader
from seatrial.data.read.text import read_text

ENTRY_POINT_GROUP = "seatrial.readers"

READERS: dict[str, Reader] = {"text": read_text, "mat": read_mat, "parquet": read_parquet, "netcdf": read_netcdf}
# suffix of a file name -> format; the suffix of an installed format is its name
_SUFFIXES = {
    ".csv": "text", ".tsv": "text", ".txt": "text", ".dat": "text", ".asc": "text", ".mat": "mat",
    ".parquet": "parquet", ".pq": "parquet", ".nc": "netcdf", ".nc4": "netcdf", ".netcdf": "netcdf",
}  # fmt: skip


def require_format(name: str) -> str:
    """Return the name of a format for which there is a reader.

    Raises:
        InputError: there is none; the nearest name is given.
    """
    if name not in READERS and name not in installed(ENTRY_POINT_GROUP):
        raise InputError(f"unknown format '{name}'{spelling_hint(name, _formats())}")
    return name


def format_of(path: Path) -> str:
    """Return the format that the suffix of a file name stands for (``.gz`` is looked through).

    Raises:
        InputError: the suffix is not known.
    """
    suffix = Path(path.name.removesuffix(".gz")).suffix.lower()
    if suffix in _SUFFIXES:
        return _SUFFIXES[suffix]
    if suffix[1:] in installed(ENTRY_POINT_GROUP):
        return suffix[1:]
    raise InputError(
        f"{path.name}: the suffix '{suffix}' stands for no format; give format = one of {', '.join(_formats())}"
    )


def reader_of(name: str) -> Reader:
    """Return the reader of a format.

    Raises:
        InputError: there is none, or an installed one cannot be loaded.
    """
    if require_format(name) in READERS:
        return READERS[name]
    return load_plugin(ENTRY_POINT_GROUP, name, InputError)


def _formats() -> list[str]:
    return sorted({*READERS, *installed(ENTRY_POINT_GROUP)})
