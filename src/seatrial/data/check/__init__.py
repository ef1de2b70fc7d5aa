"""Findings on records: declared conventions compared with the data, repairs; refuses to guess."""

from seatrial.data.check.conventions import canonical_record, with_standard_signs
from seatrial.data.check.examine import ExaminedRecord, examine, examined_record
from seatrial.data.check.repair import repair
from seatrial.data.check.rudder import is_excited
from seatrial.data.check.signal import sample_noise
from seatrial.data.check.thrusters import refuse_impossible_commands
from seatrial.data.check.timestamps import rebuild_time_base

__all__ = [
    "ExaminedRecord", "canonical_record", "examine", "examined_record", "is_excited",
    "rebuild_time_base", "refuse_impossible_commands", "repair", "sample_noise", "with_standard_signs",
]  # fmt: skip
