"""Yu et al. 2014: three gains of a fin stabiliser by a genetic algorithm."""

from seatrial.studies.yu2014.study import study

__all__ = ["study"]
