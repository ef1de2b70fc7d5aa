"""One estimator fed sample by sample: warm-up, window, carried information, recursive filter."""

from seatrial.estimation.identify.online.estimator import OnlineEstimator

__all__ = ["OnlineEstimator"]
