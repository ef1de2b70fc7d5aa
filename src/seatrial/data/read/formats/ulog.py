"""PX4 ULog files, by pyulog from the extra `logs`."""

from collections import Counter
from pathlib import Path

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, LogEvent, fault_text, require_library, topic_table

_MICRO = 1e-6  # s, of a microsecond


def read_ulog(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Every message as a topic, ``name[k]`` where it has several instances; ``time`` is s since the start of PX4.

    Changes of the navigation state are events, stored parameters are kept.

    Raises:
        InputError: pyulog is not installed, or not a readable ULog file.
    """
    pyulog = require_library("pyulog", path.name, "a PX4 ULog file", "logs")
    try:
        log = pyulog.ULog(str(path))
    except Exception as error:  # pyulog raises struct, index, key and type errors on damaged files
        raise InputError(f"{path.name} is not a readable ULog file ({fault_text(error)}); download it again") from None
    instances = Counter(data.name for data in log.data_list)
    tables, events = [], []
    for data in log.data_list:
        topic = data.name if instances[data.name] == 1 else f"{data.name}[{data.multi_id}]"
        stamps = np.asarray(data.data["timestamp"], dtype=np.float64) * _MICRO
        fields = {name: values for name, values in data.data.items() if name != "timestamp"}
        tables.append(topic_table(path.name, topic, {"time": stamps, **fields}))
        if data.name == "vehicle_status" and "nav_state" in fields:
            events += _changes(stamps, fields["nav_state"])
    parameters = {name: float(value) for name, value in log.initial_parameters.items()}
    return Log(path.name, tuple(tables), parameters, tuple(events))


def _changes(stamps: np.ndarray, states: np.ndarray) -> list[LogEvent]:
    rows = np.flatnonzero(np.diff(states, prepend=states[0] - 1 if len(states) else 0))
    return [LogEvent(float(stamps[row]), f"nav_state {int(states[row])}") for row in rows]
