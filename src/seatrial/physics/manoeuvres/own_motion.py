"""Motion of the craft itself in a record that was simulated by a model with sensors."""

from dataclasses import replace

from seatrial.core.values import Record

TRUE = "_true"
"""Ending of a state's channel where an instrument shows another one: at the antenna, turned by the compass, late."""


def own_motion(record: Record) -> Record:
    """Return the record with its true motion in place of what instruments show; as it is where it has none."""
    own = {name.removesuffix(TRUE): c for name, c in record.channels.items() if name.endswith(TRUE)}
    return replace(record, channels=dict(record.channels) | own) if own else record
