"""Changes of an ordered output in a log, and what weather did to the ship while the order stood still."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.control.task import Demand
from seatrial.core.values import Array, InputError, Record
from seatrial.core.values.notation import channel_unit
from seatrial.physics.loops import TransferLoop

_SMALLEST = 0.1  # of the demand's change, below which an order is no change but a correction; chosen
_SHORTEST = 6.0  # time constants that a change must last; chosen
_STILL = 1e-6  # of the demand's change from one sample to the next: rounding of a logger


@dataclass(frozen=True, eq=False)
class LoggedChange:
    """One change, from the last sample before it to the last before the next one.

    Order and output are counted from the order before, the actuator from its mean over the second halves of a record.

    Attributes:
        start: s on the record's clock; order, output, actuator: (n,), SI.
        trim: of the actuator, taken off.
        is_step: whether the order jumped; else the log holds what a filter made of it.
    """

    record: str
    start: float
    dt: float
    order: Array
    output: Array
    actuator: Array
    trim: float
    is_step: bool

    @property
    def change(self) -> float:
        """Return by how much the order changed, SI."""
        return float(self.order[-1])

    @property
    def demand(self) -> Array:
        """Return the change as a step at the second sample, (n,)."""
        return np.concatenate([[0.0], np.full(len(self.order) - 1, self.change)])

    def background(self, settled_s: float) -> Array:
        """Return the output about its order and the actuator from so many seconds after the order on, (m, 2)."""
        return np.stack([self.output - self.change, self.actuator], axis=1)[round(settled_s / self.dt) :]


def logged_changes(records: Sequence[Record], loop: TransferLoop, demand: Demand) -> tuple[LoggedChange, ...]:
    """Return the changes of the ordered output that are large and long enough.

    Raises:
        InputError: a channel is missing or has gaps, or there is no such change.
    """
    ordered = f"{loop.output}_ref"
    channels = (loop.output, loop.actuator, ordered)
    changes = []
    for record in records:
        if missing := [name for name in channels if name not in record]:
            raise InputError(
                f"record '{record.name}' has no channel '{missing[0]}'; changes of '{loop.output}' are verified by "
                f"{', '.join(channels)}: name their columns in [records.channels]"
            )
        if not np.all(np.isfinite(record.matrix(channels))):
            raise InputError(f"record '{record.name}' has gaps in {', '.join(channels)}; repair them, or cut it there")
        changes += _changes_of_record(record, channels, demand)
    if not changes:
        raise InputError(
            f"the log holds no change of '{ordered}' by {_SMALLEST:g} of that of [demand] or more that lasts "
            f"{_SHORTEST * demand.time_constant:.0f} s, {_SHORTEST:g} time constants; log course changes one by one"
        )
    return tuple(changes)


def _changes_of_record(record: Record, channels: tuple[str, str, str], demand: Demand) -> list[LoggedChange]:
    output, actuator, order = (record[name] for name in channels)
    if channel_unit(channels[0]) == "rad":
        output, order = np.unwrap(output), np.unwrap(order)
    moves = np.flatnonzero(np.abs(np.diff(order)) > _STILL * abs(demand.change))
    if not moves.size:
        return []
    apart = np.flatnonzero(np.diff(moves) * record.dt > demand.time_constant)
    firsts = moves[np.concatenate([[0], apart + 1])].tolist()
    lasts = moves[np.concatenate([apart, [len(moves) - 1]])].tolist()
    spans = [
        (first, stop, moved == first)
        for first, moved, stop in zip(firsts, lasts, [*firsts[1:], len(order) - 1], strict=True)
        if abs(order[stop] - order[first]) >= _SMALLEST * abs(demand.change)
        and (stop - first) * record.dt >= _SHORTEST * demand.time_constant
    ]
    if not spans:
        return []
    trim = float(np.mean(np.concatenate([actuator[(first + stop) // 2 : stop + 1] for first, stop, _ in spans])))
    return [
        LoggedChange(
            record.name, float(record.time[first]), record.dt, order[first : stop + 1] - order[first],
            output[first : stop + 1] - order[first], actuator[first : stop + 1] - trim, trim, is_step,
        )
        for first, stop, is_step in spans
    ]  # fmt: skip
