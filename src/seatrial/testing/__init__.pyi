from seatrial.testing.conformance import ConformanceError
from seatrial.testing.estimator import check_estimator
from seatrial.testing.model import check_model
from seatrial.testing.model_points import MirrorLaw
from seatrial.testing.optimiser import check_optimiser
from seatrial.testing.reader import check_reader

__all__ = ["ConformanceError", "MirrorLaw", "check_estimator", "check_model", "check_optimiser", "check_reader"]
