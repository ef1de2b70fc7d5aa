"""MAVLink telemetry logs (.tlog), by pymavlink from the extra `logs`."""

from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, LogEvent, RawTable, fault_text, require_library, topic_table

# clocks of the sender in messages, and their unit in s
_SENDER_CLOCKS = {"time_boot_ms": 1e-3, "time_usec": 1e-6}
_GROUND_STATION = 6  # MAV_TYPE_GCS (MAVLink common.xml)
_NOT_SAMPLES = ("BAD_DATA", "PARAM_VALUE", "STATUSTEXT", "HEARTBEAT", "FILE_TRANSFER_PROTOCOL")


def read_ardupilot_tlog(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Every message as a topic, ``NAME[system.component]`` where several sent it; integers as MAVLink scales them.

    ``time`` is the sender's clock moved to the receiver's (s since 1970), without the jitter of the link; PARAM_VALUE
    are parameters, changes of mode are events.

    Raises:
        InputError: pymavlink is not installed, or not a readable telemetry log.
    """
    mavutil = require_library("pymavlink.mavutil", path.name, "a MAVLink log", "logs")
    messages: dict[tuple[str, int, int], _Samples] = {}
    parameters: dict[str, float] = {}
    events: list[LogEvent] = []
    try:
        log = mavutil.mavlogfile(str(path))
        while (message := log.recv_match()) is not None:
            kind = message.get_type()
            if kind == "PARAM_VALUE":
                parameters[message.param_id] = float(message.param_value)
            elif kind == "HEARTBEAT" and message.type != _GROUND_STATION:
                _add_mode(events, message, mavutil.mode_mapping_rover)
            elif kind not in _NOT_SAMPLES and not kind.startswith("UNKNOWN"):
                sender = (kind, message.get_srcSystem(), message.get_srcComponent())
                if sender not in messages:
                    messages[sender] = _Samples.like(message)
                samples = messages[sender]
                samples.rows.append(samples.numbers_of(message))
        tables = _tables(path.name, messages)
    except InputError:
        raise
    except Exception as error:  # pymavlink raises struct, index and value errors on damaged logs
        raise InputError(f"{path.name} is not a readable MAVLink log ({fault_text(error)}); record it again") from None
    return Log(path.name, tuple(tables), parameters, tuple(events))


def _add_mode(events: list[LogEvent], message: Any, names: dict[int, str]) -> None:
    name = f"MODE {names.get(message.custom_mode, message.custom_mode)}"
    if not events or events[-1].name != name:
        events.append(LogEvent(message._timestamp, name))


@dataclass(frozen=True, eq=False)
class _Samples:
    """Messages of one kind and sender: names of their numbers, what takes them out after the receiver's stamp, rows."""

    names: tuple[str, ...]
    numbers_of: Callable[[Any], tuple[float, ...]]
    rows: list[tuple[float, ...]]

    @classmethod
    def like(cls, message: Any) -> "_Samples":
        """Return the samples, still none, of messages like this one."""
        names = tuple(name for name in message.get_fieldnames() if isinstance(getattr(message, name), int | float))
        # the stamp twice: attrgetter gives no tuple for one name
        return cls(names, attrgetter("_timestamp", "_timestamp", *names), [])


def _tables(file: str, messages: dict[tuple[str, int, int], _Samples]) -> list[RawTable]:
    kinds = [kind for kind, _, _ in messages]
    tables = []
    for (kind, system, component), samples in messages.items():
        received, _, *fields = np.array(samples.rows, dtype=float).T
        columns = dict(zip(samples.names, fields, strict=True))
        topic = kind if kinds.count(kind) == 1 else f"{kind}[{system}.{component}]"
        tables.append(topic_table(file, topic, {"time": _sender_time(received, columns), **columns}))
    return tables


def _sender_time(received: np.ndarray, columns: dict[str, np.ndarray]) -> np.ndarray:
    """The sender's clock on the receiver's: shifted by the smallest delay, which is that of an idle link."""
    for name, unit in _SENDER_CLOCKS.items():
        clock = columns.get(name)
        if clock is not None and np.all(np.diff(clock) >= 0) and clock[-1] > clock[0]:
            return clock * unit + float(np.min(received - clock * unit))
    return received
