"""The published fin loop in a beam sea: evaluations a second, beside simulation and Lyapunov; its genetic search.

The job is the same for all: three variances (roll, fin angle, fin rate) of the closed loop at some gains, from matrices
or polynomials that are known. The time-domain search draws, breeds and selects as ours does; its objectives come from a
compiled exact simulation in hold of 1000 s at 0.1 s under one record of the same sea, for stable individuals only: once
with the loops written out for the machine's vectors, once with phi @ x as one would write it.
"""

import math
import time
from collections.abc import Callable

import control
import numpy as np
from measure import Line, at_least, at_most, fastest
from numba import njit
from scipy.linalg import expm, solve_continuous_lyapunov
from scipy.signal import lsim

from seatrial.numerics.optimise import Box, GeneticSettings, RandomWeightGenetic, search
from seatrial.physics.loops import (
    Block,
    EncounterSpectrum,
    HullFactor,
    LoopSignal,
    Performance,
    TransferLoop,
    sea_disturbance,
)
from seatrial.physics.loops.encounter_spectrum import disturbance_spectrum
from seatrial.physics.loops.loop import controllable_form
from seatrial.physics.loops.loop_states import StateSpace, state_space
from seatrial.physics.loops.objective import squared_deviation, variance
from seatrial.physics.loops.performance import distinct_variances
from seatrial.physics.loops.structures import BOUNDS, ROLL, Preamplifier, fin_loop
from seatrial.physics.sea.spectrum import ittc

DURATION, DT, COUNT, POOL, SOME = 1000.0, 0.1, 20000, 400, 20
LOWER, UPPER = (np.array(side) for side in zip(*BOUNDS.values(), strict=True))
TARGET = math.radians(math.sqrt(150.31)) ** 2
ROBUST = 5.0
OBJECTIVES = (
    variance("roll", "rad^2", LoopSignal.OUTPUT),
    squared_deviation("fin", LoopSignal.ACTUATOR, TARGET, one_sided=False),
    variance("rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1),
)
ROWS, PLACES = distinct_variances(OBJECTIVES)
SHAPED = Block("sea", (1.0, 0.0), (1.0, 0.54, 0.81))


def sea() -> EncounterSpectrum:
    """Beam sea of 3.3 m at 18 kn."""
    hull = HullFactor(100.0, 10.5, 3.4)
    return sea_disturbance(ittc(3.3), 18.0 * 1852.0 / 3600.0, math.pi / 2.0, ROLL, hull)


def record(slope_spectrum: EncounterSpectrum, rng: np.random.Generator) -> np.ndarray:
    """Effective wave slope [rad] over time, random phases."""
    t, u = np.arange(round(DURATION / DT) + 1) * DT, 0.0
    for omega, energy, phase in zip(
        slope_spectrum.omega_e,
        slope_spectrum.energy,
        rng.uniform(0.0, 2.0 * math.pi, len(slope_spectrum.energy)),
        strict=True,
    ):
        u = u + math.sqrt(2.0 * energy) * np.cos(omega * t + phase)
    return np.asarray(u)


def output_rows(realisation: StateSpace, gains: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A (n, n) and rows for roll, fin angle, fin rate (3, n) at some gains."""
    A, a = realisation.closed_loop_matrix(gains), realisation.actuator_row(gains)
    return A, np.stack([realisation.c, a, a @ A])


@njit(fastmath=True)
def mean_squares(phi: np.ndarray, gamma: np.ndarray, C: np.ndarray, u: np.ndarray, out: np.ndarray) -> None:
    """Of three outputs over a record, in hold; phi transposed, so that the inner loop runs along it."""
    n = len(gamma)
    x, following = np.zeros(n), np.zeros(n)
    out[:] = 0.0
    for k in range(len(u)):
        for i in range(n):
            following[i] = gamma[i] * u[k]
        for j in range(n):
            now = x[j]
            for i in range(n):
                following[i] += phi[j, i] * now
        for r in range(len(out)):
            y = 0.0
            for i in range(n):
                y += C[r, i] * x[i]
            out[r] += y * y
        x, following = following, x
    for r in range(len(out)):
        out[r] /= len(u)


@njit
def plain_mean_squares(phi: np.ndarray, gamma: np.ndarray, C: np.ndarray, u: np.ndarray, out: np.ndarray) -> None:
    """The same as one would write it."""
    x = np.zeros(len(gamma))
    out[:] = 0.0
    for k in range(len(u)):
        y = C @ x
        out += y * y
        x = phi @ x + gamma * u[k]
    out /= len(u)


class TimeDomainVariances:
    """Variances in the time domain."""

    def __init__(self, loop: TransferLoop, u: np.ndarray, *, is_plain: bool = False) -> None:
        self.realisation, self.u, self.is_plain = state_space(loop), u, is_plain

    def variances(self, gains: np.ndarray) -> np.ndarray:
        """Variances (m, 3) at gains (m, g); infinite where unstable."""
        out, n = np.full((len(gains), 3), np.inf), len(self.realisation.b)
        for row, k in zip(out, gains, strict=True):
            A, C = output_rows(self.realisation, k)
            if np.linalg.eigvals(A).real.max() >= 0.0:
                continue
            block = np.zeros((n + 1, n + 1))
            block[:n, :n], block[:n, n] = A * DT, self.realisation.b * DT
            whole = expm(block)
            phi, gamma = whole[:n, :n], whole[:n, n].copy()
            if self.is_plain:
                plain_mean_squares(phi.copy(), gamma, C, self.u, row)
            else:
                mean_squares(np.ascontiguousarray(phi.T), gamma, C, self.u, row)
        return out


def by_lsim(realisation: StateSpace, gains: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The three variances by SciPy."""
    A, C = output_rows(realisation, gains)
    y = lsim((A, realisation.b[:, None], C, np.zeros((3, 1))), u, np.arange(len(u)) * DT)[1]
    return np.mean(y**2, axis=0)


def by_control(realisation: StateSpace, gains: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The three variances by python-control."""
    A, C = output_rows(realisation, gains)
    system = control.ss(A, realisation.b[:, None], C, np.zeros((3, 1)))
    return np.mean(control.forced_response(system, np.arange(len(u)) * DT, u).outputs ** 2, axis=1)


def by_lyapunov(realisation: StateSpace, gains: np.ndarray) -> np.ndarray:
    """The three variances under shaped white noise of one-sided density 1."""
    (own_A, C), (fa, fb, fc, _) = output_rows(realisation, gains), controllable_form(SHAPED)
    n, m = len(realisation.b), len(fb)
    A, b = np.zeros((n + m, n + m)), np.zeros(n + m)
    A[:n, :n], A[:n, n:], A[n:, n:], b[n:] = own_A, np.outer(realisation.b, fc), fa, fb
    X = solve_continuous_lyapunov(A, -math.pi * np.outer(b, b))[:n, :n]
    return np.einsum("ri,ij,rj->r", C, X, C)


def objectives(variances: np.ndarray) -> np.ndarray:
    """J1, J2, J3 (m, 3)."""
    return np.stack([o.value(variances[:, p]) for o, p in zip(OBJECTIVES, PLACES, strict=True)], axis=1)


def search_seconds(variances_of: Callable[[np.ndarray], np.ndarray], generations: int = 200) -> float:
    """Seconds of the published search, population 50."""
    genetic = RandomWeightGenetic(
        Box(LOWER, UPPER), np.random.default_rng(1), GeneticSettings(population=50, generations=generations)
    )
    began = time.perf_counter()
    search(genetic, lambda points: objectives(variances_of(points)))
    return time.perf_counter() - began


def run() -> list[Line]:
    """Evaluations a second, then ratios and agreements."""
    lines = []
    for reading in (Preamplifier.PRINTED, Preamplifier.WASHOUT):
        lines += _preamplifier_lines(fin_loop(reading), reading.name.lower())
    return lines


def _preamplifier_lines(loop: TransferLoop, word: str) -> list[Line]:
    rng = np.random.default_rng(2014)
    met = sea()
    of, made, u = Performance(loop, met, ROWS), state_space(loop), record(met, rng)
    drawn = LOWER + rng.random((COUNT, 3)) * (UPPER - LOWER)
    stable = drawn[np.isfinite(of.evaluate(drawn).Ms)]
    whole, alone = (fastest(lambda p=p: of.evaluate(stable, with_Ms=p), 15) / len(stable) for p in (True, False))
    box = fastest(lambda: of.evaluate(drawn), 15) / len(drawn)
    k = loop.gain_values
    lsim_seconds, control_seconds = (fastest(lambda f=f: f(made, k, u), 3) for f in (by_lsim, by_control))
    lyapunov_seconds = fastest(lambda: by_lyapunov(made, k), 20)
    apart = np.sqrt(by_lsim(made, k, u) / of.evaluate(k).variances[0]) - 1.0
    ours = min(search_seconds(lambda points: of.evaluate(points, with_Ms=False).variances) for _ in range(5))
    written_out, plain = TimeDomainVariances(loop, u), TimeDomainVariances(loop, u, is_plain=True)
    np.testing.assert_allclose(written_out.variances(k[None]), plain.variances(k[None]), rtol=1e-9)
    theirs, plainly = search_seconds(written_out.variances), search_seconds(plain.variances, SOME) * 200 / SOME
    return [
        at_least(f"{word}: stable loops, three variances, Routh", 1e-6 / alone, "M/s", 1.0),
        at_least(f"{word}: the same with Ms", 1e-6 / whole, "M/s", 1.0),
        Line(f"{word}: the same over the whole box, unstable loops too", 1e-6 / box, "M/s"),
        at_least(f"{word}: ratio, scipy.signal.lsim of {DURATION:g} s", lsim_seconds / alone, "x", 1e5),
        Line(f"{word}: the same with Ms", lsim_seconds / whole, "x"),
        at_least(f"{word}: ratio, python-control forced_response", control_seconds / alone, "x", 1e5),
        Line(f"{word}: rms of that one record off, worst of three", float(np.abs(apart).max()), ""),
        Line(f"{word}: ratio, Lyapunov by SciPy", lyapunov_seconds / alone, "x"),
        at_most(f"{word}: variances off Lyapunov, Ms <= {ROBUST:g}", _lyapunov_error(loop, made, stable), "", 1e-8),
        Line(f"{word}: published search, 50 x 200", 1e3 * ours, "ms"),
        Line(f"{word}: the same in the time domain, written out", theirs, "s"),
        at_most(f"{word}: ratio to it", ours / theirs, "", 1e-3),
        Line(f"{word}: the same in the time domain, phi @ x ({SOME} generations scaled)", plainly, "s"),
        at_most(f"{word}: ratio to it", ours / plainly, "", 1e-3),
    ]


def _lyapunov_error(loop: TransferLoop, realisation: StateSpace, gains: np.ndarray) -> float:
    noise = disturbance_spectrum(lambda w: np.abs(SHAPED.frequency_response(w)) ** 2, 1e-4, 1e4, ROLL, "shaped noise")
    found = Performance(loop, noise, ROWS).evaluate(gains[:POOL])
    robust = np.flatnonzero(found.Ms <= ROBUST)
    exact = np.array([by_lyapunov(realisation, gains[i]) for i in robust])
    return float(np.abs(found.variances[robust] / exact - 1.0).max())
