"""Standard manoeuvres, their measures, and the IMO criteria.

`programme` is in a file apart, `seatrial.physics.manoeuvres.programme`, because importing it compiles its helmsmen.
"""

from seatrial.physics.manoeuvres.imo import ImoCriterion, imo_criteria
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, recognise_manoeuvre

__all__ = ["ImoCriterion", "ManoeuvreKind", "imo_criteria", "measures", "recognise_manoeuvre"]
