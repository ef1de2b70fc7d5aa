"""What the likelihood of the true disturbance admits on a record of a linear craft: standard errors at the truth.

A Kalman filter of craft, gusts and waves (Ljung 1999, System Identification, section 7.4, innovations) with every
disturbance known; K, T, the rudder's zero and, within a sample, the moment at which it took effect are not. The
information of Gaussian innovations e of covariance S is the sum of e_i' S^-1 e_j + tr(S^-1 S_i S^-1 S_j) / 2,
subscripts for derivatives (Kay 1993, Fundamentals of Statistical Signal Processing: Estimation Theory, eq. (3.31)).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm
from simulated_seas import (
    RESOLUTION,
    Array,
    Conditions,
    Craft,
    SimulatedRun,
    discretised,
    disturbances,
    force_rows,
    sensor_rows,
)

UNKNOWN = ("K", "T", "zero", "delay")
STEPS = (1e-4, 1e-3, 1e-5, 1e-3)  # 1/s, s, rad, s: central differences, some 1e-3 of a standard error and more; chosen
SETTLED = 1e-9  # 1, relative change of every covariance over a sample below which the filter is constant; chosen
START = (0.05, 1.0)  # rad/s, rad: standard deviations of the state at the start, as good as none; chosen


@dataclass(frozen=True, eq=False)
class _Filters:
    """A filter for each set of `UNKNOWN`, (n, ...): transition, both input columns, covariances, rows of outputs."""

    F: Array
    g: Array
    Q: Array
    P: Array
    H: Array
    R: Array
    zero: Array
    delay: Array


@dataclass(frozen=True, eq=False)
class Likelihood:
    """Of a record at the truth: information on `UNKNOWN`, (4, 4), its score, (4,), and innovations squared, (rows,).

    squared: e' S^-1 e, its mean the number of channels where filter and simulator agree.
    """

    information: Array
    score: Array
    squared: Array


def standard_errors(craft: Craft, conditions: Conditions, run: SimulatedRun) -> dict[str, float]:
    """Return standard errors of K and T; empty where positions are measured or the craft is not of first order."""
    if craft.name != "nomoto" or "x0" in conditions.channels:
        return {}
    information = likelihood(craft, conditions, run).information
    information[3, 3] += 12.0 / run.step**2  # a delay is known to lie within a sample, as `identify` assumes
    deviations = np.sqrt(np.diag(np.linalg.inv(information)))
    return {name: float(d) for name, d in zip(UNKNOWN[:2], deviations, strict=False)}


def likelihood(craft: Craft, conditions: Conditions, run: SimulatedRun) -> Likelihood:
    """Return what the likelihood of the true disturbance says at the truth."""
    truth = np.array([craft.truth["K"], craft.truth["T"], conditions.zero, 0.0])
    points = np.vstack([truth, *(truth + sign * np.diag(STEPS) for sign in (1.0, -1.0))])
    return _likelihood(_filters(craft, conditions, run.step, points), run)


def _filters(craft: Craft, conditions: Conditions, step: float, points: Array) -> _Filters:
    D, noise = disturbances(conditions.sea)
    length = craft.ship.particulars["L"]
    angle, rate = (rows[2] for rows in sensor_rows(conditions.sea, length))
    push = force_rows(conditions, craft)[2]
    used = np.flatnonzero((angle != 0.0) | (rate != 0.0) | (push != 0.0))
    used = np.unique(
        np.concatenate([used, *([[3 + 2 * ((i - 3) // 2), 4 + 2 * ((i - 3) // 2)] for i in used if i > 2])])
    )
    used = used.astype(int)
    m = len(used)
    outputs = [n for n in ("psi", "r") if n in conditions.channels]
    H = np.array([np.r_[angle[used], 0.0, 1.0] if n == "psi" else np.r_[rate[used], 1.0, 0.0] for n in outputs])
    R = np.diag([craft.noise[n] ** 2 + (RESOLUTION**2 / 12.0 if n == "psi" else 0.0) for n in outputs])
    stationary = [
        1.0 if i < 3 or (i - 3) % 2 == 0 else conditions.sea.frequencies[((i - 3) // 2) % 2] ** 2 for i in used
    ]
    P = np.diag([*stationary, START[0] ** 2, START[1] ** 2])
    rows = []
    for K, T, _, _ in points:
        A = np.zeros((m + 2, m + 2))
        A[:m, :m] = D[np.ix_(used, used)]
        A[m, :m], A[m, m], A[m + 1, m] = push[used], -1.0 / T, 1.0
        size = np.zeros_like(A)
        size[:m, :m] = noise[np.ix_(used, used)]
        F, Q = discretised(A, size, step)
        ramp = np.zeros((m + 4, m + 4))
        ramp[: m + 2, : m + 2], ramp[m, m + 2], ramp[m + 2, m + 3] = A, K / T, 1.0
        rows.append((F, expm(ramp * step)[: m + 2, m + 2 :], Q))
    F, g, Q = (np.array(part) for part in zip(*rows, strict=True))
    return _Filters(F, g, Q, np.tile(P, (len(points), 1, 1)), H, R, points[:, 2], points[:, 3])


@dataclass(frozen=True, eq=False)
class _Covariances:
    """Of a sample: S^-1 at the truth, S^-1 dS by unknown, (4, m, m), and the gain of each filter."""

    inverse: Array
    weighed: Array
    gain: Array


def _covariances(f: _Filters) -> Iterator[_Covariances]:
    """Return covariances sample by sample, always the same ones once they have settled."""
    P, settled, widths = f.P, False, 2.0 * np.array(STEPS)
    while True:
        PH = P @ f.H.T
        S = f.H @ PH + f.R
        inverse, gain = np.linalg.inv(S[0]), PH @ np.linalg.inv(S)
        sample = _Covariances(inverse, inverse @ (S[1:5] - S[5:9]) / widths[:, None, None], gain)
        yield sample
        while settled:
            yield sample
        before = P
        P = f.F @ (P - gain @ np.swapaxes(PH, 1, 2)) @ np.swapaxes(f.F, 1, 2) + f.Q
        P = 0.5 * (P + np.swapaxes(P, 1, 2))
        settled = np.allclose(P, before, rtol=SETTLED, atol=0.0)


def _likelihood(f: _Filters, run: SimulatedRun) -> Likelihood:
    record = run.record
    names = ["psi", "r"] if "r" in record.channels else ["psi"]
    y, delta = np.stack([record[n] for n in names], axis=1), record["delta"]
    x = np.zeros((len(f.F), f.F.shape[1]))
    x[:, -1] = y[0, 0]
    total, score, widths, squared = np.zeros((4, 4)), np.zeros(4), 2.0 * np.array(STEPS), np.zeros(len(y))
    slopes = np.append(np.diff(delta) / run.step, 0.0)
    turning = 0.5 * (slopes + np.concatenate([[0.0], slopes[:-1]]))  # rad/s, of the rudder at a sample
    for k, at in zip(range(len(y)), _covariances(f), strict=False):
        e = y[k] - x @ f.H.T
        de, error = (e[1:5] - e[5:9]) / widths[:, None], at.inverse @ e[0]
        total += de @ at.inverse @ de.T + 0.5 * np.einsum("aij,bji->ab", at.weighed, at.weighed)
        score += -de @ error + 0.5 * ((at.weighed @ error) @ e[0] - np.trace(at.weighed, axis1=1, axis2=2))
        squared[k] = e[0] @ error
        x = x + (at.gain @ e[:, :, None])[:, :, 0]
        rudder = delta[k] - turning[k] * f.delay + f.zero
        x = (f.F @ x[:, :, None])[:, :, 0] + f.g[:, :, 0] * rudder[:, None] + f.g[:, :, 1] * slopes[k]
    return Likelihood(total, score, squared)
