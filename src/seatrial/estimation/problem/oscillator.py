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
NAMES = ("gain", "delay", "distance", "added", "linear", "quadratic", "stiffness")
_ROUNDS = 60


@dataclass(frozen=True)
class Theory:
    """Of the whole section at one frequency: added mass, damping, complex excitation per m of wave amplitude."""

    added: float
    damping: float
    excitation: complex


@dataclass(frozen=True)
class Observed:
    """A measured response.

    Attributes:
        omega, wavenumber: rad/s, rad/m.
        wave: wave amplitude, m.
        response: complex, per m of wave amplitude.
        spread: relative standard deviation expected of it.
        theory: at this frequency.
    """

    omega: float
    wavenumber: float
    wave: float
    response: complex
    spread: float
    theory: Theory


@dataclass(frozen=True)
class Oscillator:
    """(inertia + a + added) x'' + (b + linear) x' + quadratic x'|x'| + stiffness x = X, as instruments show it.

    Attributes:
        inertia, stiffness: known.
        gain: of measured response over computed one; negative where the measured axis points the other way.
        delay: s, of the response's channels against the waves'.
        distance: m, of the section beyond the place to which the wave is referred.
        added: kg (kg m^2) beside the theory's.
        linear: kg/s (kg m^2/s) beside the theory's.
        quadratic: kg/m (kg m^2), damping force over |velocity| velocity.
    """

    inertia: float
    stiffness: float
    gain: float = 1.0
    delay: float = 0.0
    distance: float = 0.0
    added: float = 0.0
    linear: float = 0.0
    quadratic: float = 0.0

    def motion(self, theory: Theory, omega: float, wave: float) -> complex:
        """The motion itself per m of wave amplitude, quadratic damping by its equivalent 8 omega |x| / (3 pi).

        Equal work over a period (Himeno 1981, Univ. of Michigan report 239); the amplitude is found by iteration.
        """
        spring = self.stiffness - omega**2 * (self.inertia + theory.added + self.added)
        size = 0.0
        response = 0j
        for _ in range(_ROUNDS):
            damping = theory.damping + self.linear + self.quadratic * 8.0 / (3.0 * np.pi) * omega * size * wave
            response = theory.excitation / (spring + 1j * omega * damping)
            if abs(abs(response) - size) < 1e-10 * abs(response):
                break
            size = 0.5 * (size + abs(response))
        return complex(response)

    def equivalent_damping(self, theory: Theory, omega: float, wave: float) -> float:
        """Both parts beside the theory's, as kg/s (kg m^2/s) at that wave amplitude."""
        size = abs(self.motion(theory, omega, wave)) * wave
        return self.linear + self.quadratic * 8.0 / (3.0 * np.pi) * omega * size

    def seen(self, one: Observed) -> complex:
        """The response as it would be measured."""
        turned = np.exp(-1j * (one.wavenumber * self.distance + one.omega * self.delay))
        return complex(self.gain * turned * self.motion(one.theory, one.omega, one.wave))


@dataclass(frozen=True, eq=False)
class OscillatorFit:
    """The fitted oscillator; `errors` by name from residuals, `misfit` the root mean square of weighted residuals."""

    oscillator: Oscillator
    free: tuple[str, ...]
    errors: Mapping[str, float]
    misfit: float


def fitted(
    start: Oscillator,
    observed: Sequence[Observed],
    free: Sequence[str] = NAMES,
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

    unknown = [name for name in free if name not in NAMES]
    if unknown:
        raise InputError(f"an oscillator has no '{unknown[0]}' to be free; choose from {', '.join(NAMES)}")
    frequencies = {round(o.omega, 6) for o in observed}
    if len(free) > 2 * len(frequencies):
        raise InputError(
            f"{len(free)} unknowns cannot be told from {len(frequencies)} wave periods, which give two numbers each; "
            "fix some or add periods"
        )
    sizes = np.array([(scales or {}).get(name, 1.0) for name in free])
    measured = np.array([o.response for o in observed])
    spreads = np.array([o.spread for o in observed])

    def at(point: Array) -> Oscillator:
        return replace(start, **{name: float(v) for name, v in zip(free, point * sizes, strict=True)})

    def residuals(point: Array) -> Array:
        shaped = at(point)
        left = (np.array([shaped.seen(o) for o in observed]) / measured - 1.0) / spreads
        return np.concatenate([left.real, left.imag])

    first = np.array([getattr(start, name) for name in free]) / sizes
    found = least_squares(residuals, first, x_scale="jac")
    degrees = max(1, 2 * len(frequencies) - len(free))
    variance = float(found.fun @ found.fun) / degrees
    jacobian = np.asarray(found.jac)
    covariance = variance * np.linalg.pinv(jacobian.T @ jacobian)
    errors = {name: float(s * e) for name, s, e in zip(free, sizes, np.sqrt(np.diag(covariance)), strict=True)}
    return OscillatorFit(at(found.x), tuple(free), errors, float(np.sqrt(np.mean(found.fun**2))))
