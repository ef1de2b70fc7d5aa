"""The identified ship in the waves of its trial: operators, spectra and statistics for the report."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.ship_motions import PointMotion, Seakeeping
from seatrial.core.values import Array, Record
from seatrial.data.trial import TrialRecord
from seatrial.physics.hydro.excitation import encounter_frequency
from seatrial.physics.sea.response import (
    MotionStatistics,
    motion_sickness,
    motion_statistics,
    response_spectrum,
    vertical_motion,
)
from seatrial.physics.sea.spectrum import G, Spectrum, ittc
from seatrial.physics.simulate.harmonics import Complex, frequency_response, linear_system

# frequencies of the curves, ours
_POINTS = 160
# shares of the sea's energy below the first and the last frequency, ours
_ENERGY_BAND = (1e-3, 0.99)


def seakeeping(model: Model, records: Sequence[TrialRecord], length: float) -> Seakeeping | None:
    """Of the first run whose meeting with the waves is known; None where none is."""
    met = next(((r.record, r.waves) for r in records if r.waves is not None), None)
    if met is None:
        return None
    record, waves = met
    spectrum = waves.spectrum or _spectrum_of_record(record)
    omega = np.linspace(*spectrum.band(*_ENERGY_BAND), _POINTS)
    omega_e = encounter_frequency(omega, waves.U, waves.beta)
    heave, pitch = transfer_functions(
        model, omega_e, np.stack(waves.excitation.forces(omega, waves.U, waves.beta), axis=1)
    )
    moved, turned = (motion_statistics(spectrum, omega, omega_e, h) for h in (heave, pitch))
    slope = pitch * G / omega**2
    return Seakeeping(
        run=record.name, speed=waves.U, heading=math.degrees(waves.beta),
        sea=f"{spectrum.name}, {spectrum.significant_height:.2f} m"
        + ("" if waves.spectrum else " (height of the recorded elevation)"),
        omega=_floats(omega), omega_e=_floats(omega_e),
        heave=_floats(np.abs(heave)), heave_phase=_floats(np.degrees(np.angle(heave))),
        pitch=_floats(np.abs(slope)), pitch_phase=_floats(np.degrees(np.angle(slope))),
        sea_density=_floats(spectrum.density(omega)), heave_density=_floats(response_spectrum(spectrum, omega, heave)),
        pitch_density=_floats(response_spectrum(spectrum, omega, np.degrees(1.0) * pitch)),
        heave_significant=moved.significant, pitch_significant=math.degrees(turned.significant),
        zero_crossing_periods=(moved.zero_crossing_period, turned.zero_crossing_period),
        points=tuple(_point_motion(name, share * length, spectrum, omega, omega_e, heave, pitch)
                     for name, share in (("bow", 0.5), ("origin", 0.0), ("stern", -0.5))),
    )  # fmt: skip


def transfer_functions(model: Model, omega_e: Array, forces: Complex) -> tuple[Complex, Complex]:
    """Heave [up, m/m] and pitch [bow down, rad/m] for forces per metre of wave (n, 2), F3 [up] and M5 [bow down].

    The model's own axes turn all four signs, which leaves their ratios as they are.
    """
    inputs = [model.input_names.index(n) for n in ("F3", "M5")]
    response = frequency_response(linear_system(model, ("z", "theta")), omega_e)[:, :, inputs]
    motion = np.einsum("kyu,ku->ky", response, forces)
    return motion[:, 0], motion[:, 1]


def _spectrum_of_record(record: Record) -> Spectrum:
    """A sea of the significant height that was recorded."""
    return ittc(4.0 * float(np.std(record["zeta"])))


def _point_motion(
    name: str, x: float, spectrum: Spectrum, omega: Array, omega_e: Array, heave: Complex, pitch: Complex
) -> PointMotion:
    motion: MotionStatistics = motion_statistics(spectrum, omega, omega_e, vertical_motion(heave, pitch, x))
    return PointMotion(name, x, motion.significant, motion.acceleration, motion_sickness(motion))


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in values)
