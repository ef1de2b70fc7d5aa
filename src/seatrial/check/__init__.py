"""Findings on records: judges declared conventions against the data, repairs, converts; refuses to guess."""

from seatrial.check.conventions import canonical
from seatrial.check.examine import examine, prepared
from seatrial.check.mend import parts, repair
from seatrial.check.rudder import is_excited
from seatrial.check.stamps import timebase

__all__ = ["canonical", "examine", "is_excited", "parts", "prepared", "repair", "timebase"]
