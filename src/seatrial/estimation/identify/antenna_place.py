"""A warning where the sway velocity is missed in step with the yaw rate, as if it were measured at another place."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.results import Prediction
from seatrial.core.text.numbers import percent, significant
from seatrial.core.values import Finding, Severity

# share of the difference's square that a place explains, its distance over the length, and the difference over the
# motion, from which on it is named; chosen: less is what a model of sway misses
_LEAST_SHARE, _LEAST_DISTANCE, _LEAST_ERROR = 0.6, 0.05, 0.25


def antenna_findings(predictions: Sequence[Prediction], length: float) -> tuple[Finding, ...]:
    """Return a warning `antenna-place` with the place at which the recorded sway would be that of the model.

    Held-out runs decide where there are any: a fit takes the place for sway in the runs that it is fitted to. A
    receiver x forward of the origin moves sideways with v + x r (Fossen 2021, section 2.2). length: of the craft [m].
    """
    held = [p for p in predictions if p.role == "validation"]
    runs = [p for p in held or predictions if p.divergence is None and all("v" in r for r in (p.measured, p.simulated))]
    runs = [p for p in runs if "r" in p.measured]
    if not runs or not length > 0.0:
        return ()
    samples = np.concatenate([(p.measured["v"] - p.simulated["v"], p.measured["r"], p.measured["v"]) for p in runs], 1)
    difference, rate, sway = samples[:, np.isfinite(samples).all(axis=0)]
    power = float(difference @ difference)
    if not power > (_LEAST_ERROR**2) * float(sway @ sway) or not float(rate @ rate) > 0.0:
        return ()
    place = float(difference @ rate) / float(rate @ rate)
    share = 1.0 - float(np.sum((difference - place * rate) ** 2)) / power
    if share < _LEAST_SHARE or abs(place) < _LEAST_DISTANCE * length:
        return ()
    side = "forward" if place > 0.0 else "aft"
    return (Finding(
        Severity.WARNING, "antenna-place", f"the recorded sway velocity differs from the model's in step with the yaw "
        f"rate, as if it were measured {significant(abs(place), 2)} m {side} of where the file says",
        f"this would explain {percent(share)} % of the difference", "state where the antenna stands, antenna = "
        "{ x = ..., y = ... } under [[records]], in m forward of midship and to starboard; where it stands as stated, "
        "the model's sway is wrong: free more of its terms",
        "drift angles, and the coefficients of sway, count on it",
    ),)  # fmt: skip
