"""Readers by format: the built-in ones, and those that other packages install under ``seatrial.readers``."""

import importlib
import re
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from seatrial._plugins import installed, load_plugin
from seatrial.core.values import InputError, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.data.read.log import Reader
from seatrial.data.read.reading_process import read_in_process

ENTRY_POINT_GROUP = "seatrial.readers"

_TEXT_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".asc", ".log", ".raw")
# bytes of a file that are looked at to know its format
_HEAD_BYTES = 4096


@dataclass(frozen=True)
class Format:
    """How files of one format are known and read.

    Attributes:
        module: of the reader under `seatrial.data.read.formats`; the reader is its ``read_MODULE``.
        suffixes: of file names.
        signature: bytes with which a file begins; empty: none.
        is_text: whether it is read in this process, and not in one of its own with limits.
    """

    module: str
    suffixes: tuple[str, ...] = ()
    signature: bytes = b""
    is_text: bool = False

    def reader(self) -> Reader:
        """Return the function that reads files of the format, in this process."""
        module = importlib.import_module(f"seatrial.data.read.formats.{self.module}")
        return getattr(module, f"read_{self.module}")


FORMATS: dict[str, Format] = {
    "text": Format("text", _TEXT_SUFFIXES, is_text=True),
    "nmea0183": Format("nmea0183", (".nmea",), is_text=True),
    "nmea2000": Format("nmea2000", (".n2k",)),
    "ardupilot-bin": Format("ardupilot_bin", (".bin",), b"\xa3\x95"),
    "ardupilot-tlog": Format("ardupilot_tlog", (".tlog",)),
    "rosbag": Format("rosbag", (".bag", ".mcap", ".db3")),
    "ulog": Format("ulog", (".ulg",), b"ULog\x01\x12\x35"),
    "excel": Format("excel", (".xlsx", ".xlsm")),
    "hdf5": Format("hdf5", (".h5", ".hdf5", ".hdf")),
    "tdms": Format("tdms", (".tdms",), b"TDSm"),
    "mdf4": Format("mdf4", (".mf4", ".mdf"), b"MDF     "),
    "mat": Format("mat", (".mat",)),
    "parquet": Format("parquet", (".parquet", ".pq"), b"PAR1"),
    "netcdf": Format("netcdf", (".nc", ".nc4", ".netcdf")),
}
_SENTENCE = re.compile(rb"^[^,\n]{0,60}[$!][A-Z]{5},[^\n]*\*[0-9A-Fa-f]{2}\s*$", re.MULTILINE)
_BUS_MESSAGE = re.compile(
    rb"^(<0x[0-9A-Fa-f]+> \[\d\]|\(\d+\.\d+\) \w+ [0-9A-Fa-f]{8}#|\w*can\d+\s+[0-9A-Fa-f]{8}\s+\[\d\]"
    rb"|A\d{6}\.\d{3} [0-9A-Fa-f]{5} |\d{4}-\d\d-\d\d[T-][0-9:.]+Z?,\d,\d{5,6},\d+,\d+,\d+,[0-9a-f]{2},)",
    re.MULTILINE,
)


def require_format(name: str) -> str:
    """Return the name of a format for which there is a reader.

    Raises:
        InputError: there is none; the nearest name is given.
    """
    if name not in FORMATS and name not in installed(ENTRY_POINT_GROUP):
        raise InputError(f"unknown format '{name}'{spelling_hint(name, _formats())}")
    return name


def format_of(path: Path) -> str:
    """Return the format of a file, by its first bytes, or by the suffix of its name (``.gz`` is looked through).

    Raises:
        InputError: neither is known.
    """
    head = _first_bytes(path)
    for name, known in FORMATS.items():
        if known.signature and head.startswith(known.signature):
            return name
    suffix = Path(path.name.removesuffix(".gz")).suffix.lower()
    if suffix in ("", *_TEXT_SUFFIXES):
        if _SENTENCE.search(head):
            return "nmea0183"
        if _BUS_MESSAGE.search(head):
            return "nmea2000"
    for name, known in FORMATS.items():
        if suffix in known.suffixes:
            return name
    if suffix[1:] in installed(ENTRY_POINT_GROUP):
        return suffix[1:]
    raise InputError(
        f"{path.name}: the suffix '{suffix}' stands for no format; give format = one of {', '.join(_formats())}"
    )


def reader_of(name: str) -> Reader:
    """Return the reader of a format; binary ones read in a process of their own, with limits.

    Raises:
        InputError: there is none, or an installed one cannot be loaded.
    """
    if require_format(name) not in FORMATS:
        return load_plugin(ENTRY_POINT_GROUP, name, InputError)
    return FORMATS[name].reader() if FORMATS[name].is_text else partial(read_in_process, name)


def _first_bytes(path: Path) -> bytes:
    if not is_file(path):
        return b""
    try:
        with path.open("rb") as file:
            return file.read(_HEAD_BYTES)
    except OSError:
        return b""


def _formats() -> list[str]:
    return sorted({*FORMATS, *installed(ENTRY_POINT_GROUP)})
