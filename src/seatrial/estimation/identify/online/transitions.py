"""Where a phase leads: from a full window to a filter, or else to carried information."""

import numpy as np

from seatrial.core.values import InputError
from seatrial.data.trial.settings import Stream
from seatrial.estimation.estimate.online.change_detection import ChangeDetector
from seatrial.estimation.estimate.online.window import WindowEstimate
from seatrial.estimation.identify.online.phases import Carried, KeptPhase, WarmUp, Window
from seatrial.estimation.identify.online.recursive_phase import RecursivePhase
from seatrial.estimation.identify.online.schedule import SearchIntervals


def is_window_full(phase: KeptPhase, seconds: float, stream: Stream, intervals: SearchIntervals) -> bool:
    """Return whether a phase with `seconds` s of samples in its window is to be left; never before an estimate."""
    window = min(stream.batch_window_s, stream.forgetting_time_s or np.inf)
    match phase:
        case WarmUp():
            return False
        case Window():
            return seconds >= window
        case Carried():
            return seconds >= min(intervals.stretch(window), window)


def filter_phase(
    estimate: WindowEstimate, stream: Stream, reference_point: float, change_detector: ChangeDetector
) -> RecursivePhase | None:
    """Return the filter that goes on behind the estimate; None where it cannot take over."""
    try:
        return RecursivePhase(estimate, stream, reference_point, change_detector)
    except InputError:
        return None


def carried_phase(phase: Window | Carried, seconds: float, stream: Stream, *, is_efficient: bool) -> Carried:
    """Return the phase that carries the information of a window of `seconds` s.

    Forgetting reduces that information; so do correlated residuals where the search is efficient (the others state
    their covariance with them).
    """
    carried = phase.carried()
    if is_efficient and phase.estimate.estimate.problem.inflation is None:
        carried = carried.discounted(1.0 / max(float(np.max(phase.estimate.inflation)), 1.0))
    if stream.forgetting_time_s is not None:
        carried = carried.discounted(float(np.exp(-seconds / stream.forgetting_time_s)))
    return carried
