"""Yu et al. 2014: three gains of a fin stabiliser by a genetic algorithm."""

from seatrial_studies.yu2014.study import study

__all__ = ["study"]
