"""One record repaired and checked, in one pass."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Finding, Record
from seatrial.core.values.arrays import unwrapped
from seatrial.data.check.approach_phase import approach_findings
from seatrial.data.check.channels import channel_findings, lag_findings
from seatrial.data.check.comparison_stretch import comparison_stretch
from seatrial.data.check.consequences import completed
from seatrial.data.check.conventions import with_standard_signs
from seatrial.data.check.drift_side import drift_side_findings
from seatrial.data.check.dropped_rows import dropped_rows_findings
from seatrial.data.check.feedback import feedback_findings
from seatrial.data.check.kinematic_consistency import kinematic_consistency_findings
from seatrial.data.check.lost_samples import read_stretch
from seatrial.data.check.motion import recorded_motion
from seatrial.data.check.possible_sizes import require_possible_sizes
from seatrial.data.check.repair import repaired_parts
from seatrial.data.check.resting_level import resting_level_findings
from seatrial.data.check.rudder import rudder_findings
from seatrial.data.check.run_phases import phase_findings
from seatrial.data.check.sentinels import without_sentinels
from seatrial.data.check.stepped_inputs import integration_step_findings, stepped_input_findings
from seatrial.data.check.timestamps import rebuild_time_base
from seatrial.data.check.velocity_conventions import velocity_convention_findings
from seatrial.data.check.yaw_rate_consistency import yaw_rate_findings
from seatrial.data.held_readings import slower_channels


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


def _comparison_findings(record: Record) -> list[Finding]:
    """What channels say of one another, of a complete record with standard signs."""
    motion = recorded_motion(record)
    return [
        *(() if motion is None else velocity_convention_findings(motion)),
        *(() if motion is None else kinematic_consistency_findings(motion)),
        *(() if motion is None else drift_side_findings(motion)),
        *yaw_rate_findings(record),
        *rudder_findings(record),
        *lag_findings(record, motion),
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
