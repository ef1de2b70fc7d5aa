"""ArduPilot dataflash logs (.bin), by pymavlink from the extra `logs`."""

import contextlib
import io
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, LogEvent, RawTable, fault_text, require_library, topic_table

_MICRO = 1e-6  # s, of a microsecond
_HEADER_BYTES = 3  # two bytes that mark a message and its type (ArduPilot, AP_Logger/LogStructure.h)
_NOT_SAMPLES = ("FMT", "FMTU", "UNIT", "MULT", "PARM", "MSG", "MODE")
# ArduPilot, AP_Logger/LogStructure.h: letter of FMTU -> unit of ours; others keep their text
_UNITS = {"deg/s": "deg/s", "rad/s": "rad/s", "m/s": "m/s", "deg": "deg", "degheading": "deg", "m": "m",
          "rad": "rad", "deglatitude": "deg", "deglongitude": "deg", "rpm": "rpm", "s": "s", "m/s/s": "m/s^2",
          "PWM": "us"}  # fmt: skip


def read_ardupilot_bin(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Every message as a topic (``XKF1[0]`` where it has instances), numbers multiplied as the log says.

    ``time`` is s since the start of the autopilot; PARM are parameters, changes of MODE are events.

    Raises:
        InputError: pymavlink is not installed, or not a readable dataflash log.
    """
    dfreader = require_library("pymavlink.DFReader", path.name, "an ArduPilot log", "logs")
    try:
        with contextlib.redirect_stderr(io.StringIO()):
            log = dfreader.DFReader_binary(str(path))
        data = np.frombuffer(log.data_map, dtype=np.uint8)
        tables: list[RawTable] = []
        for kind in sorted(log.formats):
            rows = np.asarray(log.offsets[kind], dtype=np.int64)
            message = log.formats[kind]
            rows = rows[rows + message.len <= data.size]
            if rows.size and message.name not in _NOT_SAMPLES:
                tables += _tables(path.name, message, _cells(data, rows, message, dfreader))
        parameters = {
            str(row["Name"].decode()).rstrip("\0"): float(row["Value"])
            for row in _messages(log, data, "PARM", dfreader)
        }
        events = tuple(_mode_event(row) for row in _messages(log, data, "MODE", dfreader))
    except Exception as error:  # pymavlink raises struct, index, value and type errors on damaged logs
        raise InputError(
            f"{path.name} is not a readable ArduPilot log ({fault_text(error)}); download it again"
        ) from None
    return Log(path.name, tuple(tables), parameters, events)


def _messages(log: Any, data: np.ndarray, name: str, dfreader: Any) -> np.ndarray:
    """The messages of a name, a structured array; empty where the log has none."""
    kind = log.name_to_id.get(name)
    if kind is None:
        return np.empty(0, dtype=[("Name", "S16")])
    message = log.formats[kind]
    rows = np.asarray(log.offsets[kind], dtype=np.int64)
    return _cells(data, rows[rows + message.len <= data.size], message, dfreader)


def _cells(data: np.ndarray, rows: np.ndarray, message: Any, dfreader: Any) -> np.ndarray:
    """The messages that begin at `rows` as a structured array of their fields."""
    letters = zip(message.columns, message.format, strict=False)
    layout = np.dtype([(name, _numpy(letter, dfreader.FORMAT_TO_STRUCT[letter][0])) for name, letter in letters])
    raw = data[rows[:, None] + np.arange(_HEADER_BYTES, _HEADER_BYTES + layout.itemsize)]
    return np.ascontiguousarray(raw).view(layout)[:, 0]


def _numpy(letter: str, code: str) -> str:
    """The NumPy code of a field: its letter in the log, its code in `struct`; little endian."""
    if letter == "a":
        return "(32,)<i2"
    if code.endswith("s"):
        return f"S{code[:-1]}"
    return {"b": "i1", "B": "u1", "h": "<i2", "H": "<u2", "i": "<i4", "I": "<u4", "q": "<i8", "Q": "<u8",
            "f": "<f4", "d": "<f8", "e": "<f2"}[code]  # fmt: skip


def _tables(file: str, message: Any, cells: np.ndarray) -> list[RawTable]:
    """The tables of one message: one for each instance."""
    names = [name for name in message.columns if cells.dtype[name].kind in "iuf" and cells[name].ndim == 1]
    if "TimeUS" not in names:
        return []
    instances = [None]
    if message.instance_field in names:
        instances = sorted(set(cells[message.instance_field].tolist()))
    tables = []
    for instance in instances:
        part = cells if instance is None else cells[cells[message.instance_field] == instance]
        columns = {"time": part["TimeUS"] * _MICRO}
        columns |= {name: part[name] * _multiplier(message, name) for name in names if name != "TimeUS"}
        units = {name: _UNITS.get(message.get_unit(name).strip(), "") for name in names if name != "TimeUS"}
        topic = message.name if instance is None else f"{message.name}[{instance}]"
        tables.append(topic_table(file, topic, columns, units))
    return tables


def _multiplier(message: Any, name: str) -> float:
    factor = message.msg_mults[message.columns.index(name)]
    return 1.0 if factor is None else float(factor)


def _mode_event(row: Any) -> LogEvent:
    from pymavlink import mavutil

    number = int(row["ModeNum"] if "ModeNum" in row.dtype.names else row["Mode"])
    return LogEvent(float(row["TimeUS"]) * _MICRO, f"MODE {mavutil.mode_mapping_rover.get(number, number)}")
