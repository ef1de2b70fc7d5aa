"""Programmes with their helmsmen, the measures of a manoeuvre, and the criteria they are held against."""

from seatrial.manoeuvres.programme import Programme, programme
from seatrial.manoeuvres.steering import Steering

__all__ = ["Programme", "Steering", "programme"]
