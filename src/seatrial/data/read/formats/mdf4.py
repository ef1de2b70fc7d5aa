"""ASAM MDF files (.mf4, .mdf, .dat of version 3), by asammdf from the extra `logs`."""

from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, RawTable, fault_text, require_library, topic_table


def read_mdf4(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Every channel group as a topic, by its acquisition name or its number; ``time`` is its master channel.

    Raises:
        InputError: asammdf is not installed, or not a readable MDF file.
    """
    asammdf = require_library("asammdf", path.name, "an MDF file", "logs")
    try:
        with asammdf.MDF(path) as file:
            names = _group_names(file)
            tables = [
                table for k in range(len(file.groups)) if (table := _table(path.name, file, k, names[k])) is not None
            ]
    except Exception as error:  # asammdf raises its own, struct, key and value errors on damaged files
        raise InputError(f"{path.name} is not a readable MDF file ({fault_text(error)}); save it again") from None
    return Log(path.name, tuple(tables))


def _group_names(file: Any) -> list[str]:
    names = [getattr(group.channel_group, "acq_name", None) or f"group {k}" for k, group in enumerate(file.groups)]
    return [name if names.count(name) == 1 else f"{name}[{k}]" for k, name in enumerate(names)]


def _table(file_name: str, file: Any, number: int, topic: str) -> RawTable | None:
    master = file.get_master(number)
    columns, units = {"time": np.asarray(master, dtype=float)}, {}
    for index, channel in enumerate(file.groups[number].channels):
        if index == file.masters_db.get(number):
            continue
        signal = file.get(group=number, index=index)
        if signal.samples.dtype.kind in "fiu" and signal.samples.ndim == 1:
            columns[channel.name] = np.asarray(signal.samples, dtype=float)
            units[channel.name] = str(signal.unit or "")
    return topic_table(file_name, topic, columns, units) if len(columns) > 1 and len(master) else None
