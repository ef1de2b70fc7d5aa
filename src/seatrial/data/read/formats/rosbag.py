"""ROS 1 bags and ROS 2 bags (mcap, db3), by rosbags from the extra `logs`."""

from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log, fault_text, require_library, topic_table

# numbers of an array field that become columns of their own; ours, so that covariances and images do not
_LARGEST_ARRAY = 16
_NANO = 1e-9  # s, of a nanosecond


def read_rosbag(path: Path, layout: Layout) -> Log:  # noqa: ARG001
    """Every topic with numbers: a column for each number of a message, named by its path (``pose.position.x``).

    ``time`` is the stamp of the message's header where it has one, else the time at which it was recorded.

    Raises:
        InputError: rosbags is not installed, or not a readable bag.
    """
    highlevel = require_library("rosbags.highlevel", path.name, "a ROS bag", "logs")
    typesys = require_library("rosbags.typesys", path.name, "a ROS bag", "logs")
    store = typesys.Stores.ROS1_NOETIC if path.suffix == ".bag" else typesys.Stores.ROS2_HUMBLE
    samples: dict[str, tuple[list[str], list[tuple]]] = {}
    try:
        with highlevel.AnyReader([path], default_typestore=typesys.get_typestore(store)) as bag:
            getters: dict[str, _Getter | None] = {}
            for connection, recorded, data in bag.messages():
                topic = connection.topic
                if topic in getters and getters[topic] is None:
                    continue
                message = bag.deserialize(data, connection.msgtype)
                if topic not in getters:
                    getters[topic] = getter = _Getter.for_messages_like(message)
                    if getter is None:
                        continue
                    samples[topic] = (getter.names, [])
                getter = getters[topic]
                assert getter is not None
                samples[topic][1].append((recorded * _NANO, *getter(message)))
    except InputError:
        raise
    except Exception as error:  # rosbags and its decompressors raise a dozen unrelated types on damaged bags
        raise InputError(
            f"{path.name} is not a readable ROS bag ({fault_text(error)}); repair it with 'rosbag reindex' "
            "or 'ros2 bag reindex', or record it again"
        ) from None
    return Log(path.name, tuple(_table(path.name, topic, names, rows) for topic, (names, rows) in samples.items()))


class _Getter:
    """Takes the numbers out of messages of one type."""

    def __init__(self, names: list[str], paths: list[str], arrays: dict[str, int]) -> None:
        self.names = names
        self._arrays = [(attrgetter(path), count) for path, count in arrays.items()]
        self._numbers = attrgetter(*paths) if paths else None
        self._is_single = len(paths) == 1

    @classmethod
    def for_messages_like(cls, message: Any) -> "_Getter | None":
        """Return the getter for messages like this one; None where it holds no number."""
        paths, arrays = [], {}
        for path, value in _leaves(message, ""):
            if isinstance(value, np.ndarray):
                if value.dtype.kind in "fiub" and 0 < value.size <= _LARGEST_ARRAY:
                    arrays[path] = value.size
            elif isinstance(value, bool | int | float):
                paths.append(path)
        names = [*paths, *(f"{path}[{k}]" for path, count in arrays.items() for k in range(count))]
        return cls(names, paths, arrays) if names else None

    def __call__(self, message: Any) -> tuple:
        """Return the numbers, in the order of `names`."""
        values: list = []
        if self._numbers is not None:
            values += [self._numbers(message)] if self._is_single else self._numbers(message)
        for array, count in self._arrays:
            numbers = array(message)
            values += numbers.tolist() if numbers.size == count else [np.nan] * count
        return tuple(values)


def _leaves(message: Any, prefix: str) -> Iterator[tuple[str, Any]]:
    for name in getattr(message, "__dataclass_fields__", {}):
        if name.startswith("__"):
            continue
        value = getattr(message, name)
        if hasattr(value, "__dataclass_fields__"):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _table(file: str, topic: str, names: list[str], rows: list[tuple]) -> Any:
    numbers = np.array(rows, dtype=np.float64)
    columns = dict(zip(["time", *names], numbers.T, strict=True))
    seconds, nanoseconds = (columns.pop(f"header.stamp.{part}", None) for part in ("sec", "nanosec"))
    if seconds is not None and nanoseconds is not None and np.all(seconds > 0):
        columns["time"] = seconds + nanoseconds * _NANO
    return topic_table(file, topic, columns)
