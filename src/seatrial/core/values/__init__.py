"""The nouns everybody knows: records, channels, parameters, ships, findings, units, notation."""

from seatrial.core.values.arrays import Array, Index, frozen
from seatrial.core.values.errors import DivergedError, InputError, nearest
from seatrial.core.values.finding import Finding, Severity
from seatrial.core.values.force_points import ForcePoints, Includes
from seatrial.core.values.notation import NOTATION, Quantity, quantity
from seatrial.core.values.parameters import Parameter, Parameters, Prior
from seatrial.core.values.progress import Progress
from seatrial.core.values.record import Channel, Kind, Provenance, Record
from seatrial.core.values.ship import Ship
from seatrial.core.values.units import display, si

__all__ = [
    "NOTATION",
    "Array",
    "Channel",
    "DivergedError",
    "Finding",
    "ForcePoints",
    "Includes",
    "Index",
    "InputError",
    "Kind",
    "Parameter",
    "Parameters",
    "Prior",
    "Progress",
    "Provenance",
    "Quantity",
    "Record",
    "Severity",
    "Ship",
    "display",
    "frozen",
    "nearest",
    "quantity",
    "si",
]
