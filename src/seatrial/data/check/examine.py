"""One record repaired and checked, in one pass; runs that are copies of one another."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Finding, Record
from seatrial.core.values.arrays import unwrapped
from seatrial.data.check.channels import channel_findings, lag_findings, require_possible_sizes, resting_level_findings
from seatrial.data.check.consequences import completed
from seatrial.data.check.consistency import kinematic_consistency_findings
from seatrial.data.check.conventions import drift_side_findings, statement_findings, with_standard_signs
from seatrial.data.check.inputs import (
    excitation_findings,
    feedback_findings,
    integration_step_findings,
    stepped_input_findings,
)
from seatrial.data.check.motion import recorded_motion
from seatrial.data.check.phases import approach_findings, comparison_stretch, phase_findings
from seatrial.data.check.repair import dropped_rows_findings, repaired_parts, without_sentinels
from seatrial.data.check.time_base import read_stretch, rebuild_time_base
from seatrial.data.held_readings import slower_channels

# Runs that are copies of one another: a run counts once, however often it is in the files.


def copies(records: Sequence[Record]) -> dict[int, int]:
    """Return the index of each record that repeats an earlier one, sample by sample -> the index of that one.

    Times count from the first sample; the names of the records do not matter.
    """
    earlier: dict[tuple[object, ...], int] = {}
    repeated = {}
    for index, record in enumerate(records):
        first = earlier.setdefault(_content(record), index)
        if first != index:
            repeated[index] = first
    return repeated


def _content(record: Record) -> tuple[object, ...]:
    time = np.round((record.time - record.time[0]) / record.dt) if record.is_uniform else record.time
    channels = tuple((s, record[s].tobytes()) for s in sorted(record.channels))
    return (time.tobytes(), round(record.duration, _DECIMALS), channels)


_DECIMALS = 6  # of seconds, to which durations are compared; chosen


# One record repaired and checked, in one pass.


@dataclass(frozen=True, eq=False)
class ExaminedRecord:
    """A record repaired once, and all that was found on the way.

    Attributes:
        parts: evenly sampled, complete between holes longer than the craft's memory, conventions as declared.
        findings: of the checks and of the repairs, most harmful first.
    """

    parts: tuple[Record, ...]
    findings: tuple[Finding, ...]

    @property
    def record(self) -> Record:
        """The longest part."""
        return max(self.parts, key=len)


def examined_record(record: Record) -> ExaminedRecord:
    """Repair a record as it was read and check it.

    The declared conventions are judged, never changed: ERROR where the data contradict them clearly, WARNING where
    they may.

    Raises:
        InputError: a channel holds no value or one of no possible size, too few samples remain, or a positive direction
            is unknown.
    """
    read, sentinel_findings = without_sentinels(record)
    require_possible_sizes(read)
    even, time_findings = rebuild_time_base(without_repeats(read))
    parts, repair_findings = repaired_parts(even)
    complete = max(parts, key=len)
    findings = [
        *sentinel_findings, *channel_findings(read), *time_findings, *repair_findings,
        *dropped_rows_findings(read, parts),
        *_comparison_findings(comparison_stretch(with_standard_signs(read_stretch(complete)))),
    ]  # fmt: skip
    return ExaminedRecord(parts, tuple(completed(findings, record)))


def without_repeats(record: Record) -> Record:
    """Return a record as it was read in which the repeated readings of slower channels are empty."""
    cells = {
        symbol: unwrapped(channel.values) if channel.unit == "rad" else channel.values
        for symbol, channel in record.channels.items()
        if not channel.is_command
    }
    channels = {
        symbol: record.channel(symbol).with_values(np.where(mask, record[symbol], np.nan))
        for symbol, mask in slower_channels(cells, record.time).items()
    }
    return replace(record, channels={**record.channels, **channels})


_MOTION = frozenset({"x0", "y0", "u", "v", "psi"})


def _comparison_findings(record: Record) -> list[Finding]:
    """What channels say of one another, of a complete record with standard signs."""
    statements, refuted = statement_findings(record)
    motion = None if refuted & _MOTION else recorded_motion(record)
    return [
        *statements,
        *(() if motion is None else kinematic_consistency_findings(motion)),
        *(() if motion is None else drift_side_findings(motion)),
        *excitation_findings(record),
        *lag_findings(record),
        *phase_findings(record),
        *approach_findings(record),
        *feedback_findings(record),
        *resting_level_findings(record),
        *stepped_input_findings(record),
        *integration_step_findings(record),
    ]


def examine(record: Record) -> tuple[Finding, ...]:
    """Return what `examined_record` finds.

    Raises:
        InputError: as `examined_record`.
    """
    return examined_record(record).findings
