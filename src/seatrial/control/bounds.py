"""What no linear controller does better: the least variance of all stabilising ones, and of state feedback."""

import contextlib
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.util import find_spec
from typing import Any

import numpy as np
from scipy.linalg import block_diag, solve_continuous_are, solve_continuous_lyapunov
from scipy.optimize import brentq, least_squares

from seatrial.control.task import OUTPUT, Seaway, TuningTask
from seatrial.core.results.tuning import PerformanceBound
from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import (
    Block,
    EncounterSpectrum,
    LoopSignal,
    Performance,
    TransferLoop,
    WeightedVariance,
    in_series,
)
from seatrial.physics.loops.encounter_spectrum import disturbance_spectrum
from seatrial.physics.loops.loop import controllable_form

# The least variance that any stabilising linear controller leaves, by a convex programme (clarabel, extra `bounds`).

KAUTZ_DAMPING = 0.7  # damping ratio of each Kautz section; chosen
KAUTZ_SECTIONS = 32  # second-order sections of the expansion; chosen
_GRID = 260  # frequencies of the penalty on the sensitivity; chosen
_LOWEST = 0.1  # lowest frequency of a Kautz section over the mean one of the waves; chosen
_DECADES = 1000.0  # least span of their frequencies, three decades; chosen
NEGLIGIBLE_SHARE = 0.01  # share of the reference's output variance below which a bound is not informative
BOUND_ROWS = (WeightedVariance(LoopSignal.OUTPUT, np.ones_like), WeightedVariance(LoopSignal.ACTUATOR, lambda w: w))


class NoBound(InputError):
    """No bound can be had for this loop."""


@dataclass(frozen=True)
class ReferenceVariances:
    """What a bound is held against: output variance and actuator-rate variance of some gains, SI."""

    output: float
    rate: float


def reference_variances(loop: TransferLoop, exposure: EncounterSpectrum, gains: Array) -> ReferenceVariances:
    """Return the variances with gains (g,)."""
    output, rate = (
        float(v) for v in Performance(loop, exposure, BOUND_ROWS).evaluate(gains, with_Ms=False).variances[0]
    )
    if not math.isfinite(output + rate):
        raise InputError(f"loop '{loop.name}' is unstable with the gains that its bound is to be held against")
    return ReferenceVariances(output, rate)


def without_negative_energy(exposure: EncounterSpectrum) -> EncounterSpectrum:
    """The exposure without negative energies, which are made up for by the nodes next to them; nodes in order."""
    order = np.argsort(exposure.omega_e)
    energy = exposure.energy[order].copy()
    for i in np.flatnonzero(energy < 0.0):
        owed, reach = -energy[i], 1
        energy[i] = 0.0
        while owed > 0.0 and reach < len(energy):
            for j in (i - reach, i + reach):
                if 0 <= j < len(energy) and energy[j] > 0.0:
                    paid = min(owed, energy[j])
                    energy[j] -= paid
                    owed -= paid
            reach += 1
    kept = energy > 0.0
    return EncounterSpectrum(exposure.omega_e[order][kept], energy[kept], exposure.description)


def refuse_unbounded(loop: TransferLoop) -> None:
    """Refuse loops on plants that integrate or run away: they have no such bound here."""
    for block in (loop.plant, loop.disturbance, *loop.sensor, *loop.filters, *loop.servo):
        if block.order and block.poles.real.max() >= 0.0:
            raise NoBound(
                f"block '{block.name}' of loop '{loop.name}' integrates or is unstable: without control it has no "
                "variance, and bounds are for stable plants only"
            )


def youla_bound(
    loop: TransferLoop, exposure: EncounterSpectrum, gains: Array, Ms: float, *, sections: int = KAUTZ_SECTIONS
) -> PerformanceBound:
    """Return the least output variance over that of `gains` (g,) at equal actuator-rate energy, |S| <= `Ms` everywhere.

    It is the least over sums of `sections` Kautz sections; the note says what the second half of them has changed.

    Args:
        Ms: above 1; infinite for none, and then no roll-off of |T| either.
    """
    refuse_unbounded(loop)
    sea = without_negative_energy(exposure)
    held = reference_variances(loop, sea, gains)
    half, whole = (least_variance(loop, sea, held.rate, Ms, n) for n in (sections // 2, sections))
    capped = f", Ms <= {Ms:.3g}" if math.isfinite(Ms) else ""
    if whole < NEGLIGIBLE_SHARE * held.output:
        detail = "so much rate energy would cancel these waves altogether; the limit of the reference lies elsewhere."
    else:
        changed = 100.0 * (1.0 - whole / half)
        detail = f"{2 * sections + 1} terms, of which the second half changed it by {changed:.0f} %."
    note = f"However complicated, through the same sensor and servo, in this spectrum alone (Youla, convex): {detail}"
    at = f"equal rate energy of the actuator; {exposure.description}{capped}"
    return PerformanceBound("any linear controller", whole / held.output, at, note)


def least_variance(loop: TransferLoop, exposure: EncounterSpectrum, rate: float, Ms: float, sections: int) -> float:
    """Return the output variance with no more than `rate` of actuator-rate variance and |S| <= Ms."""
    if not Ms > 1.0:
        raise InputError(f"|S| exceeds 1 somewhere in every real loop; give a largest Ms above 1, not {Ms:g}")
    if not rate > 0.0:
        return exposure.response_variance(loop.disturbance)
    problem = _Programme.from_loop(loop, exposure, math.sqrt(rate), Ms, sections)
    return problem.solve(Ms) ** 2 * exposure.response_variance(loop.disturbance)


def kautz_functions(frequencies: Array, omega: Array) -> Complex:
    """Return functions (1 + 2 n, m): 1, and two for each of n frequencies, at omega (m,) [rad/s].

    With d_i = s^2 + 2 zeta w_i s + w_i^2: s / d_i and w_i / d_i, times the all-passes of the sections before (Wahlberg
    1994, IEEE Trans. Autom. Control 39(6), 1276-1282).
    """
    s = 1j * omega
    made, passed = [np.ones_like(s)], np.ones_like(s)
    for w in frequencies:
        d = s**2 + 2.0 * KAUTZ_DAMPING * w * s + w**2
        size = math.sqrt(4.0 * KAUTZ_DAMPING * w)
        made += [size * s / d * passed, size * w / d * passed]
        passed = passed * (s**2 - 2.0 * KAUTZ_DAMPING * w * s + w**2) / d
    return np.array(made, dtype=np.complex128)


@dataclass(frozen=True, eq=False)
class _Programme:
    """min |A x - b| with |R x| <= 1, |1 - Z x| <= Ms and |Z x| <= T_limit at every frequency of a grid.

    Coordinates x are those in which all rows together are orthonormal; A, R are real, triangular; Z is complex.
    """

    A: Array
    b: Array
    R: Array
    Z: Complex
    T_limit: Array

    @classmethod
    def from_loop(
        cls, loop: TransferLoop, exposure: EncounterSpectrum, rate: float, Ms: float, sections: int
    ) -> "_Programme":
        path = in_series("path", (*loop.sensor, *loop.filters, *loop.servo))
        w = exposure.omega_e
        met = np.sqrt(exposure.energy) * np.abs(loop.disturbance.frequency_response(w))
        low, high = _frequency_span(loop, _LOWEST * float(np.sum(w * met**2) / np.sum(met**2)))
        grid, frequencies = np.geomspace(low / 10.0, 4.0 * high, _GRID), np.geomspace(low, high, sections)
        at_nodes = (kautz_functions(frequencies, w) * path.frequency_response(w)).T
        on_grid = (
            kautz_functions(frequencies, grid) * path.frequency_response(grid) * loop.plant.frequency_response(grid)
        ).T
        size = float(np.linalg.norm(met))
        left = at_nodes * (loop.plant.frequency_response(w) * met / size)[:, None]
        moved = at_nodes * (w * met / rate)[:, None]
        whole = np.vstack([left, moved, on_grid / math.sqrt(_GRID)])
        turn = np.linalg.inv(np.linalg.qr(np.vstack([whole.real, whole.imag]), mode="r"))
        A, b = _triangular(left @ turn, met / size)
        R, _ = _triangular(moved @ turn, np.zeros_like(met))
        return cls(A, b, R, on_grid @ turn, (1.0 + Ms) * _servo_response(loop, grid))

    def solve(self, Ms: float) -> float:
        """Return the least |A x - b|."""
        from scipy.sparse import csc_matrix

        clarabel, n = _clarabel(), self.A.shape[1]
        # min t: cones of second order over t and x, in which what is first bounds the norm of what follows
        cones = [_cone(self.A), _cone(self.R)]
        ends = [np.append(0.0, -self.b), np.append(1.0, np.zeros(len(self.R)))]
        cones[0][0, 0] = 1.0
        if math.isfinite(Ms):
            cones += [_cone(np.stack([-z.real, z.imag])) for z in self.Z]
            ends += [np.array([Ms, 1.0, 0.0])] * len(self.Z)
        capped = np.isfinite(self.T_limit)
        T = self.Z[capped] / self.T_limit[capped, None]
        cones += [_cone(np.stack([z.real, z.imag])) for z in T]
        ends += [np.array([1.0, 0.0, 0.0])] * len(T)
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        solution = clarabel.DefaultSolver(
            csc_matrix((n + 1, n + 1)), np.eye(1, n + 1)[0], csc_matrix(-np.vstack(cones)), np.concatenate(ends),
            [clarabel.SecondOrderConeT(len(cone)) for cone in cones], settings,
        ).solve()  # fmt: skip
        if solution.status not in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved):
            raise NoBound(f"the convex solver finds no bound (it says: {solution.status}); ask for fewer sections")
        return float(solution.obj_val)


def _cone(rows: Array) -> Array:
    """Return rows (1 + k, 1 + n) over t and x of a cone of second order: its bound, then rows (k, n) over x."""
    return np.pad(rows, ((1, 0), (1, 0)))


def _servo_response(loop: TransferLoop, omega: Array) -> Array:
    """Return |servo| over that at rest."""
    servo = in_series("servo", loop.servo)
    return np.abs(servo.frequency_response(omega)) / abs(servo.gain)


def _triangular(rows: Complex, target: Array) -> tuple[Array, Array]:
    """Return the same sum of squares |rows x - target|^2 by few real rows."""
    both = np.column_stack([np.vstack([rows.real, rows.imag]), np.concatenate([target, np.zeros_like(target)])])
    R = np.asarray(np.linalg.qr(both, mode="r"))
    return R[:, :-1], R[:, -1]


def _frequency_span(loop: TransferLoop, low: float) -> tuple[float, float]:
    """Return `low` [rad/s] and four times the fastest pole of sensor, filters, servo; three decades at least."""
    poles = [np.abs(block.poles).max() for block in (*loop.sensor, *loop.filters, *loop.servo) if block.order]
    return low, max(4.0 * float(max(poles, default=0.0)), _DECADES * low)


def _clarabel() -> Any:
    try:
        import clarabel
    except ImportError as error:
        raise InputError("bounds need the package clarabel: pip install 'seatrial[bounds]'") from error
    return clarabel


# What a controller that knew everything would leave: linear-quadratic state feedback, for context.

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


# What no linear controller does better: bounds compared with a tuning, as many as can be computed.


def is_available() -> bool:
    """Return whether the convex bounds can be computed: clarabel, the extra `bounds`, is installed."""
    return find_spec("clarabel") is not None


def bounds(task: TuningTask, loop: TransferLoop, gains: Array) -> tuple[PerformanceBound, ...]:
    """Return bounds against the controller `gains` (g,) of `loop`, in the first sea of the task.

    Where clarabel is installed the convex one in the sea itself, and in a rational spectrum fitted to it: one without
    energy outside a band lets complicated controllers predict what real seas, with tails, do not. The linear-quadratic
    one in the latter, for context. None for servo loops on plants that integrate or run away (an autopilot), nor where
    no sea is met: their output has no variance without control. Nor where a point of the hull counts, not the output.
    """
    sea = next((met for met in task.disturbances if isinstance(met, Seaway)), None)
    if sea is None or task.demand is not None or task.motion is not OUTPUT:
        return ()
    loop = replace(sea.disturbed(loop), sampling=None)  # a bound in continuous time without dead time is one of all
    waves, peak = sea.exposure(loop), task.constraints.Ms

    def with_tails() -> PerformanceBound:
        bound = youla_bound(loop, rational_spectrum(waves, loop.disturbance)[0], gains, peak)
        return replace(bound, name=f"{bound.name}, waves with tails")

    convex = [lambda: youla_bound(loop, waves, gains, peak), with_tails] if is_available() else []
    computed: list[PerformanceBound] = []
    for compute in (*convex, lambda: quadratic_bound(loop, waves, gains)):
        with contextlib.suppress(NoBound):
            computed.append(compute())
    return tuple(computed)
