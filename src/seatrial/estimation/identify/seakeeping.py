"""The identified ship in the waves of its trial: operators, spectra and statistics for the report."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.ship_motions import PointMotion, Seakeeping
from seatrial.core.values import Array, Record
from seatrial.data.trial import TrialRecord
from seatrial.physics.hydro.excitation import G, encounter_frequency
from seatrial.physics.sea.response import (
    MotionStatistics,
    motion_sickness,
    motion_statistics,
    response_spectrum,
    vertical_motion,
)
from seatrial.physics.sea.spectrum import (
    Spectrum,
    WaveEncounter,
    ittc,
    ittc_two_parameter,
    speed_factor,
    wave_frequency,
)
from seatrial.physics.simulate.linear import Complex, frequency_response, linear_system

# frequencies of the curves, ours
_POINTS = 160
# shares of the sea's energy below the first and the last frequency, ours
_ENERGY_BAND = (1e-3, 0.99)


def seakeeping(model: Model, records: Sequence[TrialRecord], length: float) -> Seakeeping | None:
    """Of the first run whose meeting with the waves is known; None where none is, and of a model that is not linear."""
    met = next(((r.record, r.waves) for r in records if r.waves is not None), None)
    if met is None or not model.is_affine:
        return None
    record, waves = met
    spectrum = waves.spectrum or recorded_sea(record, waves)
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
        + ("" if waves.spectrum else f" and {spectrum.mean_period:.2f} s (as the elevation of {record.name})"),
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


def recorded_sea(record: Record, waves: WaveEncounter) -> Spectrum:
    """Return the sea with the significant height and the mean period of the elevation that was recorded.

    The periodogram at the frequencies of encounter is moved to those of the waves, up to the share of its energy above
    which the noise of the probe counts. Where the ship runs with the waves, to which one of
    three waves an encounter belongs is not known: there the period is that of the ITTC sea of that height.
    """
    elevation = record["zeta"] - np.mean(record["zeta"])
    height = 4.0 * float(np.std(elevation))
    if speed_factor(waves.U, waves.beta) > 0.0:
        return ittc(height)
    omega_e = 2.0 * np.pi * np.fft.rfftfreq(len(elevation), record.dt)[1:]
    energy = np.abs(np.fft.rfft(elevation)[1:]) ** 2
    kept = np.cumsum(energy) <= _ENERGY_BAND[1] * np.sum(energy)
    omega = wave_frequency(omega_e, waves.U, waves.beta)
    mean = float(np.sum(energy[kept] * omega[kept]) / np.sum(energy[kept]))
    return ittc_two_parameter(height, 2.0 * math.pi / mean)


def _point_motion(
    name: str, x: float, spectrum: Spectrum, omega: Array, omega_e: Array, heave: Complex, pitch: Complex
) -> PointMotion:
    motion: MotionStatistics = motion_statistics(spectrum, omega, omega_e, vertical_motion(heave, pitch, x))
    return PointMotion(name, x, motion.significant, motion.acceleration, motion_sickness(motion))


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in values)
