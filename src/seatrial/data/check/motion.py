"""Velocities, heading and position side by side, as declared: what the comparisons work on."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.signal import cumulative_integral, smoothed, smoothed_derivative, trimmed_rms, window_length

DEGREES_PER_RADIAN = 180.0 / math.pi


@dataclass(frozen=True)
class VelocityConvention:
    """One way to read the columns u, v and psi; `changes` counts departures from the declared way.

    Attributes:
        frame: ``body`` or ``earth``.
        v_sign: factor on v.
        psi_factor: factor on psi (-1: the heading turns the other way; 57.3 or its inverse: wrong unit).
        changes: number of differences from the declaration.
    """

    frame: str
    v_sign: float
    psi_factor: float
    changes: int


@dataclass(frozen=True)
class RecordedMotion:
    """Channels in SI, signs already turned to the notation table's, angles unwrapped; shape (n,) each.

    `ahead` is how far the position's reference point lies ahead of the velocities' [m].
    """

    name: str
    time: Array
    dt: float
    x: Array
    y: Array
    psi: Array
    u: Array
    v: Array
    frame: str
    reference_offset: float

    @property
    def window_samples(self) -> int:
        """Smoothing window in samples."""
        return window_length(len(self.time))

    @property
    def position_derivative(self) -> tuple[Array, Array]:
        """Smoothed derivative of position, north and east [m/s]."""
        return smoothed_derivative(self.x, self.dt, self.window_samples), smoothed_derivative(
            self.y, self.dt, self.window_samples
        )

    @property
    def conventions(self) -> list[VelocityConvention]:
        """The declared reading first, then all others."""
        frames = (self.frame, "earth" if self.frame == "body" else "body")
        factors = (1.0, -1.0, DEGREES_PER_RADIAN, 1.0 / DEGREES_PER_RADIAN)
        return [
            VelocityConvention(f, sv, fp, (f != self.frame) + (sv < 0) + (fp != 1.0))
            for f in frames
            for sv in (1.0, -1.0)
            for fp in factors
        ]

    def velocity(self, convention: VelocityConvention) -> tuple[Array, Array]:
        """Velocity of the position's reference point, north and east [m/s], as the reading has it."""
        psi, v = convention.psi_factor * self.psi, convention.v_sign * self.v
        c, s = np.cos(psi), np.sin(psi)
        north, east = (self.u * c - v * s, self.u * s + v * c) if convention.frame == "body" else (self.u, v)
        if self.reference_offset == 0.0:
            return north, east
        lever = self.reference_offset * np.gradient(psi, self.dt)
        return north - lever * s, east + lever * c

    def speed_scale(self, convention: VelocityConvention) -> float:
        """Least-squares factor from the reading's velocity to the position's."""
        north, east = (smoothed(w, self.window_samples) for w in self.velocity(convention))
        gx, gy = self.position_derivative
        power = float(north @ north + east @ east)
        return float(gx @ north + gy @ east) / power if power > 0 else 0.0

    def misfit(self, convention: VelocityConvention) -> float:
        """Size of (derivative of position - scaled velocity) over size of the derivative."""
        north, east = (smoothed(w, self.window_samples) for w in self.velocity(convention))
        gx, gy = self.position_derivative
        power = float(north @ north + east @ east)
        k = max(float(gx @ north + gy @ east) / power, 0.0) if power > 0 else 0.0
        return trimmed_rms(gx - k * north, gy - k * east) / max(trimmed_rms(gx, gy), 1e-12)

    @property
    def path_length(self) -> float:
        """Length of the smoothed track [m]."""
        return float(cumulative_integral(np.hypot(*self.position_derivative), self.dt)[-1])


def recorded_motion(record: Record) -> RecordedMotion | None:
    """The motion of a clean, evenly sampled, signed record, or None where channels are missing."""
    if any(s not in record for s in ("x0", "y0", "psi", "u", "v")) or len(record) < 30:
        return None
    if record.channel("u").frame != record.channel("v").frame:
        return None
    return RecordedMotion(
        record.name,
        record.time,
        record.dt,
        record["x0"],
        record["y0"],
        record["psi"],
        record["u"],
        record["v"],
        record.channel("u").frame,
        record.channel("x0").reference_point - record.channel("v").reference_point,
    )
