"""The nouns everybody knows: records, channels, parameters, ships, findings, units, notation."""

from seatrial.values.arrays import Array, Index, frozen
from seatrial.values.errors import DivergedError, InputError, nearest
from seatrial.values.finding import Finding, Severity
from seatrial.values.force_points import ForcePoints, Includes
from seatrial.values.notation import NOTATION, Quantity, quantity
from seatrial.values.parameters import Parameter, Parameters, Prior
from seatrial.values.progress import Progress
from seatrial.values.record import Channel, Kind, Provenance, Record
from seatrial.values.ship import Ship
from seatrial.values.units import display, si

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
