"""One estimator fed sample by sample: warm-up, window, carried information, recursive filter; or a published search."""

from seatrial.estimation.identify.online.estimator import OnlineEstimator, stream_run
from seatrial.estimation.identify.online.search_follower import SearchFollower, own_trial

__all__ = ["OnlineEstimator", "SearchFollower", "own_trial", "stream_run"]
