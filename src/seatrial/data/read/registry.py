"""Readers by format, built in or installed; those of binary formats run in a process of their own."""

import contextlib
import importlib
import pickle
import re
import signal
import subprocess
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from seatrial._plugins import installed, load_plugin
from seatrial.core.values import InputError, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, Reader
from seatrial.data.read.nmea_sentence import READ
from seatrial.numerics.platform import limit_resources

# Files of binary formats, read in a process of its own: a damaged one can end that process, and nothing else.

# bytes of memory that a reader may use: at least so many, and so many for each byte of the file; ours
_LEAST_MEMORY, _MEMORY_PER_BYTE = 4 * 2**30, 64
# CPU seconds: at least so many, and so many for each byte (two minutes for 10 MB); ours
_LEAST_CPU_S, _CPU_S_PER_BYTE = 120, 12e-6
_TOO_LARGE = "its reader needs more memory than such a file can fill"
_OUT_OF_TIME = (getattr(signal, "SIGXCPU", None), getattr(signal, "SIGKILL", None))


def read_in_process(name: str, path: Path, layout: Layout) -> Log:
    """Read a file by the built-in reader of a format, in a process with limits of memory and of CPU time.

    Raises:
        InputError: what the reader raises; the reader crashed, or exceeded a limit.
    """
    command = [sys.executable, "-c", "from seatrial.data.read.registry import serve; serve()"]
    request = pickle.dumps((name, path, layout, [place for place in sys.path if place]))
    done = subprocess.run(command, input=request, capture_output=True, check=False)
    try:
        answer = pickle.loads(done.stdout)
    except Exception:
        raise InputError(f"{path.name} is damaged: {_end_text(done)}; copy it again or convert it to CSV") from None
    if isinstance(answer, Log):
        return answer
    raise InputError(str(answer))


def _end_text(done: subprocess.CompletedProcess) -> str:
    """How a process ended that gave no answer."""
    if b"MemoryError" in done.stderr or b"bad_alloc" in done.stderr:
        return _TOO_LARGE
    if -done.returncode in [one for one in _OUT_OF_TIME if one is not None]:
        return "its reader does not come to an end"
    return f"its reader ends with code {done.returncode}"


def serve() -> None:
    """Read the request on standard input, and write the log or the sentence of the error to standard output."""
    name, path, layout, places = pickle.load(sys.stdin.buffer)
    sys.path[:] = places

    answer_to = sys.stdout.buffer
    size = path.stat().st_size
    limit_resources(max(_LEAST_MEMORY, _MEMORY_PER_BYTE * size), int(_LEAST_CPU_S + _CPU_S_PER_BYTE * size))
    with contextlib.redirect_stdout(sys.stderr):
        try:
            answer: Log | str = FORMATS[name].reader()(path, layout)
        except (InputError, MemoryError) as error:
            out_of_memory = isinstance(error, MemoryError) or isinstance(error.__context__, MemoryError)
            answer = f"{path.name} is damaged: {_TOO_LARGE}; copy it again" if out_of_memory else str(error)
    pickle.dump(answer, answer_to, protocol=pickle.HIGHEST_PROTOCOL)
    answer_to.flush()


# Readers by format: the built-in ones, and those that other packages install under ``seatrial.readers``.

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
    "signalk": Format("signalk", is_text=True),
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
# behind whatever a logger writes before it, such as a tag block or the cells of a table; without a checksum by its kind
_SENTENCE = re.compile(
    rb"^[^\n$!]{0,120}[$!](?:[A-Z]{5},[^\n]*\*[0-9A-Fa-f]{2}\b|[A-Z]{2}(?:%s),)" % "|".join(sorted(READ)).encode(),
    re.MULTILINE,
)
_DELTA = re.compile(rb'\{[^\n]*"updates"\s*:\s*\[')
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
        if _DELTA.search(head):
            return "signalk"
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
