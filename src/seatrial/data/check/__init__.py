"""Findings on records: declared conventions compared with the data, repairs; refuses to guess."""

from seatrial.data.check.conventions import canonical_record, with_standard_signs
from seatrial.data.check.examine import ExaminedRecord, examine, examined_record
from seatrial.data.check.inputs import is_excited, refuse_impossible_commands
from seatrial.data.check.motion import sample_noise
from seatrial.data.check.repair import repair
from seatrial.data.check.time_base import rebuild_time_base

__all__ = [
    "ExaminedRecord", "canonical_record", "examine", "examined_record", "is_excited",
    "rebuild_time_base", "refuse_impossible_commands", "repair", "sample_noise", "with_standard_signs",
]  # fmt: skip
