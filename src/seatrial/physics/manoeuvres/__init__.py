"""Programmes with their helmsmen, the measures of a manoeuvre, and the criteria they are held against.

`programme` is in a file apart, `seatrial.physics.manoeuvres.programme`, because importing it compiles its helmsmen.
"""

from seatrial.physics.manoeuvres.imo import ImoCriterion, imo_criteria
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, recognise_manoeuvre

__all__ = ["ImoCriterion", "ManoeuvreKind", "imo_criteria", "measures", "recognise_manoeuvre"]
