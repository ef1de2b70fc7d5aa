"""Complex functions of wave frequency and heading, tabulated on a grid and read between its points."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex, checked_waves

_ROUNDING = 1e-9  # of the largest grid value, by which a value may lie outside the table: rounding


@dataclass(frozen=True)
class WaveTable:
    """Values over omega [rad/s] and heading [rad, 0 following, pi head, hull alike to port and starboard].

    Real and imaginary parts are interpolated by monotone cubics (PCHIP) in frequency, then in heading; nothing is
    extrapolated. Phases at midship turn slowly where the hull is not many wave lengths long; a table must be dense
    enough that neighbours differ by less than a quarter turn, which is checked in frequency where the values matter.

    Attributes:
        name: of the file or data, for messages.
        omega: (n,), rising; headings: (h,), rising, within 0 and pi; values: (n, h, m).

    Raises:
        InputError: fewer than two frequencies, an order or shape that does not agree, NaN, or phases that jump.
    """

    name: str
    omega: Array
    headings: Array
    values: Complex

    def __post_init__(self) -> None:
        if self.omega.ndim != 1 or self.omega.size < 2 or not np.all(np.diff(self.omega) > 0) or self.omega[0] <= 0:
            raise InputError(f"{self.name} needs at least two positive, rising wave frequencies")
        within = np.all((self.headings >= 0) & (self.headings <= np.pi + _ROUNDING))
        if self.headings.ndim != 1 or self.headings.size == 0 or not np.all(np.diff(self.headings) > 0) or not within:
            raise InputError(f"{self.name} needs rising headings between 0 (following) and 180 degrees (head)")
        if self.values.ndim != 3 or self.values.shape[:2] != (self.omega.size, self.headings.size):
            raise InputError(f"{self.name} does not have one value for each pair of frequency and heading")
        if not np.all(np.isfinite(self.values)):
            i, j, _ = np.argwhere(~np.isfinite(self.values))[0]
            raise InputError(
                f"{self.name} has no finite value at omega = {self.omega[i]:g} rad/s and heading "
                f"{np.degrees(self.headings[j]):g} degrees; fill or leave out that frequency"
            )
        self._refuse_phase_jumps()

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Its first and last frequency [rad/s]."""
        return float(self.omega[0]), float(self.omega[-1])

    def interpolate(self, omega: Array, U: float, beta: Array | float) -> Complex:
        """Return values (k, m) at the frequencies (k,) and one heading, or one for each.

        Raises:
            InputError: as `checked_waves`, or a frequency or heading outside the table.
        """
        w, heading = checked_waves(omega, U, beta)
        folded = np.abs(np.angle(np.exp(1j * heading)))
        refuse_outside(self.name, "wave frequency", "rad/s", self.omega, w)
        refuse_outside(self.name, "heading", "degrees", np.degrees(self.headings), np.degrees(folded))
        along = interpolated(self.omega, self.values, np.clip(w, self.omega[0], self.omega[-1]))
        out = np.empty((w.size, self.values.shape[2]), dtype=np.complex128)
        for angle in np.unique(folded):
            rows = folded == angle
            inside = np.clip(angle, self.headings[0], self.headings[-1])
            out[rows] = interpolated(self.headings, np.moveaxis(along[rows], 1, 0), np.array([inside]))[0]
        return out

    def _refuse_phase_jumps(self) -> None:
        """Neighbours in frequency that both carry a fifth of the largest value and differ by over a quarter turn."""
        size = np.abs(self.values)
        loud = np.minimum(size[1:], size[:-1]) > 0.2 * size.max(axis=(0, 1))  # a fifth: chosen
        turned = np.real(self.values[1:] * self.values[:-1].conj()) < 0
        if np.any(loud & turned):
            i, j, _ = np.argwhere(loud & turned)[0]
            raise InputError(
                f"{self.name} is too coarse: the phase turns by more than 90 degrees between omega = "
                f"{self.omega[i]:g} and {self.omega[i + 1]:g} rad/s at heading {np.degrees(self.headings[j]):g} "
                "degrees; give more frequencies between, or check the unit of the phase"
            )


def interpolated(x: Array, values: Complex | Array, points: Array) -> Complex:
    """Return PCHIP along the first axis, real and imaginary parts each; a single row holds at its own point only."""
    if x.size == 1:
        return np.repeat(np.asarray(values, dtype=np.complex128), points.size, axis=0)
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(x, np.real(values))(points) + 1j * PchipInterpolator(x, np.imag(values))(points)


def refuse_outside(name: str, quantity: str, unit: str, grid: Array, values: Array) -> None:
    """Raise InputError naming the range of a table if `values` leaves it by more than rounding."""
    slack = _ROUNDING * max(1.0, abs(float(grid[-1])))
    outside = values[(values < grid[0] - slack) | (values > grid[-1] + slack)]
    if outside.size:
        raise InputError(
            f"{name} covers {quantity} {grid[0]:g} to {grid[-1]:g} {unit}, so it cannot give {outside[0]:g} {unit}; "
            "it is not extrapolated"
        )
