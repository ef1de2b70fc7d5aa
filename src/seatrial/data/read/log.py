"""What every reader returns: the topics of a log as tables of cells, before anything is known about them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np

from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.data.read.raw_table import RawTable


@dataclass(frozen=True)
class LogEvent:
    """Something that happened at a time [s on the clock of the log], such as ``MODE MANUAL``."""

    time: float
    name: str


@dataclass(frozen=True)
class Log:
    """The contents of one file.

    Attributes:
        file: file name for messages.
        tables: one for each topic (message, sheet, group); a plain table is the only one and has no topic.
        parameters: settings that the logger stored, such as ``SERVO1_REVERSED``.
        events: in order of time.
    """

    file: str
    tables: tuple[RawTable, ...]
    parameters: Mapping[str, float] = field(default_factory=dict)
    events: tuple[LogEvent, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        if not self.tables:
            raise InputError(f"{self.file} holds no samples; leave it out or replace it")

    def __reduce__(self) -> tuple[type["Log"], tuple]:
        return type(self), (self.file, self.tables, dict(self.parameters), self.events)

    @classmethod
    def of_table(cls, table: RawTable) -> "Log":
        """Return the log that consists of one table."""
        return cls(table.file, (table,))

    @property
    def topics(self) -> tuple[str, ...]:
        """Names of the topics, in the order of the file."""
        return tuple(table.topic for table in self.tables)

    def table_of(self, column: ColumnSpec) -> RawTable:
        """Return the table in which a wanted column stands; `source` is ``topic/field``, or the name in a plain table.

        Raises:
            InputError: there is no such topic; the nearest one is named.
        """
        if len(self.tables) == 1 and (isinstance(column.source, int) or column.source in self.tables[0].names):
            return self.tables[0]
        for table in self.tables:
            name = str(column.source).removeprefix(f"{table.topic}/")
            if name != column.source and name in table.names:  # a name may hold a stroke itself, as in "ROT [deg/min]"
                return table
        topic = str(column.source).rpartition("/")[0]
        if topic not in self.topics:
            if self.topics == ("",):
                return self.tables[0]
            where = f"topic '{topic}'" if topic else f"topic in '{column.source}', which should read 'topic/field'"
            raise InputError(
                f"{self.file}: channel '{column.symbol}': no {where}{spelling_hint(topic, list(self.topics))}"
            )
        return self.tables[self.topics.index(topic)]


Reader = Callable[[Path, Layout], Log]


def topic_table(
    file: str, topic: str, columns: Mapping[str, Sequence | Array], units: Mapping[str, str] | None = None
) -> RawTable:
    """Return the table of a topic whose column ``time`` holds seconds; units as the file states them."""
    known = {"time": "s", **(units or {})}
    return RawTable(
        file,
        tuple(columns),
        tuple(np.asarray(values) for values in columns.values()),
        topic=topic,
        units=tuple(known.get(name, "") for name in columns),
        time_name="time" if "time" in columns else "",
    )
