"""A feedback loop of blocks, rational in s and linear in its gains; continuous, or with a controller that samples."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, reduce
from typing import Self

import numpy as np
from scipy.linalg import eig, expm

from seatrial.core.values import Array, Index, InputError, Parameters, frozen
from seatrial.physics.hydro.excitation import Complex

# A transfer function of real coefficients: one block of a diagram.

_LEAST_SIZE = 1e-3  # rad/s, least scale of the states; chosen


@dataclass(frozen=True)
class Block:
    """num(s) / den(s), coefficients of s [rad/s] with the highest power first.

    Raises:
        InputError: a coefficient is not finite, the denominator is zero, or the numerator is of higher degree.
    """

    name: str
    num: tuple[float, ...] = (1.0,)
    den: tuple[float, ...] = (1.0,)
    source: str = ""

    def __post_init__(self) -> None:
        for side in ("num", "den"):
            given = tuple(float(c) for c in getattr(self, side))
            if not given or not all(math.isfinite(c) for c in given):
                raise InputError(f"block '{self.name}': '{side}' needs finite coefficients, highest power first")
            first = next((i for i, c in enumerate(given) if c != 0.0), len(given) - 1)
            object.__setattr__(self, side, given[first:])
        if self.den == (0.0,):
            raise InputError(
                f"block '{self.name}': the denominator is zero; give its coefficients, highest power first"
            )
        if len(self.num) > len(self.den):
            raise InputError(
                f"block '{self.name}': the numerator is of degree {len(self.num) - 1}, the denominator of "
                f"{len(self.den) - 1} only; add the lag that every real block has"
            )

    @property
    def order(self) -> int:
        """Number of its states."""
        return len(self.den) - 1

    @cached_property
    def poles(self) -> Complex:
        """Roots of the denominator, rad/s."""
        return np.asarray(np.roots(self.den), dtype=np.complex128)

    @property
    def gain(self) -> float:
        """At s = 0; infinite where it integrates."""
        return self.num[-1] / self.den[-1] if self.den[-1] else math.inf

    def frequency_response(self, omega: Array) -> Complex:
        """Return the frequency response at omega [rad/s], any shape."""
        s = np.asarray(1j * np.asarray(omega, dtype=np.float64), dtype=np.complex128)
        return np.asarray(_polynomial(self.num, s) / _polynomial(self.den, s), dtype=np.complex128)

    def scaled(self, factor: float) -> "Block":
        """Return the block times a number."""
        return Block(self.name, tuple(factor * c for c in self.num), self.den, self.source)

    def stretched(self, factor: float) -> "Block":
        """Return P(factor s): all time constants times the factor."""
        num, den = (
            tuple(c * factor ** (len(side) - 1 - i) for i, c in enumerate(side)) for side in (self.num, self.den)
        )
        return Block(self.name, num, den, self.source)


def _polynomial(coefficients: tuple[float, ...], s: Complex) -> Complex:
    """Return a polynomial, highest power first, at points of any shape, by Horner's rule in place."""
    value = np.full_like(s, coefficients[0])
    for coefficient in coefficients[1:]:
        value *= s
        value += coefficient
    return value


def in_series(name: str, blocks: Iterable[Block]) -> Block:
    """Return the product of blocks; nothing cancels."""
    num, den = np.ones(1), np.ones(1)
    for block in blocks:
        num, den = np.convolve(num, block.num), np.convolve(den, block.den)
    return Block(name, tuple(num), tuple(den))


def controllable_form(block: Block) -> tuple[Array, Array, Array, float]:
    """Return A, b, c, d of a block: controllable form with each state scaled by the size of the poles."""
    den = np.array(block.den) / block.den[0]
    num = np.concatenate([np.zeros(len(den) - len(block.num)), np.array(block.num) / block.den[0]])
    n, d = block.order, float(num[0])
    size = max(float(np.abs(den[-1])) ** (1.0 / n), _LEAST_SIZE) if n and den[-1] else 1.0
    powers = size ** np.arange(n)
    A = np.diag(np.full(max(n - 1, 0), size), -1) if n else np.zeros((0, 0))
    b = np.zeros(n)
    if n:
        A[0] = -den[1:] / powers
        b[0] = 1.0
    return A, b, (num[1:] - d * den[1:]) / powers, d


# A loop whose controller samples, holds its order and acts late: the plant as the controller sees it, exactly.

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
    return _held(blocks, sampling)


@lru_cache(maxsize=_KEPT)
def _held(blocks: tuple[Block, ...], sampling: Sampling) -> Block:
    A, b, c, d = _in_a_row(blocks)
    T, whole, rest = sampling.sample_s, *_split(sampling)
    stepped, late, now = _stepped(A, b, T, rest)
    n, is_late = len(b), rest > 0.0
    poles: Complex = np.concatenate(
        [np.empty(0, dtype=np.complex128), *(np.tanh(0.5 * T * block.poles) for block in blocks)]
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
        numerator, denominator = np.convolve(numerator, [-1.0, 1.0]), np.convolve(denominator, [1.0, 1.0])
    num, den = (_in_seconds(np.asarray(side, dtype=np.float64), T) for side in (numerator, denominator))
    scale = den[0] if den[0] else 1.0
    return Block("held", tuple((num / scale).tolist()), tuple((den / scale).tolist()))


def _in_a_row(blocks: tuple[Block, ...]) -> tuple[Array, Array, Array, float]:
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
    if not late:
        stepped, now = held_step(A, b, T)
        return stepped, np.zeros(len(b)), now
    first, began = held_step(A, b, late)
    second, now = held_step(A, b, T - late)
    return second @ first, second @ began, now


def held_step(A: Array, b: Array, dt: float) -> tuple[Array, Array]:
    """Return exp(A dt) and what an input does that is held over the step.

    The latter is the integral of the former times b (Van Loan 1978, IEEE Trans. Autom. Control 23(3), 395-404).
    """
    n = len(b)
    joined = np.zeros((n + 1, n + 1))
    joined[:n, :n], joined[:n, n] = A * dt, b * dt
    stepped = np.asarray(expm(joined), dtype=np.float64)
    return stepped[:n, :n], stepped[:n, n]


def straight_step(A: Array, b: Array, dt: float) -> tuple[Array, Array, Array]:
    """Return exp(A dt) and what an input does that runs straight over the step, by its values at both ends.

    As `held_step`, with the input's slope as a further state (Franklin, Powell & Workman 1998, section 6.3).
    """
    n = len(b)
    joined = np.zeros((n + 2, n + 2))
    joined[:n, :n], joined[:n, n], joined[n, n + 1] = A * dt, b * dt, 1.0
    stepped = np.asarray(expm(joined), dtype=np.float64)
    return stepped[:n, :n], stepped[:n, n] - stepped[:n, n + 1], stepped[:n, n + 1]


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


# A feedback loop that is rational in s and linear in its gains.


@dataclass(frozen=True)
class Term:
    """One part of the controller: the gain of that name times the block."""

    gain: str
    block: Block


@dataclass(frozen=True)
class HullPoint:
    """The downward motion of the hull x metres forward of its origin, z - x theta, that the actuator also makes.

    plant: from the actuator to it.
    """

    x: float
    plant: Block


@dataclass(frozen=True, eq=False)
class TransferLoop:
    """Negative feedback from an output y to the actuator a that moves it, against a disturbance w.

        y = P a + D w,   a = -K y,   K = servo * filters * (sum of gain_i term_i) * sensor,   L = P K,   S = 1 / (1 + L)

    so that y = D S w, a = -K D S w. Angles are radians, gains as the field gives them.

    Attributes:
        sensor: from y to what the terms see; filters: common to all terms (notches); servo: from order to actuator.
        terms: parallel, one for each gain.
        plant: P, from the actuator to the output; disturbance: D, from w to the output.
        gains: one parameter for each term, in order: value, bounds, free or fixed.
        output, actuator, disturbance_input: symbols of y, a and w.
        points: what the actuator also moves, to be made small but not fed back.
        sampling: how the controller samples and holds, and the actuator's dead time; None: a controller in continuous
            time, without either. Of a sampled loop polynomials are those in w (see `Sampling`), with S
            and L at the samples; frequencies and closed-loop poles are true ones.

    Raises:
        InputError: gains and terms do not go together, or a gain lacks a bound.
    """

    name: str
    sensor: tuple[Block, ...]
    terms: tuple[Term, ...]
    filters: tuple[Block, ...]
    servo: tuple[Block, ...]
    plant: Block
    disturbance: Block
    gains: Parameters
    output: str = "phi"
    actuator: str = "alpha_f"
    disturbance_input: str = "alpha_w"
    points: tuple[HullPoint, ...] = ()
    sampling: Sampling | None = None

    def __post_init__(self) -> None:
        if tuple(term.gain for term in self.terms) != self.gains.names or not self.terms:
            raise InputError(f"loop '{self.name}': give one gain for each term of the controller, in the same order")
        for gain in self.gains.free:
            if not np.isfinite(gain.upper - gain.lower):
                raise InputError(f"loop '{self.name}': gain {gain.name} needs finite bounds to be tuned")

    @property
    def gain_values(self) -> Array:
        """The gains, shape (g,)."""
        return self.gains.values

    def with_gains(self, values: Array) -> Self:
        """Return the same loop with all gains given, shape (g,)."""
        return replace(self, gains=self.gains.with_values(dict(zip(self.gains.names, values, strict=True))))

    @property
    def required_sampling(self) -> Sampling:
        """How the controller samples.

        Raises:
            InputError: the loop does not say.
        """
        if self.sampling is None:
            raise InputError(f"loop '{self.name}' takes no samples; give it sampling = Sampling(sample_s)")
        return self.sampling

    @property
    def continuous(self) -> Self:
        """Return the loop in continuous time: hold and dead time of a sampled one are a lag of its servo."""
        if self.sampling is None:
            return self
        return replace(self, servo=(*self.servo, self.sampling.lag), sampling=None)

    @cached_property
    def chain(self) -> Block:
        """Everything of L but the terms: sensor, filters, servo, plant; in w where the loop is sampled."""
        if self.sampling is not None:
            return in_series("chain", (*self.filters, self._held))
        return in_series("chain", (*self.sensor, *self.filters, *self.servo, self.plant))

    @cached_property
    def _held(self) -> Block:
        """From order to sample in w, of a sampled loop."""
        return held((*self.servo, self.plant, *self.sensor), self.required_sampling)

    @cached_property
    def _filtered(self) -> Block:
        """What acts on all terms in the controller."""
        return in_series("filters", self.filters)

    @cached_property
    def _around(self) -> Block:
        """What of sensor and servo is not part of the sampled controller."""
        return in_series("common", (*self.sensor, *self.servo))

    @cached_property
    def polynomials(self) -> tuple[Array, Array]:
        """d(s), shape (n + 1,), and n_i(s), shape (g, n + 1), highest power first: L = sum gain_i n_i / d.

        The closed loop has the characteristic polynomial d + sum gain_i n_i. Nothing cancels.
        """
        dens = list(dict.fromkeys(term.block.den for term in self.terms))
        common = reduce(np.convolve, dens, np.array(self.chain.den))
        numerators = np.zeros((len(self.terms), len(common)))
        for row, term in zip(numerators, self.terms, strict=True):
            others = [den for den in dens if den != term.block.den]
            made = np.atleast_1d(reduce(np.convolve, [term.block.num, *others], np.array(self.chain.num)))
            row[len(row) - len(made) :] = made
        return frozen(common), frozen(numerators)

    @cached_property
    def _integrating_terms(self) -> tuple[tuple[int, Index], ...]:
        """Poles at the origin that terms of one denominator have, and which terms those are."""
        made = []
        for den in dict.fromkeys(term.block.den for term in self.terms):
            at_origin = len(den) - len(np.trim_zeros(den, "b"))
            if at_origin:
                made.append((at_origin, np.flatnonzero([term.block.den == den for term in self.terms])))
        return tuple(made)

    def idle_integrators(self, gains: Array) -> Index:
        """Return how many poles at the origin are those of terms whose gains are all zero, of gains (m, g), (m,).

        Such a term moves nothing: d and the n_i of the others have the factor s so many times, which is left out.
        """
        idle = np.zeros(len(gains), dtype=np.int64)
        for at_origin, terms in self._integrating_terms:
            idle += at_origin * ~gains[:, terms].any(axis=1)
        return idle

    def fraction(self, gains: Array) -> tuple[Array, Array]:
        """Return numerator and denominator of L at gains (g,), of equal length, without idle integrators.

        Their sum is the characteristic polynomial of the closed loop.
        """
        d, n = self.polynomials
        count = len(d) - int(self.idle_integrators(gains[None])[0])
        return np.asarray(gains @ n)[:count], d[:count]

    def controller_terms(self, omega: Array) -> Complex:
        """Return what each gain multiplies between y and a, shape (g, n), at omega (n,) [rad/s]."""
        return self.term_responses(omega) * self._around_response(omega)

    def open_loop_terms(self, omega: Array) -> Complex:
        """Return L_i, shape (g, n): L = sum gain_i L_i."""
        return self.term_responses(omega) * self.path_response(omega)

    def path_response(self, omega: Array) -> Complex:
        """Return everything of L but terms and filters, (n,), at omega (n,) [rad/s]."""
        if self.sampling is None:
            return np.asarray(self._around_response(omega) * self.plant.frequency_response(omega), dtype=np.complex128)
        return self._held.frequency_response(self.sampling.in_w(omega))

    def plant_response(self, omega: Array) -> Complex:
        """Return P at omega (n,) [rad/s] so that L = P K: of a sampled loop what of the plant its samples show."""
        if self.sampling is None:
            return self.plant.frequency_response(omega)
        seen = self._held.frequency_response(self.sampling.in_w(omega))
        return np.asarray(seen / self._around_response(omega), dtype=np.complex128)

    def misreading_paths(self, omega: Array) -> tuple[Complex, Complex]:
        """Return output and actuator for an error in each sample of a sampled loop, over -L S, each (n,).

        It stands before the sensor until the next sample. Without a sensor they are 1 and 1 / P.
        """
        sampling = self.required_sampling
        w = sampling.in_w(omega)
        seen = self._held.frequency_response(w)
        misread = held(self.sensor, replace(sampling, dead_time=0.0)).frequency_response(w) / seen
        moved = in_series("servo", self.servo).frequency_response(omega) * sampling.hold(omega)
        moving = held((*self.servo, self.plant), sampling).frequency_response(w)
        return moving * misread, moved * misread

    def term_responses(self, omega: Array) -> Complex:
        """Return terms and filters, shape (g, n), at omega (n,) [rad/s]."""
        at = omega if self.sampling is None else self.sampling.in_w(omega)
        common = self._filtered.frequency_response(at)
        return np.stack([term.block.frequency_response(at) * common for term in self.terms])

    def _around_response(self, omega: Array) -> Complex:
        """Return sensor, servo, hold and dead time, (n,)."""
        made = self._around.frequency_response(omega)
        return made if self.sampling is None else np.asarray(made * self.sampling.hold(omega), dtype=np.complex128)

    def open_loop(self, omega: Array) -> Complex:
        """Return L at its gains, shape (n,)."""
        return self.gain_values @ self.open_loop_terms(omega)

    @property
    def closed_loop_poles(self) -> Complex:
        """Roots of the characteristic polynomial at the loop's gains, rad/s."""
        found = np.asarray(np.roots(np.add(*self.fraction(self.gain_values))), dtype=np.complex128)
        return found if self.sampling is None else self.sampling.from_w(found)
