"""Waves of small amplitude and the forces that they excite: what every source of them answers, a box-shaped hull."""

import itertools
import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seatrial.core.values import Array, InputError

# Wave number and group velocity of linear waves at a finite depth.

G = 9.81  # m/s^2, acceleration of gravity, rounded
SEA_WATER = 1025.0
"""Density where none is stated [kg/m^3] (ITTC 7.5-02-01-03, sea water at 15 degC: 1026)."""
_ITERATIONS = 60  # Newton steps at most; chosen


def wavenumber(omega: ArrayLike, depth: float) -> Array:
    """Return the positive root k [rad/m] of omega^2 = g k tanh(k depth) (Newman 1977, Marine Hydrodynamics, chap. 6).

    Args:
        omega: rad/s, any shape, positive.
        depth: m; infinite for deep water.

    Raises:
        InputError: a frequency or the depth is not positive.
    """
    w = np.asarray(omega, dtype=np.float64)
    if not (np.all(w > 0.0) and depth > 0.0):
        raise InputError("a wave number needs positive frequencies [rad/s] and a positive depth [m]")
    nu = w**2 / G
    if np.isinf(depth):
        return nu
    k = np.maximum(nu, w / np.sqrt(G * depth))
    for _ in range(_ITERATIONS):
        t = np.tanh(k * depth)
        k = k - (k * t - nu) / (t + k * depth * (1.0 - t**2))
    return np.asarray(k, dtype=np.float64)


def group_velocity(omega: ArrayLike, depth: float) -> Array:
    """Return c_g [m/s] = omega / (2 k) (1 + 2 k h / sinh(2 k h)) (Newman 1977, chap. 6)."""
    w, k = np.asarray(omega, dtype=np.float64), wavenumber(omega, depth)
    twice = np.minimum(2.0 * k * depth, 700.0)  # beyond, sinh overflows, and its share is zero
    return 0.5 * w / k * (1.0 + twice / np.sinh(twice))


# Wave excitation of heave and pitch: what every source of it answers, and the closed form for a box-shaped hull.

Complex = NDArray[np.complex128]

MAX_SHIP_SPEED = 50.0  # m/s; guards against a wrong unit


class Excitation(Protocol):
    """Force and moment per metre of wave amplitude.

    Seakeeping axes at midship: x forward, y to port, z up; F3 [N/m] positive up, M5 [N m/m] positive bow down. The
    elevation at midship is Re(a exp(i omega_e t)), the force Re(F a exp(i omega_e t)) with the signed frequency of
    encounter. The papers' F_r cos + F_i sin is F = F_r - i F_i.
    """

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Wave frequencies [rad/s] from and to which the forces hold."""
        ...

    def forces(self, omega: Array, U: float, beta: Array | float) -> tuple[Complex, Complex]:
        """Return F3 and M5, each of the shape (n,) of `omega` [rad/s, of the wave, not of encounter].

        `U` in m/s; `beta` in rad, 0 following, pi / 2 beam, pi head, one for all or one for each frequency.
        """
        ...


@dataclass(frozen=True)
class BoxHull:
    """The box-shaped hull of Jensen, Mansour & Olsen 2004 (Ocean Engineering 31, 61-85), scaled by a ship's stiffness.

    F and G of `box_wave` are compared there with the effective elevation and slope of the wave; a restoring matrix C
    turns them into forces. The box stands at the centre of flotation, x_f = -c35 / c33 from midship, so that midship
    sees the phase k cos(beta) x_f and the moment of the lever x_f. As omega goes to zero, F3 -> c33 + i q c35 and
    M5 -> c53 + i q c55 with q = k cos(beta): the static answer of any such plant is the elevation and the slope. With
    constant damping pitch itself does not become the slope: what it turns heave into is of lower order in omega.
    Giving M5 the term c35 F and F3 none would leave the pitch of the long wave wrong by
    1 / (1 - c35 c53 / (c33 c55)).

    F, G, A and f agree with two independent public programs that cite the paper (MSS toolbox, NetSSE); they differ in
    kappa: exp(-k_e T) in the first, as here, exp(-k T) in the second. The paper was not at hand. The offset is ours.

    Attributes:
        L, B, T: length, breadth, draught of the box, m.
        c33, c35, c53, c55: restoring, N/m, N/rad, N m/m, N m/rad (x forward, z up, pitch bow down, or all reversed).

    Raises:
        InputError: a dimension, c33 or c55 is not positive, a number is not finite, or C has no positive determinant.
    """

    L: float
    B: float
    T: float
    c33: float
    c35: float
    c53: float
    c55: float

    def __post_init__(self) -> None:
        for name, unit in (("L", "m"), ("B", "m"), ("T", "m"), ("c33", "N/m"), ("c55", "N m/rad")):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"the box hull needs a positive {name} [{unit}], not {value:g}")
        for name in ("c35", "c53"):
            if not np.isfinite(getattr(self, name)):
                raise InputError(f"the box hull needs a finite {name}, not {getattr(self, name)}")
        if self.c35 * self.c53 >= self.c33 * self.c55:
            raise InputError(
                "the restoring matrix of the box hull has no positive determinant, so the hull would capsize end over "
                f"end; check c35 = {self.c35:g} and c53 = {self.c53:g} against c33 and c55"
            )

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Zero, and k T = 1: beyond, the pressure 1 - k T of the paper would grow with depth."""
        return 0.0, math.sqrt(G / self.T)

    def forces(self, omega: Array, U: float, beta: Array | float) -> tuple[Complex, Complex]:
        """Return the forces of `Excitation.forces`."""
        w, heading = checked_waves(omega, U, beta)
        F, S = box_wave(w, U, heading, self.L, self.B, self.T)
        q = w**2 / G * np.cos(heading)
        F3 = self.c33 * F * np.exp(1j * q * self.c35 / self.c33)
        about_flotation = self.c55 - self.c53**2 / self.c33
        M5 = (self.c53 * F + 1j * about_flotation * S) * np.exp(1j * q * self.c53 / self.c33)
        return np.asarray(F3, dtype=np.complex128), np.asarray(M5, dtype=np.complex128)


BOX_IN_PHASE, BOX_IN_QUADRATURE = 0.07, 0.12
"""Standard deviations of the forces of a hull about those of its box, over the static forces of the wave: strip theory
of eight hulls at three speeds in head seas of 0.8 to 3 lengths, rms (benchmarks/box_forces.py)."""
_LONG, _SHORT = 3.0, 0.8
"""Lengths of these waves over the hull's, between which its error goes straight over frequency from one to another."""


@dataclass(frozen=True)
class BoxForceError:
    """One way in which a hull's forces differ from its box's, by one standard deviation: an excitation of its own.

    Attributes:
        force: "F3" or "M5"; is_in_phase: with the static force, else a quarter period ahead of it; is_short: at the end
            of short waves, else of long ones.
    """

    box: BoxHull
    force: Literal["F3", "M5"]
    is_in_phase: bool
    is_short: bool

    @classmethod
    def all_of(cls, box: BoxHull) -> "tuple[BoxForceError, ...]":
        """Return all ways, independent of one another."""
        ways = itertools.product(("F3", "M5"), (True, False), (True, False))
        return tuple(cls(box, force, is_in_phase, is_short) for force, is_in_phase, is_short in ways)

    @property
    def name(self) -> str:
        """Return what is wrong, in words: ``F3 in phase, short waves``."""
        phase = "in phase" if self.is_in_phase else "in quadrature"
        return f"{self.force} {phase}, {'short' if self.is_short else 'long'} waves"

    @property
    def size(self) -> float:
        """Standard deviation, over the static force."""
        return BOX_IN_PHASE if self.is_in_phase else BOX_IN_QUADRATURE

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Return that of the box."""
        return self.box.frequency_range

    def forces(self, omega: Array, U: float, beta: Array | float) -> tuple[Complex, Complex]:
        """Return the errors of the forces of `Excitation.forces`: c33 and i k cos(beta) c55 times size and share."""
        w, heading = checked_waves(omega, U, beta)
        ends = [math.sqrt(2.0 * np.pi * G / (ratio * self.box.L)) for ratio in (_LONG, _SHORT)]
        share = np.interp(w, ends, (0.0, 1.0) if self.is_short else (1.0, 0.0))
        relative = (self.size if self.is_in_phase else 1j * self.size) * share
        none = np.zeros(len(w), dtype=np.complex128)
        if self.force == "F3":
            return np.asarray(self.box.c33 * relative, dtype=np.complex128), none
        return none, np.asarray(1j * w**2 / G * np.cos(heading) * self.box.c55 * relative, dtype=np.complex128)


def encounter_frequency(omega: ArrayLike, U: float, beta: ArrayLike) -> Array:
    """omega_e = omega - omega^2 U cos(beta) / g [rad/s], negative where the ship overtakes the wave (deep water)."""
    w = np.asarray(omega, dtype=np.float64)
    return w - w**2 / G * U * np.cos(np.asarray(beta, dtype=np.float64))


def box_wave(omega: Array, U: float, beta: Array, L: float, B: float, T: float) -> tuple[Array, Array]:
    """F and sign(cos(beta)) G of Jensen, Mansour & Olsen 2004: the wave that a box feels, per metre of amplitude.

    k_e = |k cos(beta)|, s = k_e L / 2, kappa = exp(-k_e T), F = kappa f sin(s) / s,
    G = kappa f (6 / L) (sin(s) / s - cos(s)) / s, the latter two as spherical Bessel functions j0 and j1, which have
    no 0/0 at s = 0; likewise A^2 / (k B alpha^3) = k B alpha sinc^2(k B alpha^2 / 2) exp(-2 k T alpha^2).

    Returns:
        Effective elevation [m/m] and slope [rad/m], shape of `omega`.
    """
    k = omega**2 / G
    alpha = 1.0 - omega * U * np.cos(beta) / G
    s = np.abs(k * np.cos(beta)) * L / 2
    kappa = np.exp(-np.abs(k * np.cos(beta)) * T)
    radiated = k * B * alpha * np.sinc(k * B * alpha**2 / (2 * np.pi)) ** 2 * np.exp(-2 * k * T * alpha**2)
    f = np.hypot(1.0 - k * T, radiated)
    from scipy.special import spherical_jn

    elevation = kappa * f * spherical_jn(0, s)
    # 6 / L as above
    slope = np.sign(np.cos(beta)) * kappa * f * 6 / L * spherical_jn(1, s)
    return elevation, slope


def checked_waves(omega: ArrayLike, U: float, beta: ArrayLike) -> tuple[Array, Array]:
    """Return frequencies and headings of one shape (n,), in sense.

    Raises:
        InputError: a frequency is not positive, a speed is negative or beyond 50 m/s, a heading is beyond +-2 pi, or
            there is neither one heading nor one for each frequency.
    """
    w = np.atleast_1d(np.asarray(omega, dtype=np.float64))
    heading = np.asarray(beta, dtype=np.float64)
    if w.ndim != 1 or not np.all(np.isfinite(w) & (w > 0.0)):
        raise InputError("wave frequencies must be positive and finite [rad/s]; leave out zero and NaN")
    if not (np.isfinite(U) and 0.0 <= U <= MAX_SHIP_SPEED):
        raise InputError(f"the ship speed must lie between 0 and {MAX_SHIP_SPEED:g} m/s, not {U:g}; is it in knots?")
    if not np.all(np.isfinite(heading) & (np.abs(heading) <= 2 * np.pi)):
        raise InputError(
            "the heading to the waves must lie within +-2 pi rad (0 following, pi head); is it in degrees?"
        )
    if heading.shape not in ((), (1,), w.shape):
        raise InputError(f"give one heading or one for each of the {w.size} frequencies, not {heading.size}")
    return w, np.broadcast_to(heading, w.shape)
