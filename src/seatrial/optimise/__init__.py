"""Optimisers that know no ship."""

from seatrial.optimise.least_squares import LeastSquares, Normal, Optimum, levenberg_marquardt
from seatrial.optimise.solution import Solution, Status

__all__ = ["LeastSquares", "Normal", "Optimum", "Solution", "Status", "levenberg_marquardt"]
