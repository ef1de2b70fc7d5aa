"""Ship sections in beam waves: Lewis forms, added mass, damping and excitation by multipoles."""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Self

import numpy as np

from seatrial.core.values import Array, InputError, Ship
from seatrial.physics.hydro.excitation import Complex, G, group_velocity

# The Lewis form: a ship-like section from beam, draught and area (Lewis 1929; Tasai 1959).


@dataclass(frozen=True)
class LewisForm:
    """Contour x + i y = i M (e^(alpha - i theta) + ...), x to the side from the centre line, y down from the waterline.

    Attributes:
        scale: M, m.
        a1, a3: coefficients of the map; both zero for the half circle.
        beam, draught: m.
    """

    scale: float
    a1: float
    a3: float
    beam: float
    draught: float

    @classmethod
    def from_dimensions(cls, beam: float, draught: float, area_coefficient: float) -> Self:
        """Return the form with that beam, draught [m] and area / (beam draught).

        a1, a3 from B / 2d and sigma (von Kerczek & Tuck 1969, J. Ship Research 13, 284-289).

        Raises:
            InputError: sizes are not positive, or no Lewis form has that area.
        """
        if not (beam > 0.0 and draught > 0.0 and area_coefficient > 0.0):
            raise InputError("a section needs a positive beam, draught and area coefficient")
        ratio = (0.5 * beam - draught) / (0.5 * beam + draught)
        c = 3.0 + 4.0 * area_coefficient / math.pi + (1.0 - 4.0 * area_coefficient / math.pi) * ratio**2
        if c > 4.5:  # root of the source below
            raise InputError(
                f"no Lewis form has the area coefficient {area_coefficient:g} at beam {beam:g} m and draught "
                f"{draught:g} m; lower it"
            )
        a3 = (3.0 - c + math.sqrt(9.0 - 2.0 * c)) / c  # von Kerczek & Tuck 1969
        a1 = ratio * (1.0 + a3)
        return cls(0.5 * beam / (1.0 + a1 + a3), a1, a3, beam, draught)

    def points(self, theta: Array) -> tuple[Array, Array]:
        """x, y [m] of the contour; theta from 0 at the keel to pi / 2 at the waterline."""
        x = (1.0 + self.a1) * np.sin(theta) - self.a3 * np.sin(3.0 * theta)
        y = (1.0 - self.a1) * np.cos(theta) + self.a3 * np.cos(3.0 * theta)
        return self.scale * x, self.scale * y

    def tangents(self, theta: Array) -> tuple[Array, Array]:
        """dx/dtheta, dy/dtheta [m]."""
        x = (1.0 + self.a1) * np.cos(theta) - 3.0 * self.a3 * np.cos(3.0 * theta)
        y = -(1.0 - self.a1) * np.sin(theta) - 3.0 * self.a3 * np.sin(3.0 * theta)
        return self.scale * x, self.scale * y

    @property
    def metacentre(self) -> float:
        """Height of the metacentre above the keel at small angles, KB + BM, m."""
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        theta, weights = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights
        (x, y), (_, dy) = self.points(theta), self.tangents(theta)
        depth = -2.0 * float(np.sum(weights * x * dy * y)) / self.area
        return self.draught - depth + self.beam**3 / 12.0 / self.area  # BM: second moment of the waterline

    @property
    def area(self) -> float:
        """m^2: pi/2 M^2 (1 - a1^2 - 3 a3^2)."""
        return 0.5 * math.pi * self.scale**2 * (1.0 - self.a1**2 - 3.0 * self.a3**2)


# Added mass, damping and wave excitation of a Lewis section in beam waves by multipoles (Ursell 1949; Tasai 1959).

FRESH_WATER = 1000.0
"""Density of the water of a flume [kg/m^3], rounded."""
TERMS, NODES = 16, 100  # multipoles, points of the contour; chosen


class SectionMotion(StrEnum):
    """A motion of the section; heave down."""

    SWAY = "sway"
    HEAVE = "heave"
    ROLL = "roll"


MOTIONS = tuple(SectionMotion)
"""Order of the rows and columns of every matrix of a section."""


@dataclass(frozen=True)
class SectionHydrodynamics:
    """Per m of length at one frequency, rows and columns in the order of `MOTIONS`; heave is coupled with neither.

    Attributes:
        added_mass, damping: (3, 3), force in the row by motion in the column: kg/m, kg, kg m; per s of damping.
        excitation: complex force (moment) on the held section per m of wave amplitude, (3,). The wave travels to
            starboard, its elevation at the centre line is Re(a exp(i omega t)), upwards.
        radiated_amplitude: outgoing wave amplitude to one side per velocity of the motion, (3,), s (s m for roll).
    """

    added_mass: Array
    damping: Array
    excitation: Complex
    radiated_amplitude: Array


def section_hydrodynamics(
    form: LewisForm, omega: float, axis: float = 0.0, density: float = FRESH_WATER
) -> SectionHydrodynamics:
    """Radiation by the multipoles, excitation by Green's theorem over the contour (Haskind 1957; Newman 1977, chap. 6).

    Args:
        omega: rad/s.
        axis: depth below the waterline about which the section rolls, m.
        density: of the water, kg/m^3.

    Raises:
        InputError: the frequency is not positive.
    """
    if not omega > 0.0:
        raise InputError(f"the frequency must be positive, not {omega:g} rad/s")
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    theta, weights = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights
    (x, y), (dx, dy) = form.points(theta), form.tangents(theta)
    fluxes = [_flux(motion, x, y, dx, dy, axis) for motion in MOTIONS]
    solved = [_potential(form, omega, motion, theta, axis) for motion in MOTIONS]
    force = 1j * omega * density * 2.0
    radiation, excitation = np.zeros((3, 3), dtype=np.complex128), np.zeros(3, dtype=np.complex128)
    for i, j in itertools.product(range(3), range(3)):
        if (MOTIONS[i] is SectionMotion.HEAVE) is (MOTIONS[j] is SectionMotion.HEAVE):
            radiation[i, j] = force * np.sum(weights * solved[j][0] * fluxes[i])
    for i, motion in enumerate(MOTIONS):
        wave, crossing = _incident(omega, motion, x, y, dx, dy)
        excitation[i] = -force * np.sum(weights * (wave * fluxes[i] - solved[i][0] * crossing))
    height = np.array([omega * np.pi * abs(strength) / G for _, strength in solved])
    height *= [1.0 if motion is SectionMotion.HEAVE else omega**2 / G for motion in MOTIONS]
    return SectionHydrodynamics(radiation.imag / omega, radiation.real, excitation, height)


def haskind_damping(excitation: float, omega: float, depth: float = np.inf, density: float = FRESH_WATER) -> float:
    """b = |X|^2 / (2 rho g c_g) per unit length of a symmetric section (Haskind 1957; Newman 1977, chap. 6).

    The section sends a wave of amplitude A to each side: b V^2 / 2 = 2 (rho g A^2 / 2) c_g, and X = 2 rho g c_g A / V.

    Args:
        excitation: amplitude in N/m per m of wave amplitude.
    """
    return excitation**2 / (2.0 * density * G * float(group_velocity(omega, depth)))


def _flux(motion: SectionMotion, x: Array, y: Array, dx: Array, dy: Array, axis: float) -> Array:
    """Velocity of the unit motion into the section times element: U_x dy - U_y dx from keel to waterline."""
    if motion is SectionMotion.HEAVE:
        return -dx
    return dy if motion is SectionMotion.SWAY else -(x * dx + (y - axis) * dy)


def _potential(
    form: LewisForm, omega: float, motion: SectionMotion, theta: Array, axis: float
) -> tuple[Complex, complex]:
    """Potential on the contour at unit velocity, and the strength of the source or dipole at the origin.

    The stream function on the body is that of the body's own motion up to a constant: least squares over the contour.
    """
    nu = omega**2 / G
    x, y = form.points(theta)
    if motion is SectionMotion.HEAVE:
        first = _source(x, y, nu)
        target, parity = -x, 0
    else:
        first = _dipole(x, y, nu)
        target, parity = (y if motion is SectionMotion.SWAY else -0.5 * (x**2 + (y - axis) ** 2)), 1
    even = parity == 0
    phis = [first[0], *_multipoles(form, nu, theta, parity, np.cos if even else np.sin)]
    psis = [first[1], *_multipoles(form, nu, theta, parity, np.sin if even else _minus_cos), np.ones_like(theta)]
    solved = np.linalg.lstsq(np.stack(psis, axis=1).astype(complex), target.astype(complex), rcond=None)[0]
    potential = np.stack(phis, axis=1).astype(np.complex128) @ solved[:-1]
    return np.asarray(potential, dtype=np.complex128), complex(solved[0])


def _minus_cos(angle: Array) -> Array:
    return -np.cos(angle)


def _multipoles(form: LewisForm, nu: float, theta: Array, parity: int, trig: Callable[[Array], Array]) -> list[Array]:
    """Wave-free potentials on the contour, order 2m + parity (Tasai 1959, 1961)."""
    scaled = nu * form.scale
    return [
        trig(n * theta)
        + scaled
        * (
            trig((n - 1) * theta) / (n - 1)
            + form.a1 * trig((n + 1) * theta) / (n + 1)
            - 3.0 * form.a3 * trig((n + 3) * theta) / (n + 3)
        )
        for n in range(2 + parity, 2 * TERMS + 2 + parity, 2)
    ]


def _source(x: Array, y: Array, nu: float) -> tuple[Complex, Complex]:
    """phi_c - i phi_s and psi_c - i psi_s of the pulsating source at the origin (Ursell 1949).

    The integral over wave numbers is e^(i nu w) E1(i nu w), w = x + i y.
    """
    from scipy.special import exp1

    w = x + 1j * y
    cosine = np.pi * np.exp(1j * nu * w)
    sine = -1j * cosine - np.exp(1j * nu * w) * exp1(1j * nu * w)
    return cosine.real - 1j * sine.real, cosine.imag - 1j * sine.imag


def _dipole(x: Array, y: Array, nu: float) -> tuple[Complex, Complex]:
    """The derivative of the source in x: horizontal dipole."""
    from scipy.special import exp1

    w = x + 1j * y
    cosine = 1j * nu * np.pi * np.exp(1j * nu * w)
    sine = -1j * cosine - (1j * nu * np.exp(1j * nu * w) * exp1(1j * nu * w) - 1.0 / w)
    return cosine.real - 1j * sine.real, cosine.imag - 1j * sine.imag


def _incident(omega: float, motion: SectionMotion, x: Array, y: Array, dx: Array, dy: Array) -> tuple[Complex, Complex]:
    """Potential (i g / omega) e^(-nu y - i nu x) and its flux; only the part symmetric like the motion counts."""
    nu = omega**2 / G
    amplitude = 1j * G / omega * np.exp(-nu * y)
    if motion is SectionMotion.HEAVE:
        wave, along = amplitude * np.cos(nu * x), -nu * amplitude * np.sin(nu * x)
    else:
        wave, along = -1j * amplitude * np.sin(nu * x), -1j * nu * amplitude * np.cos(nu * x)
    return wave, along * dy + nu * wave * dx


# A floating section: a prismatic body of that form, and what its particulars say of it.


@dataclass(frozen=True)
class FloatingSection:
    """A prismatic body, origin at its centre of gravity; sway to starboard, heave down, roll to starboard.

    Attributes:
        form: of its cross-section; length: m.
        mass: kg; roll_inertia: about the centre of gravity, kg m^2.
        axis: depth of the centre of gravity below the waterline, m.
        GM: metacentric height, m.
        density: of the water, kg/m^3.
    """

    form: LewisForm
    length: float
    mass: float
    roll_inertia: float
    axis: float
    GM: float
    density: float

    @classmethod
    def from_ship(cls, ship: Ship) -> Self:
        """Return the section of a ship's particulars L, B, d, m, KG, k_xx or I_x; GM and rho where they are given.

        GM follows from the form (KB + BM - KG), the density is that of fresh water.

        Raises:
            InputError: a particular is missing or not positive, or no Lewis form has that area.
        """
        size = ship.particulars
        missing = [n for n in ("L", "B", "d", "m", "KG") if not size.get(n, 0.0) > 0.0]
        missing += [] if size.get("k_xx", 0.0) > 0.0 or size.get("I_x", 0.0) > 0.0 else ["k_xx"]
        if missing:
            raise InputError(f"section '{ship.name}' lacks a positive {', '.join(missing)}; add them under [ship]")
        density = size.get("rho", FRESH_WATER)
        area = size["m"] / (density * size["L"])
        form = LewisForm.from_dimensions(size["B"], size["d"], area / (size["B"] * size["d"]))
        inertia = size["I_x"] if "I_x" in size else size["m"] * size["k_xx"] ** 2
        GM = size["GM"] if "GM" in size else form.metacentre - size["KG"]
        return cls(form, size["L"], size["m"], inertia, size["d"] - size["KG"], GM, density)

    def hydrodynamics(self, omega: float) -> SectionHydrodynamics:
        """Return `section_hydrodynamics` of the whole body: kg, N and their like."""
        per_length = section_hydrodynamics(self.form, omega, self.axis, self.density)
        return replace(
            per_length,
            added_mass=self.length * per_length.added_mass,
            damping=self.length * per_length.damping,
            excitation=self.length * per_length.excitation,
        )

    @property
    def inertia(self) -> Array:
        """Mass, mass and moment of inertia of `MOTIONS`, (3,)."""
        return np.array([self.mass, self.mass, self.roll_inertia])

    @property
    def stiffness(self) -> Array:
        """Hydrostatic stiffness of `MOTIONS`, (3,): none in sway."""
        heave = self.density * G * self.form.beam * self.length
        return np.array([0.0, heave, self.mass * G * self.GM])
