"""What a controller that knew everything would leave: linear-quadratic state feedback, for context.

It sees ship, fins and the wave filter's own states without noise and orders the actuator's rate itself: no sensor, no
servo, no margin (with an observer in its place the margins are gone: Doyle 1978, IEEE Trans. Autom. Control 23(4)).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solve_continuous_are, solve_continuous_lyapunov
from scipy.optimize import brentq, least_squares

from seatrial.control.youla import (
    NoBound,
    ReferenceVariances,
    reference_variances,
    refuse_unbounded,
    without_negative_energy,
)
from seatrial.core.results.tuning import PerformanceBound
from seatrial.core.values import Array
from seatrial.physics.loops import Block, EncounterSpectrum, TransferLoop, in_series
from seatrial.physics.loops.encounter_spectrum import disturbance_spectrum
from seatrial.physics.loops.loop import controllable_form

_FIT, _SPAN = 800, 30.0  # frequencies of the fit, and their span as a factor either side of the mean frequency; chosen
_TAIL_FACTOR = 100.0  # span of the rational spectrum either side of the mean frequency; chosen


@dataclass(frozen=True)
class ShapingFilter:
    """A filter from white noise to the disturbance; its one-sided density is |F(j omega)|^2.

    misfit: largest share of the uncontrolled output's variance that the fit puts out of place in a band.
    """

    block: Block
    misfit: float

    def density(self, omega: Array) -> Array:
        """Return the one-sided density, unit^2 s/rad."""
        return np.abs(self.block.frequency_response(omega)) ** 2


def rational_spectrum(exposure: EncounterSpectrum, response: Block) -> tuple[EncounterSpectrum, ShapingFilter]:
    """The sea of a rational spectrum fitted to the exposure, and its filter; `response`: from there to the output."""
    shaping, mean = fit_shaping_filter(exposure, response), exposure.mean_frequency(response)
    said = f"{exposure.description}, rational fit with tails ({100.0 * shaping.misfit:.1f} % of the energy misplaced)"
    return disturbance_spectrum(shaping.density, mean / _TAIL_FACTOR, mean * _TAIL_FACTOR, response, said), shaping


def quadratic_bound(loop: TransferLoop, exposure: EncounterSpectrum, gains: Array) -> PerformanceBound:
    """Return the output variance of full-information LQ over that of `gains` (g,), at equal actuator-rate variance.

    Both in the sea of a rational spectrum fitted to the exposure, whose misfit the note states. Spectra that vanish
    outside a band can be predicted ever better the more closely they are fitted, so that bounds in the spectrum itself
    may lie below this one.
    """
    refuse_unbounded(loop)
    sea, shaping = rational_spectrum(exposure, loop.disturbance)
    held = reference_variances(loop, sea, gains)
    least = full_information(loop.plant, loop.disturbance, shaping.block, held)
    note = (
        "For context, not attainable: state feedback that knows ship, fins and waves exactly and keeps no margin (LQ). "
        f"Waves are a filter of order {shaping.block.order} fitted to the spectrum."
    )
    return PerformanceBound(
        "everything known", least / held.output, f"equal rate energy of the actuator; {sea.description}", note
    )


def fit_shaping_filter(exposure: EncounterSpectrum, response: Block) -> ShapingFilter:
    """Return g s^2 / two sections of second order, by the cumulated energies of the response and of its rate."""
    exposure = without_negative_energy(exposure)
    mean = exposure.mean_frequency(response)
    omega = np.geomspace(mean / _SPAN, mean * _SPAN, _FIT)
    true = np.concatenate([_cumulative_energy(exposure, response, omega, power) for power in (0, 2)])
    through = np.abs(response.frequency_response(omega)) ** 2
    steps = np.gradient(omega)

    def shares(point: Array) -> Array:
        energy = np.abs(_shaping_block(point, 1.0).frequency_response(omega)) ** 2 * through * steps
        return np.concatenate([_cumulative_share(e) for e in (energy, omega**2 * energy)])

    # first guess: two resonances about the mean frequency, damping ratios 0.2 and 0.3
    start = np.log([0.8 * mean, 0.2, 1.2 * mean, 0.3])
    # a decade either side in frequency; damping ratios 0.01 to 2
    edges = np.log([0.1 * mean, 0.01, 0.1 * mean, 0.01]), np.log([10.0 * mean, 2.0, 10.0 * mean, 2.0])
    best = least_squares(lambda p: shares(p) - true, start, bounds=edges)
    off = (shares(best.x) - true)[:_FIT]
    unit = _shaping_block(best.x, 1.0)
    spectrum = np.abs(unit.frequency_response(omega)) ** 2
    size = exposure.response_variance(response) / float(np.sum(spectrum * through * steps))
    return ShapingFilter(_shaping_block(best.x, math.sqrt(size)), float(max(off.max(), 0.0) - min(off.min(), 0.0)))


def _shaping_block(point: Array, size: float) -> Block:
    a, za, b, zb = (float(v) for v in np.exp(point))
    one = Block("", (1.0, 0.0), (1.0, 2.0 * za * a, a**2))
    return in_series("waves", (one, Block("", (size, 0.0), (1.0, 2.0 * zb * b, b**2))))


def _cumulative_energy(exposure: EncounterSpectrum, response: Block, omega: Array, power: int) -> Array:
    """Return the share of the response's energy, times omega^power, below each omega; nodes in order."""
    w = exposure.omega_e
    energy = exposure.energy * np.abs(response.frequency_response(w)) ** 2 * w**power
    return np.interp(omega, w, _cumulative_share(energy), left=0.0, right=1.0)


def _cumulative_share(energy: Array) -> Array:
    return (np.cumsum(energy) - 0.5 * energy) / energy.sum()


def full_information(plant: Block, disturbance: Block, shaping: Block, reference: ReferenceVariances) -> float:
    """Return the least output variance at the rate variance held, by the weight of the rate in the cost."""
    cost = _variances_by_weight(plant, disturbance, shaping)
    middle = math.log(reference.output / reference.rate)

    def off(log_weight: float) -> float:
        return math.log(cost(math.exp(log_weight)).rate / reference.rate)

    # half width of the bracket in the logarithm of the weight, widened until it holds the root
    for reach in (4.0, 8.0, 12.0, 16.0):
        if off(middle - reach) > 0.0 > off(middle + reach):
            # tolerance in the logarithm of the weight: rounding
            return cost(math.exp(float(brentq(off, middle - reach, middle + reach, xtol=1e-9)))).output  # type: ignore[arg-type]
    raise NoBound(f"no weight of the actuator's rate gives a variance of {reference.rate:.3g} of it")


def _variances_by_weight(plant: Block, disturbance: Block, shaping: Block) -> Callable[[float], ReferenceVariances]:
    """Variances by the rate's weight; states of plant, disturbance, waves, actuator, of which the rate is ordered."""
    (Ap, bp, cp, dp), (Ad, bd, cd, dd), (As, bs, cs, _) = (
        controllable_form(block) for block in (plant, disturbance, shaping)
    )
    A = block_diag(Ap, Ad, As, np.zeros((1, 1)))
    p, d, s = len(bp), len(bp) + len(bd), len(bp) + len(bd) + len(bs)
    A[:p, s], A[p:d, d:s] = bp, np.outer(bd, cs)
    B, noise = np.zeros((s + 1, 1)), np.zeros(s + 1)
    B[s, 0] = 1.0
    # one-sided density |F|^2 is that of white noise of intensity pi
    noise[d:s] = math.sqrt(math.pi) * bs
    C = np.concatenate([cp, cd, dd * cs, [dp]])

    def variances_at(weight: float) -> ReferenceVariances:
        try:
            X = solve_continuous_are(A, B, np.outer(C, C), np.array([[weight]]))
        except np.linalg.LinAlgError as error:
            raise NoBound(f"the Riccati equation of the quadratic bound is not solved: {error}") from error
        K = (B.T @ X)[0] / weight
        V = solve_continuous_lyapunov(A - B * K, -np.outer(noise, noise))
        return ReferenceVariances(float(C @ V @ C), float(K @ V @ K))

    return variances_at
