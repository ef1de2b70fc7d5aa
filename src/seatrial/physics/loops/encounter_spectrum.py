"""How waves enter a loop, and the energy of the output without control over the frequencies at which they are met."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Protocol

import numpy as np
from scipy.special import bernoulli

from seatrial.core.values import Array, InputError, frozen
from seatrial.physics.hydro.excitation import Complex, Excitation, G, encounter_frequency
from seatrial.physics.loops.loop import Block
from seatrial.physics.sea.spectrum import Spectrum, speed_factor

# Quadrature: trapezoids with corrected ends, and many nodes condensed on few.

_ORDER = 8  # of the end correction of the trapezoidal rule (Gregory, Euler-Maclaurin); chosen
_END_WEIGHTS = 1.0 + np.linalg.solve(
    np.vander(np.arange(float(_ORDER)), increasing=True).T, bernoulli(_ORDER)[1:] / np.arange(1.0, _ORDER + 1.0)
)
# rad/s: below, gathered nodes are even in frequency, above in its logarithm
_LINEAR_BELOW = 0.05
_KEPT = 64  # grids kept in memory: all directions of a sea share theirs; chosen


def weights(count: int) -> Array:
    """Of trapezoids (count,), 16 or more, in steps: of order 8 at both ends (Gregory 1670; Euler-Maclaurin)."""
    made = np.ones(count)
    made[:_ORDER] *= _END_WEIGHTS
    made[: -_ORDER - 1 : -1] *= _END_WEIGHTS
    return made


@lru_cache(maxsize=_KEPT)
def nodes(edges: tuple[float, ...], count: int) -> tuple[Array, Array]:
    """Return `count` nodes, as many between all edges, even in their logarithm, and the width that each stands for."""
    made: list[Array] = []
    width: list[Array] = []
    own = count // (len(edges) - 1)
    for low, high in pairwise(np.log(edges)):
        u, step = np.linspace(low, high, own, retstep=True)
        made.append(np.exp(u))
        width.append(made[-1] * weights(own) * step)
    return frozen(np.concatenate(made)), frozen(np.concatenate(width))


def gather_nodes(omega: Array, rows: Array, count: int) -> tuple[Array, Array]:
    """Return the same sums over energies (r, n) on `count` nodes: each goes to its eight neighbours by Lagrange.

    What is summed must be smooth over arsinh(20 omega), as the response of a loop is. Single energies may come out
    negative.
    """
    x = np.arcsinh(omega / _LINEAR_BELOW)
    step = float(x.max()) / (count - 0.5)
    # the first one stands half a step from zero, where plants may integrate
    at = x / step - 0.5
    first = np.clip(np.floor(at).astype(int) - _ORDER // 2 + 1, 0, count - _ORDER)
    u, place = at - first, np.arange(_ORDER)
    made = np.zeros((len(rows), count))
    for j in place:
        others = place[place != j]
        share = np.prod((u[:, None] - others) / (j - others), axis=1)
        made += [np.bincount(first + j, share * energy, count) for energy in rows]
    return _LINEAR_BELOW * np.sinh((np.arange(count) + 0.5) * step), made


# How waves enter a loop: complex amplitudes of what disturbs it, per metre of wave, at a speed and heading.

_ACROSS = 1e-9  # |sin(heading)| and |cos(heading)| that count as none: rounding
_DEEPEST = 18.0  # k T beyond which the energy exp(-k T) that reaches half the draught is below 2e-8; chosen


class WaveEffect(Protocol):
    """What a metre of wave does to a loop: `name` in words, `frequency_range` [rad/s] outside which it does nothing.

    Amplitudes are in quadrature or in phase with the elevation amidships, which only a simulation heeds.
    """

    @property
    def name(self) -> str:
        """Of the effect, in words."""
        ...

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Wave frequencies [rad/s] outside which the effect is negligible, or not known; infinite where it never is."""
        ...

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:
        """Return the amplitude per metre of wave, (n,), at wave frequencies omega [rad/s], U [m/s], beta [rad]."""
        ...


@dataclass(frozen=True)
class WaveSlope:
    """The slope of the waves across the ship [rad], of a point."""

    name = "wave slope across the ship"
    frequency_range = 0.0, math.inf

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:  # noqa: ARG002
        """Return i k |sin(beta)| of each wave, as of `WaveEffect`."""
        return np.asarray(1j * omega**2 / G * _sine_across(beta), dtype=np.complex128)


@dataclass(frozen=True)
class HullFactor:
    """The effective slope [rad]: that of waves averaged over a box of length L, breadth B, draught T [m].

    F = exp(-k T / 2) sinc(k B sin(beta) / 2) sinc(k L cos(beta) / 2), sinc(x) = sin(x) / x: the mean over half the
    draught, the breadth and the length, Froude-Krylov, of a box (Lloyd 1989, Seakeeping, effective wave slope).
    """

    L: float
    B: float
    T: float

    name = WaveSlope.name

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Zero, and the wave frequency [rad/s] whose energy exp(-k T) is below 2e-8."""
        return 0.0, _deepest_frequency(self.T)

    def slope_factor(self, omega: Array, beta: float) -> Array:
        """Return F [-] at wave frequencies omega [rad/s] and heading beta [rad, 0 following]."""
        k = omega**2 / G
        across, along = k * self.B * math.sin(beta) / (2.0 * math.pi), k * self.L * math.cos(beta) / (2.0 * math.pi)
        return np.exp(-k * self.T / 2.0) * np.sinc(across) * np.sinc(along)

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:
        """Return i k |sin(beta)| F of each wave, as of `WaveEffect`."""
        return WaveSlope().amplitude(omega, U, beta) * self.slope_factor(omega, beta)


@dataclass(frozen=True)
class YawAcceleration:
    """The yaw acceleration [rad/s^2] that waves give a hull of length L and draught T [m].

    Every section feels Froude-Krylov and added-mass force of the water's lateral acceleration at half the draught
    (long-wave approximation: Faltinsen 1990, Sea Loads on Ships and Offshore Structures, chapter 3):
    dY/dx = (m' + a') omega^2 a sin(beta) exp(-k T / 2) exp(-i k x cos(beta)). With mass and added mass even along the
    length the moment over the inertia (m' + a') L^3 / 12 is omega^2 k sin(beta) cos(beta) exp(-k T / 2) 3 j1(s) / s,
    s = k L cos(beta) / 2. Sway and what its damping turns into yaw are left out.
    """

    L: float
    T: float

    name = "yaw moment of the waves"

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Zero, and the wave frequency [rad/s] whose energy exp(-k T) is below 2e-8."""
        return 0.0, _deepest_frequency(self.T)

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:  # noqa: ARG002
        """Return the amplitude as of `WaveEffect`, in phase with the slope along the ship."""
        from scipy.special import spherical_jn

        k = omega**2 / G
        across, along = math.sin(beta), math.cos(beta)
        if min(abs(across), abs(along)) < _ACROSS:
            return np.zeros(len(k), dtype=np.complex128)
        s = 0.5 * k * self.L * abs(along)
        # 3 j1(s) / s is one for waves much longer than the hull
        averaged = np.exp(-0.5 * k * self.T) * 3.0 * spherical_jn(1, s) / s
        return np.asarray(-1j * omega**2 * k * across * along * averaged, dtype=np.complex128)


def _sine_across(beta: float) -> float:
    sine = abs(math.sin(beta))
    return sine if sine > _ACROSS else 0.0


def _deepest_frequency(T: float) -> float:
    return math.sqrt(_DEEPEST * G / T)


# What a sea does to a ship without control: energy of the output over the frequencies at which waves are met.

_DIRECTIONS = 513  # directions of a short-crested sea on the finest grid; chosen
_MIN_NODES, _REDUCED_NODES, _MAX_NODES = 48, 512, 12288  # frequencies: first grid, reduced grid, finest grid; chosen
_ACCURACY, _ACCURACY_OF_REDUCED = 1e-10, 1e-9  # relative, of variances on all nodes and on the reduced ones; chosen
# relative, of variances over directions and in one of them; chosen
_ACCURACY_OF_DIRECTIONS, _ACCURACY_OF_ONE = 1e-6, 1e-8
_NEGLIGIBLE_EXPONENT = 36.0  # exp(-36) is 2e-16, rounding
_DAMPING_DIVISOR = 2.0  # of the sharpened response: feedback may leave half of the damping; chosen
_HELD_POLE = 0.01  # rad/s: an integrator that feedback holds is taken to be no faster; chosen
_LOWEST_FREQUENCY = 1e-9  # rad/s: a wave that keeps up with the ship
_NO_EFFECT = 1e-12  # share of the sea's variance that counts as none: rounding
_REACH = 12.0  # highest wave frequency over the modal one, as said above
WAVE_SLOPE = WaveSlope()
_KEPT_RESPONSES = 16  # blocks whose sharpened form is kept: every direction of a sea takes it; chosen
_FIRST_STRIDE = 8  # directions left out between those of the first grid; chosen


@dataclass(frozen=True, eq=False)
class PointSpectrum:
    """What a sea does at a point while the actuator rests, q, beside the disturbance w of the loop; both (n,).

    energy: shares of the variance of q; cross: shares of E[q conj(w)], complex amplitudes at |omega_e|.
    """

    energy: Array
    cross: Complex


@dataclass(frozen=True, eq=False)
class EncounterSpectrum:
    """A disturbance that a loop meets, node by node of a quadrature.

    Attributes:
        omega_e: |frequency of encounter| [rad/s]; energy: share of the disturbance's variance at each node [unit^2],
            both (n,); single ones may be negative where many nodes were gathered on few.
        description: the sea in words.
        points: what the same sea does at the loop's points, in their order.
    """

    omega_e: Array
    energy: Array
    description: str = ""
    points: tuple[PointSpectrum, ...] = ()

    @property
    def variance(self) -> float:
        """Of the disturbance."""
        return float(np.sum(self.energy))

    def response_variance(self, block: Block) -> float:
        """Return the variance of what the block makes of the disturbance."""
        return float(np.sum(np.abs(block.frequency_response(self.omega_e)) ** 2 * self.energy))

    def mean_frequency(self, block: Block) -> float:
        """Return the mean of omega_e [rad/s] over the energy of what the block makes of the disturbance."""
        energy = np.abs(block.frequency_response(self.omega_e)) ** 2 * self.energy
        return float(np.sum(self.omega_e * energy) / np.sum(energy))


def sea_disturbance(
    spectrum: Spectrum,
    U: float,
    beta: float,
    response: Block,
    effect: WaveEffect = WAVE_SLOPE,
    *,
    spreading: float | None = None,
    at_points: tuple[WaveEffect, ...] = (),
) -> EncounterSpectrum:
    """Return what the waves of a sea do to a loop, |effect|^2 S(omega): by default their slope across the ship [rad].

    Args:
        U: m/s; beta: rad, 0 following, pi / 2 beam, pi head.
        response: from the disturbance to the motion; nodes suffice for variances of its angle and rate with half of its
            damping. A loop much nearer to instability, or slower, is resolved by its own closed-loop response D S.
        spreading: exponent s of a short-crested sea, cos^2s over +- 90 deg; None: long-crested.
        at_points: what the waves do at the loop's points.

    Raises:
        InputError: speed, heading or spreading out of sense, or a sea without any effect on the loop.
    """
    effects = (effect, *at_points)
    said = f"{spectrum.name}, {math.degrees(beta):.0f} deg"
    if spreading is None:
        nodes = _long_crested_nodes(spectrum, U, beta, response, effects, _ACCURACY)
        made = _from_rows(*_reduced_nodes(*nodes, response, _ACCURACY_OF_REDUCED), said)
    else:
        nodes = _ShortCrestedNodes(spectrum, U, beta, response, effects, spreading).converged_nodes()
        made = _from_rows(*_reduced_nodes(*nodes, response, _ACCURACY_OF_DIRECTIONS), f"{said}, short-crested")
    if not made.variance > _NO_EFFECT * spectrum.moment(0):
        raise InputError(
            f"the sea has no {effect.name} at a heading of {math.degrees(beta):.0f} deg; "
            "take another heading, or a short-crested sea"
        )
    return made


def disturbance_spectrum(
    density: Callable[[Array], Array], lower: float, upper: float, response: Block, description: str
) -> EncounterSpectrum:
    """Return exposure to a disturbance of one-sided `density` [unit^2 s/rad] over the frequency of encounter itself."""
    nodes = _converged_nodes(lambda w: density(w)[None], lambda w: w, (lower, upper), response, _ACCURACY)
    return _from_rows(*nodes, description)


def _from_rows(omega_e: Array, rows: Array, description: str) -> EncounterSpectrum:
    """Return the spectrum of rows (1 + 3 p, n): the disturbance's energy; of each point energy, cross in two parts."""
    points = tuple(PointSpectrum(rows[i], rows[i + 1] + 1j * rows[i + 2]) for i in range(1, len(rows), 3))
    return EncounterSpectrum(omega_e, rows[0], description, points)


class _ShortCrestedNodes:
    """A short-crested sea: trapezoids over its directions, doubled until variances of angle and rate stand still."""

    def __init__(
        self, spectrum: Spectrum, U: float, beta: float, response: Block, effects: tuple[WaveEffect, ...],
        exponent: float,
    ) -> None:  # fmt: skip
        if not exponent > 0.0:
            raise InputError(f"the spreading exponent s of a short-crested sea must be positive, not {exponent:g}")
        speed_factor(U, beta)
        self._nodes_by_direction: dict[int, tuple[Array, Array]] = {}
        self._one_direction = lambda away: _long_crested_nodes(
            spectrum, U, math.acos(math.cos(beta + away)), response, effects, _ACCURACY_OF_ONE
        )
        self._response, self._exponent = response, exponent
        # cos^2s is below 1e-13 beyond
        self._half_spread = math.acos(10.0 ** (-6.5 / exponent))

    def converged_nodes(self) -> tuple[Array, Array]:
        """Return |frequencies of encounter| and energies."""
        before, stride = np.full(2, np.inf), _FIRST_STRIDE
        while True:
            omega_e, rows = self._nodes_at_stride(stride)
            now = _variances(omega_e, rows[0], self._response)
            if np.all(np.abs(now - before) <= _ACCURACY_OF_DIRECTIONS * now) or stride == 1:
                return omega_e, rows
            before, stride = now, stride // 2

    def _nodes_at_stride(self, stride: int) -> tuple[Array, Array]:
        """Return frequencies and energies of every `stride`-th of the finest directions."""
        places = range(0, _DIRECTIONS, stride)
        away = np.linspace(-self._half_spread, self._half_spread, _DIRECTIONS)[::stride]
        shares = weights(len(places)) * np.cos(away) ** (2.0 * self._exponent)
        shares /= shares.sum()
        for place, angle in zip(places, away, strict=True):
            if place not in self._nodes_by_direction:
                self._nodes_by_direction[place] = self._one_direction(float(angle))
        parts = [self._nodes_by_direction[place] for place in places]
        rows = [share * rows for share, (_, rows) in zip(shares, parts, strict=True)]
        return np.concatenate([omega_e for omega_e, _ in parts]), np.concatenate(rows, axis=1)


def _long_crested_nodes(
    spectrum: Spectrum, U: float, beta: float, response: Block, effects: tuple[WaveEffect, ...], accuracy: float
) -> tuple[Array, Array]:
    speed_factor(U, beta)

    def density(omega: Array) -> Array:
        w, *elsewhere = (effect.amplitude(omega, U, beta) for effect in effects)
        rows = [np.abs(w) ** 2]
        overtaken = encounter_frequency(omega, U, beta) < 0.0
        for q in elsewhere:
            cross = q * w.conj()
            rows += [np.abs(q) ** 2, cross.real, np.where(overtaken, -cross.imag, cross.imag)]
        return np.stack(rows) * spectrum.density(omega)

    def encounter(omega: Array) -> Array:
        return np.abs(encounter_frequency(omega, U, beta))

    lowest, highest = effects[0].frequency_range
    lower = max((spectrum.B / _NEGLIGIBLE_EXPONENT) ** 0.25, lowest)
    upper = min(_REACH * spectrum.modal_frequency, highest)
    peak = spectrum.modal_frequency
    # a raised peak is sharp and has a kink
    inner = () if spectrum.gamma == 1.0 else (0.65 * peak, peak, 1.45 * peak)
    return _converged_nodes(
        density, encounter, (lower, *inner, max(upper, min(2.0 * peak, highest))), response, accuracy
    )


def _converged_nodes(
    density: Callable[[Array], Array],
    encounter: Callable[[Array], Array],
    edges: tuple[float, ...],
    response: Block,
    accuracy: float,
) -> tuple[Array, Array]:
    """Trapezoids over log(omega), refined until the sharpened response's variances of angle and rate stand still."""
    sharp, before, count = _with_less_damping(response), np.full(2, np.inf), _MIN_NODES
    while True:
        omega, width = nodes(edges, count)
        omega_e, rows = np.maximum(encounter(omega), _LOWEST_FREQUENCY), density(omega) * width
        now = _variances(omega_e, rows[0], sharp)
        if np.all(np.abs(now - before) <= accuracy * now) or count > _MAX_NODES:
            return omega_e, rows
        before, count = now, 3 * count // 2


def _reduced_nodes(omega_e: Array, rows: Array, response: Block, accuracy: float) -> tuple[Array, Array]:
    """Return fewer nodes, as long as the sharpened response does not notice."""
    sharp, count = _with_less_damping(response), _REDUCED_NODES
    true = _variances(omega_e, rows[0], sharp)
    while count < len(omega_e):
        omega, made = gather_nodes(omega_e, rows, count)
        if np.all(np.abs(_variances(omega, made[0], sharp) - true) <= accuracy * true):
            return omega, made
        count *= 2
    return omega_e, rows


@lru_cache(maxsize=_KEPT_RESPONSES)
def _with_less_damping(response: Block) -> Block:
    """Return the block with half of its damping, as feedback may leave it; what runs away or integrates as if held."""
    poles = response.poles
    slowest = np.min(np.abs(poles[poles != 0.0]), initial=_HELD_POLE)
    damped = np.where(poles == 0.0, -slowest, -np.abs(poles.real) / _DAMPING_DIVISOR)
    return replace(response, den=tuple(response.den[0] * np.atleast_1d(np.poly(damped + 1j * poles.imag).real)))


def _variances(omega_e: Array, energy: Array, response: Block) -> Array:
    """Return the variances of the response's angle and rate."""
    size = np.abs(response.frequency_response(omega_e)) ** 2 * energy
    return np.array([size.sum(), (omega_e**2 * size).sum()])


# The motions of a hull without control as what disturbs its loops: waves' forces through its transfer functions.

_KNOWN_SHARE = 0.9  # least share of the sea's energy at frequencies at which the forces are known; chosen


@dataclass(frozen=True)
class ForcedMotion:
    """One motion of a hull: transfer functions from the force F3 [N, up] and the moment M5 [N m, bow down]."""

    from_force: Block
    from_moment: Block

    def amplitude(self, forces: tuple[Complex, Complex], omega_e: Array) -> Complex:
        """Return the motion (n,) under the complex forces at signed frequencies of encounter [rad/s], all (n,)."""
        F3, M5 = forces
        return self.from_force.frequency_response(omega_e) * F3 + self.from_moment.frequency_response(omega_e) * M5


@dataclass(frozen=True, eq=False)
class HullMotion:
    """A motion that a metre of wave gives the hull while its fins rest: heave [m, down] and pitch [rad, bow up] summed.

    The loop's sensitivity acts on it; the path from here to the output is 1. At x metres forward of the origin the
    hull goes down by z - x theta, so that `heave` is 1 and `pitch` -x there.

    Attributes:
        heave, pitch: how much of each.
    """

    excitation: Excitation
    heave_motion: ForcedMotion
    pitch_motion: ForcedMotion
    heave: float
    pitch: float

    name = "motion of the hull"

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Wave frequencies [rad/s] at which the forces are known."""
        return self.excitation.frequency_range

    def amplitude(self, omega: Array, U: float, beta: float) -> Complex:
        """Return the amplitude as of `WaveEffect`, in the notation's signs; zero outside the frequency range."""
        lower, upper = self.frequency_range
        inside = (omega >= lower) & (omega <= upper) & (omega > 0.0)
        made = np.zeros(len(omega), dtype=np.complex128)
        w = omega[inside]
        if w.size:
            forces, omega_e = self.excitation.forces(w, U, beta), encounter_frequency(w, U, beta)
            heave, pitch = (one.amplitude(forces, omega_e) for one in (self.heave_motion, self.pitch_motion))
            made[inside] = self.heave * heave + self.pitch * pitch
        return made


def refuse_unknown_sea(excitation: Excitation, spectrum: Spectrum) -> None:
    """Refuse a sea with much of its energy at frequencies at which the forces on the hull are not known."""
    lower, upper = excitation.frequency_range
    share = float(spectrum.energy_between(lower, upper)) / spectrum.moment(0)
    if share < _KNOWN_SHARE:
        raise InputError(
            f"the forces of waves are known from {lower:.3g} to {upper:.3g} rad/s, where the sea has "
            f"{100.0 * share:.0f} % of its energy, less than {100.0 * _KNOWN_SHARE:.0f} %; give forces over more "
            "frequencies (excitation.file), or a sea of longer waves"
        )
