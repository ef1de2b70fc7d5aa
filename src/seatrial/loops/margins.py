"""How near a loop is to instability, at its own gains."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from seatrial.loops.loop import TransferLoop
from seatrial.values import Array

_SAMPLES = 2000


@dataclass(frozen=True)
class Margins:
    """Of one loop.

    Attributes:
        is_stable: all closed-loop poles lie left of the axis; peak: Ms, the largest |S|, infinite if unstable;
        peak_at: rad/s; gain: the factor the loop gain may grow by, infinite if any; phase: rad, infinite if the loop
        gain never crosses one; delay: s of dead time that it bears.
        damping: the least damping ratio of a closed-loop pole.
    """

    is_stable: bool
    peak: float
    peak_at: float
    gain: float
    phase: float
    delay: float
    damping: float


def band(loop: TransferLoop) -> tuple[float, float]:
    """Frequencies [rad/s] between which everything of the loop happens: a decade about all poles and zeros."""
    d, n = loop.polynomials
    roots = np.abs(np.concatenate([np.roots(d), *(np.roots(row) for row in n)]))
    some = roots[roots > 1e-6]
    return (0.3 * float(some.min()), 2.0 * float(some.max())) if some.size else (1e-2, 1e2)


def sensitivity(loop: TransferLoop, omega: Array) -> Array:
    """|S| of the loop at omega [rad/s], (n,)."""
    return 1.0 / np.abs(1.0 + loop.open(omega))


def margins(loop: TransferLoop) -> Margins:
    """The margins at the loop's gains; Ms to rounding, by a search about the largest sample."""
    import control

    poles = loop.closed_poles
    damping = float(np.min(-poles.real / np.maximum(np.abs(poles), 1e-300)))
    if not np.all(poles.real < 0.0):
        return Margins(False, math.inf, math.nan, math.nan, math.nan, math.nan, damping)
    low, high = band(loop)
    u = np.linspace(math.log(low), math.log(high), _SAMPLES)
    place = int(np.argmax(sensitivity(loop, np.exp(u))))
    ends = u[max(place - 1, 0)], u[min(place + 1, _SAMPLES - 1)]
    found = minimize_scalar(
        lambda v: -float(sensitivity(loop, np.exp(np.array([v])))[0]), bounds=ends, method="bounded",
        options={"xatol": 1e-9},
    )  # fmt: skip
    d, n = loop.polynomials
    gain, phase, _, _, _, at_phase = control.stability_margins(control.TransferFunction(loop.values @ n, d))[:6]
    delay = math.radians(phase % 360.0) / at_phase if np.isfinite(phase) and at_phase > 0.0 else math.inf
    peak = max(-float(found.fun), 1.0)
    return Margins(
        True, peak, math.exp(float(found.x)), float(gain),
        math.radians(phase) if np.isfinite(phase) else math.inf, delay, damping,
    )  # fmt: skip
