"""The least variance that any stabilising linear controller leaves, by a convex programme (cvxpy, extra `bounds`).

With a stable plant, and sensor, filters and servo F that the controller acts through, all stabilising controllers are
K = F Q' / (1 - P F Q') with Q' stable (Youla, Jabr & Bongiorno 1976, IEEE Trans. Autom. Control 21(3), 319-338), and
S = 1 - P F Q', a = -F Q' D w are affine in Q'. Variances and peaks are convex in it (Boyd & Barratt 1991, Linear
Controller Design). Q' is a sum of Kautz functions of frequencies spread evenly over the logarithm; washout zeros and
the roll-off of servo and gyro stay in F; so that Q' cannot undo them, |T| <= (1 + peak) times the servo's own response
at every frequency: no loop is faster than its servo. Without that, spectra that vanish outside a band could be
predicted and cancelled whatever the peak, by |S| at the peak over an unlimited band (Bode's integral).
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from seatrial.core.results.tuning import PerformanceBound
from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import EncounterSpectrum, LoopSignal, Performance, TransferLoop, WeightedVariance, in_series

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
        cvxpy = _cvxpy()
        x: Any = cvxpy.Variable(self.A.shape[1])
        held = [cvxpy.norm(self.R @ x) <= 1.0]
        if math.isfinite(Ms):
            held.append(cvxpy.norm(cvxpy.vstack([1.0 - self.Z.real @ x, self.Z.imag @ x]), 2, axis=0) <= Ms)
        capped = np.isfinite(self.T_limit)
        if capped.any():
            T = self.Z[capped] / self.T_limit[capped, None]
            held.append(cvxpy.norm(cvxpy.vstack([T.real @ x, T.imag @ x]), 2, axis=0) <= 1.0)
        problem = cvxpy.Problem(cvxpy.Minimize(cvxpy.norm(self.A @ x - self.b)), held)
        try:
            problem.solve(solver=cvxpy.CLARABEL)
        except cvxpy.SolverError as error:
            raise NoBound(f"the convex solver gives up on the bound ({error}); ask for fewer sections") from error
        if problem.value is None or not np.isfinite(problem.value):
            raise NoBound(f"the convex solver finds no bound (it says: {problem.status}); ask for fewer sections")
        return float(problem.value)


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


def _cvxpy() -> Any:
    try:
        import cvxpy
    except ImportError as error:
        raise InputError("bounds need the package cvxpy: pip install 'seatrial[bounds]'") from error
    return cvxpy
