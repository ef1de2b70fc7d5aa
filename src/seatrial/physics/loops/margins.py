"""How near a loop is to instability, at its own gains."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops.loop import TransferLoop

_SAMPLES = 2000  # frequencies that the margins are bracketed on; chosen
_BELOW, _ABOVE = 0.3, 2.0  # ends of the band over the slowest and the fastest root; chosen
_EMPTY_BAND = 1e-2, 1e2  # rad/s, where there is no root; chosen
_AT_ORIGIN, _PEAK_TOLERANCE = 1e-6, 1e-9  # rad/s, a root that counts as zero; of log omega at the peak: rounding
_LEAST = 1e-300  # rad/s, guards against a pole at zero


@dataclass(frozen=True)
class StabilityMargins:
    """Of one loop; nan where it is unstable.

    Attributes:
        is_stable: all closed-loop poles lie left of the axis; Ms: the largest |S|, infinite if unstable;
        Ms_frequency: rad/s.
        gain: the factor that the loop gain may grow by, infinite if any; lower_gain: that it may fall to, zero if any.
        phase: rad, positive: the least that L may turn, either way, where its size is one; infinite if it never is.
        delay: s of dead time that the loop tolerates: the least lag up to -1 over the frequency, infinite if any.
        damping: the least damping ratio of a closed-loop pole.
    """

    is_stable: bool
    Ms: float
    Ms_frequency: float
    gain: float
    phase: float
    delay: float
    damping: float
    lower_gain: float = math.nan


def frequency_band(loop: TransferLoop) -> tuple[float, float]:
    """Return frequencies [rad/s] between which everything of the loop happens.

    A little more than from the slowest to the fastest of its poles and zeros, of a sampled loop to its Nyquist
    frequency; beside the open ones those that swing when it is closed at its own gains or with all at their upper
    bounds, as integrators let it.
    """
    d, n = loop.polynomials
    bounds = np.array([gain.upper for gain in loop.gains])
    closed = d + loop.gain_values @ n, d + np.where(np.isfinite(bounds), bounds, loop.gain_values) @ n
    swinging = [roots[np.abs(roots.imag) > 0.5 * np.abs(roots.real)] for roots in (np.roots(row) for row in closed)]
    roots = np.abs(np.concatenate([np.roots(d), *(np.roots(row) for row in n), *swinging]))
    some = roots[roots > _AT_ORIGIN]
    low, high = (_BELOW * float(some.min()), _ABOVE * float(some.max())) if some.size else _EMPTY_BAND
    highest = math.inf if loop.sampling is None else loop.sampling.highest
    return min(low, _BELOW * highest), min(high, highest)


def sensitivity_magnitude(loop: TransferLoop, omega: Array) -> Array:
    """Return |S| of the loop at omega [rad/s], (n,)."""
    return 1.0 / np.abs(1.0 + loop.open_loop(omega))


def sensitivity_peak(loop: TransferLoop) -> tuple[float, float]:
    """Return Ms and where it is [rad/s], to rounding, by a search about the largest sample; the loop must be stable."""
    from scipy.optimize import minimize_scalar

    u = _log_frequencies(loop)
    place = int(np.argmax(sensitivity_magnitude(loop, np.exp(u))))
    ends = u[max(place - 1, 0)], u[min(place + 1, _SAMPLES - 1)]
    found = minimize_scalar(
        lambda v: -float(sensitivity_magnitude(loop, np.exp(np.array([v])))[0]), bounds=ends, method="bounded",
        options={"xatol": _PEAK_TOLERANCE},
    )  # fmt: skip
    return max(-float(found.fun), 1.0), math.exp(float(found.x))


def margins(loop: TransferLoop) -> StabilityMargins:
    """Return the margins at the loop's gains; Ms to rounding, by a search about the largest sample."""
    poles = loop.closed_loop_poles
    damping = float(np.min(-poles.real / np.maximum(np.abs(poles), _LEAST)))
    if not np.all(poles.real < 0.0):
        return StabilityMargins(False, math.inf, math.nan, math.nan, math.nan, math.nan, damping)
    peak, at = sensitivity_peak(loop)
    turned, lag = _unit_crossings(loop)
    axis = _crossing_frequencies(loop, lambda z: z.imag)
    factors = -1.0 / loop.open_loop(axis if loop.sampling is None else np.append(axis, loop.sampling.highest)).real
    return StabilityMargins(
        True, peak, at, _minimum(factors[factors > 1.0]), _minimum(np.minimum(lag, 2.0 * math.pi - lag)),
        _minimum(lag / turned), damping, float(np.max(factors[(factors > 0.0) & (factors < 1.0)], initial=0.0)),
    )  # fmt: skip


def delay_margin(loop: TransferLoop) -> float:
    """Return the delay [s] of `margins` alone, which costs a third of it; nan where the loop is unstable."""
    if not np.all(loop.closed_loop_poles.real < 0.0):
        return math.nan
    turned, lag = _unit_crossings(loop)
    return _minimum(lag / turned)


def _unit_crossings(loop: TransferLoop) -> tuple[Array, Array]:
    """Return frequencies [rad/s] where |L| is one, and the lag up to -1 there, rad in 0 .. 2 pi."""
    turned = _crossing_frequencies(loop, lambda z: np.abs(z) - 1.0)
    return turned, np.mod(np.angle(loop.open_loop(turned)) + math.pi, 2.0 * math.pi)


def _log_frequencies(loop: TransferLoop) -> Array:
    """Logarithms of frequencies over the band and all closed poles: a weak loop that integrates crosses one early."""
    low, high = frequency_band(loop)
    poles = np.abs(loop.closed_loop_poles)
    highest = math.inf if loop.sampling is None else loop.sampling.highest
    first, last = min(low, _BELOW * poles.min()), min(max(high, _ABOVE * poles.max()), highest)
    return np.linspace(math.log(first), math.log(last), _SAMPLES)


def _crossing_frequencies(loop: TransferLoop, function: Callable[[Complex], Array]) -> Array:
    """Return frequencies [rad/s] at which a function of L changes its sign."""
    from scipy.optimize import brentq

    u = _log_frequencies(loop)
    rises = np.flatnonzero(np.diff(np.sign(function(loop.open_loop(np.exp(u))))))

    def along(v: float) -> float:
        return float(function(loop.open_loop(np.exp(np.array([v]))))[0])

    # tolerance in the logarithm of the frequency: rounding
    return np.exp(np.array([float(brentq(along, u[i], u[i + 1], xtol=1e-13)) for i in rises]))  # type: ignore[arg-type]


def _minimum(values: Array) -> float:
    return float(values.min()) if values.size else math.inf
