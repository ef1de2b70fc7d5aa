"""Programmes with their helmsmen, the measures of a manoeuvre, and the criteria they are held against."""

from seatrial.manoeuvres.imo import Criterion, criteria
from seatrial.manoeuvres.measures import measures
from seatrial.manoeuvres.observed import Manoeuvre, recognise
from seatrial.manoeuvres.programme import Programme, programme
from seatrial.manoeuvres.steering import Steering

__all__ = ["Criterion", "Manoeuvre", "Programme", "Steering", "criteria", "measures", "programme", "recognise"]
