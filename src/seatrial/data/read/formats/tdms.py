"""LabVIEW TDMS files, by npTDMS from the extra `logs`."""

from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, fault_text, require_library, topic_table


def read_tdms(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Every group as a topic (``group#rows`` where its channels differ in length); ``time`` [s] from the wave form.

    Raises:
        InputError: npTDMS is not installed, or not a readable TDMS file.
    """
    nptdms = require_library("nptdms", path.name, "a TDMS file", "logs")
    try:
        file = nptdms.TdmsFile.read(path)
        tables = [table for group in file.groups() for table in _tables(path.name, group)]
    except Exception as error:  # npTDMS raises struct, key, index and value errors on damaged files
        raise InputError(f"{path.name} is not a readable TDMS file ({fault_text(error)}); save it again") from None
    return Log(path.name, tuple(tables))


def _tables(file: str, group: Any) -> list[RawTable]:
    channels = [channel for channel in group.channels() if len(channel)]
    lengths = sorted({len(channel) for channel in channels})
    tables = []
    for length in lengths:
        alike = [channel for channel in channels if len(channel) == length]
        columns, units = {}, {}
        clock = next((c for c in alike if "wf_increment" in c.properties), None)
        if clock is not None:
            columns["time"] = clock.time_track()
        for channel in alike:
            values = channel[:]
            if values.dtype.kind == "M":
                columns[channel.name] = values.astype("datetime64[ns]").astype(np.int64) * 1e-9  # s, of a nanosecond
                units[channel.name] = "s"
            elif values.dtype.kind in "fiu":
                columns[channel.name] = np.asarray(values, dtype=float)
                units[channel.name] = str(channel.properties.get("unit_string", ""))
        if columns:
            topic = group.name if len(lengths) == 1 else f"{group.name}#{length}"
            tables.append(topic_table(file, topic, columns, units))
    return tables
