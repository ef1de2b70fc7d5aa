"""The motions of a hull without control as what disturbs its loops: waves' forces through its transfer functions."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex, Excitation, encounter_frequency
from seatrial.physics.loops.block import Block
from seatrial.physics.sea.spectrum import Spectrum

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
