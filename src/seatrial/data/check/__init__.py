"""Findings on records: judges declared conventions against the data, repairs, converts; refuses to guess."""

from seatrial.data.check.conventions import canonical
from seatrial.data.check.examine import examine, prepared
from seatrial.data.check.mend import parts, repair
from seatrial.data.check.rudder import is_excited
from seatrial.data.check.stamps import timebase

__all__ = ["canonical", "examine", "is_excited", "parts", "prepared", "repair", "timebase"]
