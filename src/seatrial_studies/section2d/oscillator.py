"""One motion in regular waves: potential theory with a few corrections, fitted to complex amplitudes of many periods.

Per frequency two numbers (amplitude, phase) are measured and four are wanted (added mass, damping, excitation with its
phase): the frequencies are tied by theory, which gives added mass, wave damping and excitation together, so that
Haskind's relation holds among them. Free may be a gain, a delay, a distance, one added mass, a linear and a quadratic
damping.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError

Complex = NDArray[np.complex128]
OSCILLATOR_PARAMETERS = (
    "gain",
    "delay",
    "distance",
    "extra_added_mass",
    "linear_damping",
    "quadratic_damping",
    "stiffness",
)
_ITERATIONS = 60


@dataclass(frozen=True)
class SectionTheory:
    """Of the whole section at one frequency: added mass, damping, complex excitation per m of wave amplitude."""

    added_mass: float
    damping: float
    excitation: complex


@dataclass(frozen=True)
class MeasuredResponse:
    """A measured response.

    Attributes:
        omega, wavenumber: rad/s, rad/m.
        wave_amplitude: m.
        response: complex, per m of wave amplitude.
        relative_sd: relative standard deviation expected of it.
        theory: at this frequency.
    """

    omega: float
    wavenumber: float
    wave_amplitude: float
    response: complex
    relative_sd: float
    theory: SectionTheory


@dataclass(frozen=True)
class Oscillator:
    """(m + a + da) x'' + (b + b_1) x' + b_2 x'|x'| + c x = X as instruments show it, m inertia and c stiffness.

    Attributes:
        inertia, stiffness: known.
        gain: of measured response over computed one; negative where the measured axis points the other way.
        delay: s, of the response's channels against the waves'.
        distance: m, of the section beyond the place to which the wave is referred.
        extra_added_mass: da, kg (kg m^2), beside the theory's a.
        linear_damping: b_1, kg/s (kg m^2/s), beside the theory's b.
        quadratic_damping: b_2, kg/m (kg m^2), damping force over |velocity| velocity.
    """

    inertia: float
    stiffness: float
    gain: float = 1.0
    delay: float = 0.0
    distance: float = 0.0
    extra_added_mass: float = 0.0
    linear_damping: float = 0.0
    quadratic_damping: float = 0.0

    def motion_response(self, theory: SectionTheory, omega: float, wave_amplitude: float) -> complex:
        """The motion itself per m of wave amplitude, quadratic damping by its equivalent 8 omega |x| / (3 pi).

        Equal work over a period (Himeno 1981, Univ. of Michigan report 239); the amplitude is found by iteration.
        """
        spring = self.stiffness - omega**2 * (self.inertia + theory.added_mass + self.extra_added_mass)
        size = 0.0
        response = 0j
        for _ in range(_ITERATIONS):
            damping = (
                theory.damping
                + self.linear_damping
                + self.quadratic_damping * 8.0 / (3.0 * np.pi) * omega * size * wave_amplitude
            )
            response = theory.excitation / (spring + 1j * omega * damping)
            if abs(abs(response) - size) < 1e-10 * abs(response):
                break
            size = 0.5 * (size + abs(response))
        return complex(response)

    def extra_equivalent_damping(self, theory: SectionTheory, omega: float, wave_amplitude: float) -> float:
        """Both parts beside the theory's, as kg/s (kg m^2/s) at that wave amplitude."""
        size = abs(self.motion_response(theory, omega, wave_amplitude)) * wave_amplitude
        return self.linear_damping + self.quadratic_damping * 8.0 / (3.0 * np.pi) * omega * size

    def measured_response(self, measurement: MeasuredResponse) -> complex:
        """Return the response as it would be measured."""
        turned = np.exp(-1j * (measurement.wavenumber * self.distance + measurement.omega * self.delay))
        return complex(
            self.gain * turned * self.motion_response(measurement.theory, measurement.omega, measurement.wave_amplitude)
        )


@dataclass(frozen=True, eq=False)
class OscillatorFit:
    """The fitted oscillator; `errors` by name from residuals, `misfit` the root mean square of weighted residuals."""

    oscillator: Oscillator
    free: tuple[str, ...]
    errors: Mapping[str, float]
    misfit: float


def fit_oscillator(
    start: Oscillator,
    measurements: Sequence[MeasuredResponse],
    free: Sequence[str] = OSCILLATOR_PARAMETERS,
    scales: Mapping[str, float] | None = None,
) -> OscillatorFit:
    """Least squares on relative complex errors over their spreads.

    Args:
        free: names of `Oscillator`'s fields to estimate.
        scales: typical size of each.

    Raises:
        InputError: an unknown name, or more unknowns than measured numbers.
    """
    from scipy.optimize import least_squares

    unknown = [name for name in free if name not in OSCILLATOR_PARAMETERS]
    if unknown:
        raise InputError(
            f"an oscillator has no '{unknown[0]}' to be free; choose from {', '.join(OSCILLATOR_PARAMETERS)}"
        )
    frequencies = {round(o.omega, 6) for o in measurements}
    if len(free) > 2 * len(frequencies):
        raise InputError(
            f"{len(free)} unknowns cannot be identified from {len(frequencies)} wave periods, which give two numbers "
            "each; fix some or add periods"
        )
    sizes = np.array([(scales or {}).get(name, 1.0) for name in free])
    measured = np.array([o.response for o in measurements])
    spreads = np.array([o.relative_sd for o in measurements])

    def oscillator_at(point: Array) -> Oscillator:
        return replace(start, **{name: float(v) for name, v in zip(free, point * sizes, strict=True)})

    def residuals(point: Array) -> Array:
        shaped = oscillator_at(point)
        left = (np.array([shaped.measured_response(o) for o in measurements]) / measured - 1.0) / spreads
        return np.concatenate([left.real, left.imag])

    first = np.array([getattr(start, name) for name in free]) / sizes
    found = least_squares(residuals, first, x_scale="jac")
    degrees = max(1, 2 * len(frequencies) - len(free))
    variance = float(found.fun @ found.fun) / degrees
    jacobian = np.asarray(found.jac)
    covariance = variance * np.linalg.pinv(jacobian.T @ jacobian)
    errors = {name: float(s * e) for name, s, e in zip(free, sizes, np.sqrt(np.diag(covariance)), strict=True)}
    return OscillatorFit(oscillator_at(found.x), tuple(free), errors, float(np.sqrt(np.mean(found.fun**2))))
