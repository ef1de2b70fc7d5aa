"""How far the wave forces of a box are from those of a hull: strip theory with Lewis sections, in head seas.

`python benchmarks/box_forces.py` prints the errors of size and phase over hulls, speeds and wave lengths: what
`physics.hydro.excitation.BOX_ERRORS` rests on.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from measure import Line, machine

from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import BoxHull, G
from seatrial.physics.hydro.section import FRESH_WATER, MOTIONS, LewisForm, SectionMotion, section_hydrodynamics

LENGTH, STATIONS = 1.0, 24  # m of all hulls, as errors do not depend on it; stations at the middles of slices
SPEEDS = (0.0, 0.15, 0.3)  # Froude numbers of ships, at rest to fast
WAVE_LENGTHS = (0.8, 1.0, 1.3, 1.7, 2.2, 3.0)  # over L: where heave and pitch move
FULLNESS = 0.85  # area of a section over beam and draught: between fine and full ships


@dataclass(frozen=True)
class Hull:
    """A waterline B (1 - |2 x / L|^n) of constant draught; L/B, B/d and n from 2 (C_WP 0.67) to 6 (0.86)."""

    slenderness: float
    flatness: float
    power: float

    @property
    def places(self) -> Array:
        """Middles of slices, m forward of midship."""
        return LENGTH * ((np.arange(STATIONS) + 0.5) / STATIONS - 0.5)

    @property
    def beams(self) -> Array:
        """Of these slices, m."""
        return LENGTH / self.slenderness * (1.0 - np.abs(2.0 * self.places / LENGTH) ** self.power)

    @property
    def draught(self) -> float:
        """Of all slices, m."""
        return LENGTH / self.slenderness / self.flatness

    @property
    def box(self) -> BoxHull:
        """The box with the hull's dimensions and stiffness."""
        strip = FRESH_WATER * G * self.beams * LENGTH / STATIONS
        stiffness = float(np.sum(strip)), 0.0, 0.0, float(np.sum(strip * self.places**2))
        return BoxHull(LENGTH, LENGTH / self.slenderness, self.draught, *stiffness)


def hull_forces(hull: Hull, omega: float, U: float) -> tuple[complex, complex]:
    """Return F3 and M5 per m of amplitude in head seas by relative motion (Gerritsma & Beukelman 1967, ISP 14, 285).

    f = rho g b w + (b33 - U a33') w_dot + a33 w_dotdot of the wave w = exp(-k T s) exp(i k x) below the strip, rates at
    omega_e for damping and omega for the acceleration of the water; M5 = -sum x f, bow down positive in x up.
    """
    k, omega_e = omega**2 / G, omega + omega**2 / G * U
    x, b, dx = hull.places, hull.beams, LENGTH / STATIONS
    sections = [section_hydrodynamics(LewisForm.from_dimensions(beam, hull.draught, FULLNESS), omega_e) for beam in b]
    heave = MOTIONS.index(SectionMotion.HEAVE)
    added = np.array([s.added_mass[heave, heave] for s in sections])
    damping = np.array([s.damping[heave, heave] for s in sections])
    wave = np.exp(-k * hull.draught * FULLNESS) * np.exp(1j * k * x)
    force = (FRESH_WATER * G * b + 1j * omega * (damping - U * np.gradient(added, dx)) - omega * omega_e * added) * wave
    return complex(np.sum(force) * dx), complex(-np.sum(x * force) * dx)


def hulls() -> Iterator[Hull]:
    """Yield slender and beamy, deep and flat, fine and full hulls."""
    for slenderness in (5.0, 8.0):
        for flatness in (2.5, 4.0):
            for power in (2.0, 4.0):
                yield Hull(slenderness, flatness, power)


def errors() -> Array:
    """Return hull less box over the static force of the wave, complex, (hulls, speeds, wave lengths, 2)."""
    omega = np.sqrt(2.0 * np.pi * G / (np.array(WAVE_LENGTHS) * LENGTH))
    found = []
    for hull in hulls():
        static = np.column_stack([np.full(len(omega), hull.box.c33), -1j * omega**2 / G * hull.box.c55])
        for froude in SPEEDS:
            U = froude * np.sqrt(G * LENGTH)
            of_hull = np.array([hull_forces(hull, w, U) for w in omega])
            found.append((of_hull - np.column_stack(hull.box.forces(omega, U, np.pi))) / static)
    return np.array(found).reshape(-1, len(SPEEDS), len(WAVE_LENGTHS), 2)


def lines() -> Iterator[Line]:
    """Yield rms errors in phase and in quadrature with the static force, by wave length and of all."""
    found = errors()
    for j, force in enumerate(("F3", "M5")):
        rows = [(f"waves of {one:g} L", found[:, :, i, j]) for i, one in enumerate(WAVE_LENGTHS)]
        for where, error in (*rows, ("all", found[..., j])):
            yield Line(f"{force}, {where}: in phase, rms over the static force", rms(error.real), "")
            yield Line(f"{force}, {where}: in quadrature, rms over the static force", rms(error.imag), "")


def rms(values: Array) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def main() -> int:
    """Print the table."""
    print(machine())
    for line in lines():
        print(f"  {line.quantity:<64} {line.value:>9.3g} {line.unit}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
