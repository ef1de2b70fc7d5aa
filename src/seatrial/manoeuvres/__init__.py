"""Programmes with their helmsmen, the measures of a manoeuvre, and the criteria they are held against.

`programme` is in `seatrial.manoeuvres.programme`, apart because its helmsmen are compiled when they are imported.
"""

from seatrial.manoeuvres.imo import Criterion, criteria
from seatrial.manoeuvres.measures import measures
from seatrial.manoeuvres.observed import Manoeuvre, recognise

__all__ = ["Criterion", "Manoeuvre", "criteria", "measures", "recognise"]
