"""A loop whose controller samples, holds its order and acts late: the plant as the controller sees it, exactly.

What lies between order and sample (servo, plant, sensor) behind a hold and a dead time is a rational function of z
(Astrom & Wittenmark 1997, Computer-Controlled Systems, 3rd ed., sections 2.3 and 2.4). Written in w, z = (1 + w T / 2)
/ (1 - w T / 2) (the same, section 8.3), the controller's blocks by Tustin's rule keep their coefficients, the unit
circle is the imaginary axis, and all that holds of loops in s holds of the sampled loop in w.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import eig, expm

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops.block import Block, controllable_form

MOST_SAMPLES = 40  # samples of dead time that are modelled; beyond, binomials leave no digits; chosen
_ROUNDING = 1e-9  # of a sample: a dead time that counts as a whole number of them
_FARTHEST_ZERO = 1e8  # in w T / 2: a zero beyond is one at infinity; rounding
_LEAST_HOLD = 1e-9  # of the hold's response, where it is zero: keeps quotients finite
_KEPT = 512  # sampled plants kept in memory: ships drawn from a fit are met again and again; chosen
_NYQUIST_SHARE = 0.999  # of the Nyquist frequency, up to which a sampled loop is looked at; chosen


@dataclass(frozen=True)
class Sampling:
    """How a controller works in time: its sample time [s], and the dead time [s] from its order to the servo.

    noise, resolution: of each sample of the output, its unit: rms of white noise, and the step of what is read.

    Raises:
        InputError: a time that is none, or a dead time of too many samples.
    """

    sample_s: float
    dead_time: float = 0.0
    noise: float = 0.0
    resolution: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.sample_s) and self.sample_s > 0.0 and 0.0 <= self.dead_time < math.inf):
            raise InputError(
                f"a sample time of {self.sample_s:g} s with a dead time of {self.dead_time:g} s is none; give a "
                "positive sample time and a dead time of zero or more"
            )
        if self.dead_time > MOST_SAMPLES * self.sample_s:
            raise InputError(
                f"a dead time of {self.dead_time:g} s is more than {MOST_SAMPLES} samples of {self.sample_s:g} s; give "
                f"a sample time of {self.dead_time / MOST_SAMPLES:.2g} s or more"
            )

    @property
    def noise_variance(self) -> float:
        """Return the variance of a sample's error; a step of reading adds its square over 12 (Widrow & Kollar 2008,
        Quantization Noise, section 1.1).
        """
        # 12: variance of a uniform error over a step of one
        return self.noise**2 + self.resolution**2 / 12.0

    @property
    def highest(self) -> float:
        """Return the frequency [rad/s] up to which the loop is looked at, just below the Nyquist frequency."""
        return _NYQUIST_SHARE * math.pi / self.sample_s

    def in_w(self, omega: Array) -> Array:
        """Return the imaginary part of w at true frequencies [rad/s], 2 / T tan(omega T / 2)."""
        return 2.0 / self.sample_s * np.tan(0.5 * self.sample_s * np.asarray(omega, dtype=np.float64))

    def from_w(self, w: Complex) -> Complex:
        """Return s = log(z) / T of points in w, (n,)."""
        half = 0.5 * self.sample_s * np.asarray(w, dtype=np.complex128)
        z = (1.0 + half) / np.where(half == 1.0, np.finfo(float).eps, 1.0 - half)
        made = np.log(np.where(z == 0.0, np.finfo(float).tiny, z)) / self.sample_s
        return np.asarray(made, dtype=np.complex128)

    def hold(self, omega: Array) -> Complex:
        """Return what hold and dead time do at true frequencies, (1 - exp(-s T)) / (s T) exp(-s T_d), (n,)."""
        half = 0.5 * self.sample_s * np.asarray(omega, dtype=np.float64)
        size = np.sinc(half / math.pi)
        kept = np.where(np.abs(size) < _LEAST_HOLD, _LEAST_HOLD, size)
        return np.asarray(kept * np.exp(-1j * (half + omega * self.dead_time)), dtype=np.complex128)

    @property
    def lag(self) -> Block:
        """Return hold and dead time as a lag in s: Pade's of second order for half a sample and the dead time.

        Exact to second order at low frequencies, as a loop around this one sees it.
        """
        T = 0.5 * self.sample_s + self.dead_time
        return Block("hold and dead time", (T**2 / 12.0, -T / 2.0, 1.0), (T**2 / 12.0, T / 2.0, 1.0))


def held(blocks: tuple[Block, ...], sampling: Sampling) -> Block:
    """Return blocks in a row behind hold and dead time, from order to sample, as a block in w."""
    return _held(tuple((block.num, block.den) for block in blocks), sampling)


@lru_cache(maxsize=_KEPT)
def _held(sides: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...], sampling: Sampling) -> Block:
    made = [Block("part", num, den) for num, den in sides]
    A, b, c, d = _in_a_row(made)
    T, whole, rest = sampling.sample_s, *_split(sampling)
    stepped, late, now = _stepped(A, b, T, rest)
    n, is_late = len(b), rest > 0.0
    poles: Complex = np.concatenate(
        [np.empty(0, dtype=np.complex128), *(np.tanh(0.5 * T * block.poles) for block in made)]
    )
    if is_late:
        stepped = np.block([[stepped, late[:, None]], [np.zeros((1, n + 1))]])
        now = np.concatenate([now, [1.0]])
        c, d = np.concatenate([c, [d]]), 0.0
        poles = np.concatenate([poles, [-1.0]])
    size = len(now)
    # z x = A x + b u, z = (1 + v) / (1 - v), v = w T / 2: v x = E x + (1 - v) B u (Astrom & Wittenmark, section 8.3)
    inverse = np.linalg.inv(np.eye(size) + stepped)
    E, B = inverse @ (stepped - np.eye(size)), inverse @ now
    # X = x + B u as state: v X = E X + (I - E) B u, y = c X + (d - c B) u
    zeros = _zeros(E, (np.eye(size) - E) @ B, c, float(d - c @ B)) if size else np.empty(0)
    numerator, denominator = np.atleast_1d(np.poly(zeros)).real, np.atleast_1d(np.poly(poles)).real
    at = 1j * _middle(poles)
    response = c @ np.linalg.solve(at * np.eye(size) - E, (1.0 - at) * B) + d if size else d
    numerator = numerator * (response / (np.polyval(numerator, at) / np.polyval(denominator, at))).real
    for _ in range(whole):
        numerator, denominator = np.polymul(numerator, [-1.0, 1.0]), np.polymul(denominator, [1.0, 1.0])
    num, den = (_in_seconds(np.asarray(side, dtype=np.float64), T) for side in (numerator, denominator))
    scale = den[0] if den[0] else 1.0
    return Block("held", tuple((num / scale).tolist()), tuple((den / scale).tolist()))


def _in_a_row(blocks: list[Block]) -> tuple[Array, Array, Array, float]:
    """Return A, b, c, d of blocks one behind the other."""
    A, b, c, d = np.zeros((0, 0)), np.zeros(0), np.zeros(0), 1.0
    for block in blocks:
        own_A, own_b, own_c, own_d = controllable_form(block)
        n, m = len(b), len(own_b)
        joined = np.zeros((n + m, n + m))
        joined[:n, :n], joined[n:, :n], joined[n:, n:] = A, np.outer(own_b, c), own_A
        A, b, c, d = joined, np.concatenate([b, own_b * d]), np.concatenate([own_d * c, own_c]), own_d * d
    return A, b, c, d


def _split(sampling: Sampling) -> tuple[int, float]:
    """Return the whole samples of the dead time, and the rest [s]."""
    samples = sampling.dead_time / sampling.sample_s
    whole = math.floor(samples + _ROUNDING)
    rest = samples - whole
    return whole, rest * sampling.sample_s if rest > _ROUNDING else 0.0


def _stepped(A: Array, b: Array, T: float, late: float) -> tuple[Array, Array, Array]:
    """Return exp(A T), and what the order before and the one now do in a step: the former acts for `late` seconds."""
    first, began = _step(A, b, late)
    second, now = _step(A, b, T - late)
    return second @ first, second @ began, now


def _step(A: Array, b: Array, dt: float) -> tuple[Array, Array]:
    """Return exp(A dt) and its integral times b (Van Loan 1978, IEEE Trans. Autom. Control 23(3), 395-404)."""
    n = len(b)
    joined = np.zeros((n + 1, n + 1))
    joined[:n, :n], joined[:n, n] = A * dt, b * dt
    made = np.asarray(expm(joined), dtype=np.float64)
    return made[:n, :n], made[:n, n]


def _zeros(A: Array, b: Array, c: Array, d: float) -> Complex:
    """Return the finite zeros of a system: where [[A - v, b], [c, d]] is singular (Kailath 1980, section 6.5)."""
    n = len(b)
    size = float(np.max(np.abs(b), initial=0.0)) or 1.0
    outer = np.zeros((n + 1, n + 1))
    outer[:n, :n] = np.eye(n)
    system = np.block([[A, (b / size)[:, None]], [c[None, :], np.array([[d / size]])]])
    found = eig(system, outer, right=False, homogeneous_eigvals=True)
    above, below = np.asarray(found[0]), np.asarray(found[1])
    finite = np.abs(below) * _FARTHEST_ZERO > np.abs(above)
    return np.asarray(above[finite] / below[finite], dtype=np.complex128)


def _middle(poles: Complex) -> float:
    """Return a frequency in v at which the response is compared: the mean size of the poles off the origin."""
    sizes = np.abs(poles)
    some = sizes[sizes > 0.0]
    return float(np.exp(np.mean(np.log(some)))) if some.size else 1.0


def _in_seconds(coefficients: Array, T: float) -> Array:
    """Return a polynomial in v = w T / 2 as one in w [1/s], highest power first."""
    powers = np.arange(len(coefficients) - 1, -1, -1)
    return coefficients * (0.5 * T) ** powers
