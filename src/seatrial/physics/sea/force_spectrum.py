"""Spectral densities of the wave force that a moving ship feels, where only the sea's spectrum is known."""

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import Complex, Excitation, encounter_frequency
from seatrial.physics.sea.encounter import speed_factor
from seatrial.physics.sea.spectrum import Spectrum

_CELLS = 100_000  # cells of the wave spectrum; chosen
_BAND = (5e-4, 0.9995)  # shares of the energy below either end; chosen


def force_density(spectrum: Spectrum, excitation: Excitation, U: float, beta: float, edges: Array) -> Complex:
    """One-sided density of F3 [N, up] and M5 [N m, bow down] between `edges` of |omega_e| [rad/s], (n, 2, 2).

    Element ij is that of E[F_i conj(F_j)]. The sea is cut into many cells of wave frequency; each brings its energy to
    the frequency at which it is met, waves that the ship overtakes as the conjugate. So a following sea, where up to
    three waves are met at one frequency, needs no Jacobian.

    Raises:
        InputError: speed or heading out of sense, or frequencies that the excitation does not know.
    """
    speed_factor(U, beta)
    bounds = np.linspace(*spectrum.band(*_BAND), _CELLS + 1)
    omega = 0.5 * (bounds[1:] + bounds[:-1])
    energy = spectrum.density(omega) * np.diff(bounds)
    met = encounter_frequency(omega, U, beta)
    F = np.stack(excitation.forces(omega, U, beta), axis=1)
    F = np.where((met < 0.0)[:, None], F.conj(), F)
    made = np.zeros((len(edges) - 1, 2, 2), dtype=np.complex128)
    place = np.searchsorted(edges, np.abs(met), side="right") - 1
    inside = (place >= 0) & (place < len(made))
    np.add.at(made, place[inside], energy[inside, None, None] * F[inside, :, None] * F[inside, None, :].conj())
    return made / np.diff(edges)[:, None, None]
