"""Records, channels, parameters, ships, findings, units and notation, as immutable values."""

from seatrial.core.values.arrays import Array, Index, frozen
from seatrial.core.values.channel import Channel, Provenance
from seatrial.core.values.errors import DivergedError, InputError, ProgressReporter, spelling_hint
from seatrial.core.values.finding import Finding, Severity, TrialEdit, finding_kinds, worst_first
from seatrial.core.values.notation import NOTATION, Quantity, channel_hint, display_unit, quantity, si_unit
from seatrial.core.values.parameters import NOT_MEASURED, Parameter, Parameters, Prior
from seatrial.core.values.record import Record, RecordKind
from seatrial.core.values.ship import ForceContent, ForcePoints, Ship
from seatrial.core.values.versions import versions

__all__ = [
    "NOTATION", "NOT_MEASURED", "Array", "Channel", "DivergedError", "Finding", "ForceContent", "ForcePoints",
    "Index", "InputError", "Parameter", "Parameters", "Prior", "ProgressReporter", "Provenance", "Quantity",
    "Record", "RecordKind", "Severity", "Ship", "TrialEdit", "channel_hint", "display_unit", "finding_kinds",
    "frozen", "quantity", "si_unit", "spelling_hint", "versions", "worst_first",
]  # fmt: skip
