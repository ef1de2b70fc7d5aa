"""Programmes with their helmsmen, the measures of a manoeuvre, and the criteria they are held against.

`programme` is in a file apart, `seatrial.physics.manoeuvres.programme`, because importing it compiles its helmsmen.
"""

from seatrial.physics.manoeuvres.imo import Criterion, criteria
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.manoeuvres.observed import Manoeuvre, recognise

__all__ = ["Criterion", "Manoeuvre", "criteria", "measures", "recognise"]
