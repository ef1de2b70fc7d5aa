"""Meng et al. 2014: cloud particle swarm for heave and pitch with a fin, repeated with what is not printed assumed."""

from seatrial_studies.meng2014.study import study

__all__ = ["study"]
