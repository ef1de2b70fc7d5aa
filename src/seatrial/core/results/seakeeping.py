"""What an identified ship does in the sea of her trial: response amplitude operators, spectra, statistics."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PointMotion:
    """Vertical motion at one place of the ship.

    Attributes:
        x: m forward of the origin; significant: amplitude, m; acceleration: rms, m/s^2.
        sickness: share of people sick within two hours, 0 to 1.
    """

    place: str
    x: float
    significant_amplitude: float
    rms_acceleration: float
    sickness_incidence: float


@dataclass(frozen=True)
class Seakeeping:
    """Heave [up] and pitch [bow down] per wave at one speed and heading, and what a sea of one spectrum makes of them.

    Attributes:
        run: whose waves they are; speed: m/s; heading: degrees, 0 following, 180 head; sea: the spectrum in words.
        omega, omega_e: rad/s, of the wave and of encounter (negative where the ship overtakes it).
        heave: m/m, pitch: wave slopes (rad per rad); phases in degrees, ahead of the crest at the origin.
        sea_density [m^2 s/rad], heave_density [m^2 s/rad], pitch_density [deg^2 s/rad]: over omega.
        heave_significant: m, pitch_significant: degrees, amplitudes; periods: mean zero crossing of both, s.
    """

    run: str
    speed: float
    heading: float
    sea: str
    omega: tuple[float, ...]
    omega_e: tuple[float, ...]
    heave: tuple[float, ...]
    heave_phase: tuple[float, ...]
    pitch: tuple[float, ...]
    pitch_phase: tuple[float, ...]
    sea_density: tuple[float, ...]
    heave_density: tuple[float, ...]
    pitch_density: tuple[float, ...]
    heave_significant: float
    pitch_significant: float
    zero_crossing_periods: tuple[float, float]
    points: tuple[PointMotion, ...]
